"""The tables of `pound sensitivity`, from the numbers of every output."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from pounding_cli.numbers import Unit
from pounding_cli.questions.chosen_points import build_key_frame
from pounding_cli.questions.frames import PURE_NUMBER, build_swept_frame, list_swept_columns
from pounding_cli.questions.sensitivity.indices import compute_probability, find_most_influential
from pounding_cli.questions.sensitivity.tables import SAMPLE_COLUMNS, SAMPLES
from pounding_cli.study import Plan
from pounding_cli.study.vary.inputs import MOTION
from pounding_cli.tables import Column, Table, build_table

if TYPE_CHECKING:
    from pounding_cli.questions.sensitivity.question import Sensitivity, Series

_OF_METHOD = {
    "sobol": ["first", "first_low", "first_high", "total", "total_low", "total_high", "mean", "at_low", "at_low_error",
              "at_high", "at_high_error"],
    "morris": ["mu_star", "mu_star_low", "mu_star_high", "mu", "sigma"],
}  # fmt: skip
"""Columns of the indices of each method."""


def build_places(plan: Plan, series: Sequence[Series]) -> pd.DataFrame:
    """Return where outputs stand: the swept values, case, analysis, output, its unit, whether it depends on contact."""
    return build_swept_frame(
        plan.axes[:-1],
        [each.point for each in series],
        case=[each.case for each in series],
        analysis=[each.analysis for each in series],
        output=[each.name for each in series],
        unit=[each.unit for each in series],
        on_contact=[int(each.on_contact) for each in series],
    )


def build_index_frame(
    plan: Plan, question: Sensitivity, series: Sequence[Series], indices: Sequence[pd.DataFrame]
) -> pd.DataFrame:
    """Return a row for every output and key."""
    places = build_places(plan, series)
    rows = places.loc[np.repeat(places.index, len(question.inputs))].reset_index(drop=True)
    columns = ["key", "outcome", "failed", "samples", *_OF_METHOD[question.spec.method]]
    return rows.join(pd.concat(indices, ignore_index=True).reindex(columns=columns))


def build_probability_frame(
    plan: Plan, question: Sensitivity, statements: Sequence[Series], indices: Sequence[pd.DataFrame]
) -> pd.DataFrame:
    """Return a row for every statement.

    indices : of each statement
    """
    numbers = pd.DataFrame(
        [
            compute_probability(question, one.values) | find_most_influential(question.spec.method, of_one)
            for one, of_one in zip(statements, indices, strict=True)
        ]
    )
    places = build_places(plan, statements).drop(columns="unit").rename(columns={"output": "statement"})
    return places.join(numbers)


def build_sample_table(plan: Plan, question: Sensitivity, series: Sequence[Series]) -> Table:
    """Return all samples in the order of the method with their outputs; a block for each point, case and analysis."""
    count = len(question.cube)
    keys, columns = build_key_frame(question.inputs, question.cube)
    keys.insert(0, "sample", range(1, count + 1))
    keys.insert(1, "independent", np.isin(np.arange(count), question.independent_samples).astype(int))
    if question.motions_of_samples is not None:
        keys[MOTION] = [_name_motions(question.motions, numbers) for numbers in question.motions_of_samples]
        columns.append(Column(MOTION, "ground motions"))
    blocks: dict[tuple, pd.DataFrame] = {}
    places = build_places(plan, series).drop(columns=["output", "unit", "on_contact"])
    for number, each in enumerate(series):
        place = each[:3]
        if place not in blocks:
            blocks[place] = places.loc[[number] * count].reset_index(drop=True).join(keys)
        name = f"output {each.name}"
        blocks[place][name] = each.values
        unit = Unit(each.unit, 1.0, each.unit) if each.unit else PURE_NUMBER
        columns.append(Column(name, "output", unit))
    frame = pd.concat(blocks.values(), ignore_index=True)
    return build_table(SAMPLES, frame, [*list_swept_columns(plan.axes[:-1]), *SAMPLE_COLUMNS, *columns])


def _name_motions(names: Sequence[str], numbers: np.ndarray) -> str:
    """Return the motions of a sample in words: "elcentro + 2 taft"."""
    counts = Counter(names[number] for number in numbers)
    return " + ".join(name if count == 1 else f"{count} {name}" for name, count in counts.items())
