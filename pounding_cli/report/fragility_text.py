"""Fragility curves in rows that people read: medians and spreads with their intervals, in the unit of the study."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from pounding_cli.fragility import CONFIDENCE, DRAWS, Outcome
from pounding_cli.numbers import Unit, counted
from pounding_cli.report.evidence import Tables
from pounding_cli.store.answers import Answer
from pounding_cli.store.fragility_samples import ALONE
from pounding_cli.study.fragility import INTENSITY_KEYS

_WORDS = ("limit", "building", "case", "analysis")
"""Columns of text."""


def intensity_unit(answer: Answer) -> Unit:
    """The unit of intensities; one without a name for a scale factor."""
    return answer.units["median"]


def table(answer: Answer, rows: pd.DataFrame) -> tuple[list[str], list[list[str]], int]:
    """Headings, rows as texts with their intervals in brackets, and how many columns of text come first.

    A case or an analysis that is the same in all rows is left out.
    """
    words = [name for name in _WORDS if name in _WORDS[:2] or len(set(rows[name])) > 1]
    unit = f" [{name}]" if (name := intensity_unit(answer).name) else ""
    both = ((ALONE, "alone"), ("", "with pounding"))
    lost = [
        alone for alone, _ in both
        if ((rows[f"undecided_motions{alone}"] > 0) & (rows[f"outcome{alone}"] != Outcome.UNDECIDED)).any()
    ]  # fmt: skip
    heads = list(words)
    for alone, what in both:
        heads += [f"{what}\nmedian{unit}", "\nspread", *["undecided\nmotions"] * (alone in lost)]
    found = []
    for row in rows.to_dict("records"):
        cells = [str(row[name]) for name in words]
        for alone, _ in both:
            cells += [median_text(answer, row, alone), _between(row, "spread", alone, Unit())]
            if alone in lost:
                cells.append("-" if not row["outcome" + alone] else undecided_text(row, alone))
        found.append([*cells, _between(row, "ratio", "", Unit())])
    return [*heads, "ratio of\nmedians"], found, len(words)


def subject(building: str, limit: str) -> str:
    """The limit and the building that it is asked of; a limit may name the building itself."""
    return limit if f" in {building} " in f"{limit} " else f"{building}, {limit}"


def median_text(answer: Answer, row: Mapping[Any, Any], alone: str = "", named: bool = False) -> str:
    """A median with its interval; where there is none, outcome of the fit and what is known.

    named : with the unit, in a sentence
    """
    unit = intensity_unit(answer)
    name = f" {unit.name}" if named and unit.name else ""
    outcome = str(row.get("outcome" + alone, ""))
    if not outcome:
        return "-"
    if row["median" + alone] == row["median" + alone]:
        return _between(row, "median", alone, unit, name)
    if outcome == Outcome.UNDECIDED and not named:  # a sentence says more
        outcome += f" in {undecided_text(row, alone)} motions"
    low, high = row["low" + alone], row["high" + alone]
    if low > 0 and high < np.inf:
        return f"{outcome}: {_text(low, unit)} to {_text(high, unit)}{name}"
    if low > 0 or high < np.inf:
        return (
            f"{outcome}: above {_text(low, unit)}{name}" if low > 0 else f"{outcome}: below {_text(high, unit)}{name}"
        )
    return outcome


def undecided_text(row: Mapping[Any, Any], alone: str = "") -> str:
    """How many motions are undecided, of how many: "5 of 8"."""
    return f"{int(row['undecided_motions' + alone])} of {int(row['motions' + alone])}"


def _between(row: Mapping[Any, Any], name: str, alone: str, unit: Unit, unit_name: str = "") -> str:
    value = row.get(name + alone, np.nan)
    if value != value:
        return "-"
    low, high = (_text(row[f"{name}_{end}{alone}"], unit) for end in ("low", "high"))
    return f"{_text(value, unit)}{unit_name} ({low} to {high}{unit_name})"


def _text(value: float, unit: Unit) -> str:
    return f"{unit.number(value):.3g}" if np.isfinite(value) else "inf"


@dataclass(frozen=True)
class Asked:
    """How the curves were asked for: method, intensity measure in words, confidence [-], draws of the bootstrap."""

    method: str
    measure: str
    confidence: float
    draws: int


def asked_of(results: Tables) -> Asked:
    """How the curves of a results file were asked for."""
    spec = results.resolved.get("fragility") or {}
    swept = next((name for key, name in INTENSITY_KEYS.items() if key in results.units), "pga")
    measure = str(spec.get("intensity") or swept)
    if measure == "sa":
        scale = results.resolved["records"]["scale"]
        measure = f"sa({scale['period']:g} s)" if isinstance(scale, dict) and "period" in scale else measure
    words = _MEASURES.get(measure.partition("(")[0], measure)
    period = measure.partition("(")[2].removesuffix(")")
    return Asked(
        str(spec.get("method", "ida")),
        f"{words} at {period}" if period else words,
        float(spec.get("confidence", CONFIDENCE)),
        int(spec.get("draws", DRAWS)),
    )


_MEASURES = {
    "pga": "peak ground acceleration", "pgv": "peak ground velocity", "sa": "pseudo-acceleration",
    "factor": "scale factor",
}  # fmt: skip


def notes(asked: Asked, rows: pd.DataFrame) -> list[str]:
    """What a reader should know of the rows."""
    both = [name for name in ("", ALONE) if "outcome" + name in rows]
    said = [
        f"In brackets: {100 * asked.confidence:.4g} % interval of {asked.draws} bootstrap draws of the motions, "
        "the same draws alone and with pounding."
    ]
    if asked.method == "ida":
        said.append(
            "Every motion that passes is bracketed between two neighbouring intensities of the study, further apart "
            "only where a scene failed or is undecided; the fit is of maximum likelihood over these brackets."
        )
        returns = sum(int(rows[f"returns{name}"].fillna(0).sum()) for name in both if f"returns{name}" in rows)
        if returns:
            which = counted(returns, "motion holds", "motions hold")
            said.append(f"{which} again above the first intensity that passes; the first one counts.")
    undecided = "ended with a collapse before the limit was passed"
    if asked.method == "cloud":
        undecided = "ended with a collapse, or gave a demand that has no logarithm"
    for column, what, more in (("failed", "failed", " The table `scene` names them."), ("undecided", undecided, "")):
        number = sum(int(rows[f"{column}{name}"].fillna(0).sum()) for name in both if f"{column}{name}" in rows)
        if number:
            said.append(
                f"{counted(number, 'scene')} {what} (a scene that several rows need counts in each): counted neither "
                f"as holding nor as passing.{more}"
            )
    if any(rows[f"undecided_motions{name}"].fillna(0).max() > 0 for name in both):
        known = {
            "ida": "a motion counts as holding up to the highest intensity at which it is decided",
            "stripes": "undecided scenes are left out of the counts",
        }.get(asked.method, "undecided scenes are left out of the line")
        said.append(
            "Undecided motions: a collapse ended their scenes before the limit was passed, and the rest of the motion "
            f"might have passed it; {known}, as if undecided motions were like the others."
        )
    outcomes = dict.fromkeys(value for name in both for value in rows["outcome" + name] if value not in ("", "fitted"))
    said += [f"{outcome}: {Outcome(outcome).meaning}." for outcome in outcomes]
    return said
