"""The question of `pound screen` asked of a street: how often does each pair of neighbours strike?

Every pair is a study of its own, of which `pound gap` asks what closes with nothing between the buildings; no more than
one is in memory at a time. Pairs of the same buildings share their time histories, whatever their gaps and sites."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.questions.gap.question import Gap
from pounding_cli.questions.question import Answer, StudyQuestion
from pounding_cli.questions.screen.decide import OF_MOTIONS, find_decision, find_variance_shares
from pounding_cli.questions.screen.street import LEFT, RIGHT, NeighbourPair, Street
from pounding_cli.questions.screen.tables import (
    MIN_SCREENED_GAP,
    RETURN_PERIOD,
    SCREEN_COLUMNS,
    SCREEN_TABLE,
    SHARES_COLUMNS,
    SHARES_TABLE,
)
from pounding_cli.study import Plan
from pounding_cli.tables import Table, build_table

if TYPE_CHECKING:
    from pounding_cli.batch.solve import Solver
    from pounding_cli.questions.hazard import Hazard


@dataclass(frozen=True, eq=False)
class _Closings:
    """The largest closings of two buildings, with what each may be.

    values : over all floors [m], shape (levels, neighbours, motions); NaN of a run that failed
    scores : factors on the medians of what is uncertain, by its name in words, shape (neighbours,)
    heights : of both buildings [m]
    """

    values: np.ndarray
    scores: Mapping[str, np.ndarray]
    heights: tuple[float, float]


class Screen(StudyQuestion):
    """The rates of contact of all pairs of a street.

    Raises InputError: the study of the first pair is refused.

    street : the table of the pairs
    first : the question of `pound gap` of the first pair
    """

    name = "screen"
    extent = "begins with"

    def __init__(self, street: Street) -> None:
        self.street = street
        super().__init__(street.build_study(street.pairs[0]))
        self.first = Gap(self.study)

    @property
    def plan(self) -> Plan:
        """The time histories of the first pair."""
        return self.first.plan

    @property
    def expected_count(self) -> int:
        """Number of time histories of all different pairs of buildings, about."""
        of_first = _select_scenes(self.first).size
        return of_first * len({pair.buildings_key for pair in self.street.pairs})

    def answer(self, solver: Solver) -> Answer:
        """Return the table of all pairs, and the answer of `pound gap` of the worst one."""
        closings_by_key: dict[str, _Closings] = {}
        hazard_by_key: dict[str, Hazard] = {}
        rows = []
        shares_by_line: dict[int, dict[str, float]] = {}
        for pair in self.street.pairs:
            is_known = pair.buildings_key in closings_by_key and pair.hazard_key in hazard_by_key
            question = None if is_known else Gap(self.street.build_study(pair))
            if question is not None:
                assert question.hazard is not None  # each study of a pair has one
                hazard_by_key[pair.hazard_key] = question.hazard
            if question is not None and pair.buildings_key not in closings_by_key:
                closings_by_key[pair.buildings_key] = _solve_closings(question, solver)
            closings = closings_by_key[pair.buildings_key]
            shares = _find_shares(closings)
            shares_by_line[pair.line] = shares
            row = _describe_pair(pair, closings)
            row |= _estimate_contact(pair, closings, hazard_by_key[pair.hazard_key], self.first.intensities)
            row["decides"], row["share"] = find_decision(shares)
            row["motion_share"] = shares.get(OF_MOTIONS, np.nan)
            rows.append(row)
        rows.sort(key=lambda row: (-row["rate"] if math.isfinite(row["rate"]) else math.inf, row["row"]))
        for rank, row in enumerate(rows, 1):
            row["rank"] = rank
        worst = next(pair for pair in self.street.pairs if pair.line == rows[0]["row"])
        of_worst = Gap(self.street.build_study(worst)).answer(solver)
        tables = [_build_screen_table(rows), _build_shares_table(rows, shares_by_line)]
        return Answer(of_worst.plan, of_worst.arrays, [*tables, *of_worst.tables])


def _select_scenes(question: Gap) -> np.ndarray:
    """Return the numbers of the scenes of both buildings, without the median ones and without buildings alone.

    Shape (levels, neighbours, motions).
    """
    numbers: np.ndarray = question.plan.numbers[..., 0, 0, :, 0]
    return numbers[:, None, :] if question.neighbours is None else numbers[:, 1:, :]


def _solve_closings(question: Gap, solver: Solver) -> _Closings:
    """Return the largest closings of the pair of a question."""
    numbers = _select_scenes(question)
    arrays = solver.solve_arrays(question.plan, numbers.ravel())
    closings = arrays["max_closing"].values[..., 0, 0, :, :]
    closings = closings[:, None] if question.neighbours is None else closings[:, 1:]
    is_known = np.isfinite(closings).any(axis=-1)
    largest = np.where(is_known, np.max(closings, axis=-1, where=np.isfinite(closings), initial=-np.inf), np.nan)
    buildings = question.study.group(question.study.first_point).buildings
    heights = [float(building.elevation[-1]) for building in buildings]
    return _Closings(largest, _draw_scores(question), (heights[0], heights[1]))


def _draw_scores(question: Gap) -> dict[str, np.ndarray]:
    """Return the factors on what is uncertain of both buildings, of all that they may be, by its name in words."""
    from pounding_cli.model.archetypes import draw_factors
    from pounding_cli.questions.neighbours import list_drawn

    scores = {}
    for seen in list_drawn(question.study):
        count = seen.spec.neighbours
        factors = [draw_factors(seen.archetype.spreads, seen.name, number, count) for number in range(1, count + 1)]
        for quantity in seen.uncertain_quantities():
            scores[f"{quantity} of the {seen.name}"] = np.array([each[quantity] for each in factors])
    return scores


def _find_shares(closings: _Closings) -> dict[str, float]:
    """Return the shares of the variance of the closings by what explains them, the largest first."""
    from pounding_cli.questions.hazard import MIN_GAP

    if np.isnan(closings.values).all():
        return {}
    return find_variance_shares(np.log(np.maximum(closings.values, MIN_GAP)), closings.scores)


def _describe_pair(pair: NeighbourPair, closings: _Closings) -> dict[str, Any]:
    """Return the columns that say what stands beside what."""
    row: dict[str, Any] = {"pair": pair.name, "row": pair.line, "gap": pair.gap}
    for side, name, height in zip((LEFT, RIGHT), pair.names, closings.heights, strict=True):
        archetype = pair.buildings[side]["archetype"]
        row |= {
            side: f"{archetype['type']} {archetype['storeys']}",
            f"{side}_name": name,
            f"{side}_type": archetype["type"],
            f"{side}_design": archetype["design"],
            f"{side}_storeys": int(archetype["storeys"]),
            f"{side}_height": height,
        }
    return row | {"neighbours": closings.values.shape[1]}


def _estimate_contact(
    pair: NeighbourPair, closings: _Closings, hazard: Hazard, intensities: np.ndarray
) -> dict[str, Any]:  # fmt: skip
    """Return the rate of contact and the probabilities of a pair."""
    import pandas as pd

    from pounding_cli.questions.gap.rate import RateBasis
    from pounding_cli.questions.hazard import compute_contact_probability, find_intensity, poisson_probability

    gap = max(pair.gap, MIN_SCREENED_GAP)
    pga = find_intensity(hazard, 1.0 / RETURN_PERIOD)
    neighbours, motions = closings.values.shape[1:]
    columns = pd.MultiIndex.from_product([range(neighbours), range(motions)], names=["neighbour", "motion"])
    frame = pd.DataFrame(closings.values.reshape(len(intensities), -1), index=intensities, columns=columns)
    frame = frame[~frame.index.duplicated()].sort_index()  # levels stand in the order that they are written
    frame = frame.dropna(axis=1)  # leave out motions of which a run failed
    row = {"pga": pga, "motions": frame.columns.get_level_values("motion").nunique()}
    nothing = dict.fromkeys(("rate", "rate_low", "rate_high", "probability", "enough"), np.nan)
    basis = RateBasis(hazard, 0, {((), "", 0): frame})
    estimate = basis.estimate_rate((), "", 0, gap)
    if not estimate:
        return row | nothing
    estimate["probability"] = poisson_probability(float(estimate["rate"]))
    estimate["enough"] = 1.0 - compute_contact_probability(pga, gap, *basis.take_logarithms((), "", 0))
    return row | estimate


def _build_screen_table(rows: list[dict[str, Any]]) -> Table:
    """Return SCREEN_TABLE."""
    import pandas as pd

    frame = pd.DataFrame(rows, columns=[column.name for column in SCREEN_COLUMNS])
    return build_table(SCREEN_TABLE, frame, SCREEN_COLUMNS, caption="Pairs of neighbours, by their rate of contact")


def _build_shares_table(rows: list[dict[str, Any]], shares_by_line: Mapping[int, Mapping[str, float]]) -> Table:
    """Return SHARES_TABLE."""
    import pandas as pd

    found = [
        {"rank": row["rank"], "pair": row["pair"], "input": name, "share": share}
        for row in rows
        for name, share in shares_by_line[row["row"]].items()
    ]
    frame = pd.DataFrame(found, columns=[column.name for column in SHARES_COLUMNS])
    return build_table(SHARES_TABLE, frame, SHARES_COLUMNS, caption="What decides about every pair")
