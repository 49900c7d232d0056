"""What each curve of `pound fragility` rests on: demand over limit of every motion and intensity."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pounding_cli.digests import DigestList, pieces
from pounding_cli.fragility import Brackets, Curve, Fits, Outcome, cloud, cloud_draw, draw, fit
from pounding_cli.fragility.hunt import UNDECIDED, found
from pounding_cli.model.placed import among
from pounding_cli.study.expression import TAKES_NEIGHBOUR
from pounding_cli.study.fragility import intensities
from pounding_cli.study.fragility_rounds import Demands, Layout, Responses

if TYPE_CHECKING:
    import pandas as pd

    from pounding_cli.study import Plan
    from pounding_cli.study.fragility import Question


ALONE = "0"
"""Ends the name of a column of the buildings alone."""


@dataclass(frozen=True, eq=False)
class Sample:
    """What one curve rests on; shapes (motions, levels).

    method : ida, stripes or cloud
    intensity : [SI]
    demand : over limit [-], above 1 where the limit is passed; inf where a collapse ended the scene after that,
        UNDECIDED where it did before; NaN where the scene failed or was not asked for
    asked : whether the scene was
    """

    method: str
    intensity: np.ndarray
    demand: np.ndarray
    asked: np.ndarray

    @property
    def failed(self) -> int:
        """Scenes that failed."""
        return int((self.asked & np.isnan(self.demand)).sum())

    @property
    def undecided(self) -> np.ndarray:
        """Scenes that did not fail and tell nothing of the limit: a collapse ended them before it was passed or, of a
        cloud, their demand is not known to its end or has no logarithm; shape (motions, levels)."""
        if self.method == "cloud":
            return self.asked & ~np.isnan(self.demand) & ~self._drawable
        return self.demand == UNDECIDED

    @property
    def undecided_motions(self) -> int:
        """Motions not known to pass, nor to hold at the highest intensities, since a collapse ended their scenes there;
        of a cloud motions that have no point because of that."""
        undecided = self.demand == UNDECIDED
        if self.method == "cloud":
            return int((undecided.any(axis=1) & ~self._drawable.any(axis=1)).sum())
        levels = np.arange(1, self.demand.shape[1] + 1)
        held = np.where((self.demand <= 1) & ~undecided, levels, 0).max(axis=1)
        lost = np.where(undecided, levels, 0).max(axis=1)
        return int(((lost > held) & ~(self.demand > 1).any(axis=1)).sum())

    @property
    def _drawable(self) -> np.ndarray:
        return np.isfinite(self.demand) & (self.demand > 0)

    def held_and_passed(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Of every motion the highest intensity below its first pass at which it holds (0: none), that of its first
        pass (inf: none), and whether it holds at a higher one again; shape (motions,)."""
        motions, levels = self.demand.shape
        held, passed, returns = np.zeros(motions), np.full(motions, np.inf), np.zeros(motions, bool)
        for motion in range(motions):
            known = found(dict(enumerate(self.demand[motion].tolist())), levels)
            if known.held >= 0:
                held[motion] = self.intensity[motion, known.held]
            if known.passed < levels:
                passed[motion] = self.intensity[motion, known.passed]
            returns[motion] = known.returns
        return held, passed, returns

    def brackets(self) -> Brackets:
        """The capacities: of `ida` one bracket a motion, of `stripes` one for every scene."""
        motions = len(self.demand)
        if self.method == "ida":
            held, passed, _ = self.held_and_passed()
            return Brackets.of(np.arange(motions), held, passed, motions)
        known = self.asked & ~np.isnan(self.demand) & ~self.undecided
        above = self.demand[known] > 1
        x = self.intensity[known]
        return Brackets.of(
            np.nonzero(known)[0], np.where(above, 0.0, x), np.where(above, x, np.inf), motions
        )  # fmt: skip

    def curve(self) -> Curve:
        """The fit; none where half of the motions or more are undecided."""
        motions = len(self.demand)
        if 2 * self.undecided_motions >= motions:
            return Curve(Outcome.UNDECIDED, motions, None, None, self._middle())
        if self.method != "cloud":
            return fit(self.brackets())
        some = self._drawable
        if 2 * some.any(axis=1).sum() <= motions:  # the others collapsed: a line through the rest would mislead
            return Curve(Outcome.FEW, motions, None, None, (0.0, np.inf))
        return cloud(self.intensity[some], self.demand[some], 1.0, np.nonzero(some)[0]).curve

    def _middle(self) -> tuple[float, float]:
        """Intensities between which half of the motions pass, whatever the undecided ones would do."""
        if self.method == "cloud":
            return 0.0, np.inf
        held, passed, _ = self.held_and_passed()
        half = len(held) // 2
        return float(np.sort(held)[len(held) - 1 - half]), float(np.sort(passed)[half])

    def draws(self, times: np.ndarray) -> Fits:
        """The fits of a bootstrap; `times` : `resamples` of the motions."""
        if self.method != "cloud":
            return draw(self.brackets(), times)
        some = self._drawable
        return cloud_draw(self.intensity[some], self.demand[some], 1.0, np.nonzero(some)[0], times)


@dataclass(frozen=True, eq=False)
class Place:
    """Where a curve stands: point of the sweep without the intensity, case, analysis, target; numbers from 0."""

    point: int
    case: int
    analysis: int
    target: int


def samples_of(
    plan: Plan, responses: Responses, question: Question, layout: Layout
) -> Iterator[tuple[Place, Sample, Sample | None]]:
    """Every curve: with pounding, and alone (None: what takes a neighbour)."""
    demands, table = Demands(plan, layout), plan.rows.table
    x, method, targets = intensities(plan, question), question.spec.method, question.targets
    is_asked = np.concatenate([among(plan.scenes, some) for some in pieces(DigestList(table.digests))])

    def looked_at(scenes: np.ndarray, point: int, case: int, alone: int | None) -> dict[int, Sample]:
        """Of every target what its scenes say, shape of `scenes` (motions, levels); `alone` : the only building."""
        mine = {
            number: target for number, target in enumerate(targets)
            if alone is None or (target.building == alone and target.limit.quantity not in TAKES_NEIGHBOUR)
        }  # fmt: skip
        if not mine:
            return {}
        asked = is_asked[scenes]
        demand = {number: np.full(scenes.shape, np.nan) for number in mine}
        read = responses.read(DigestList(table.digests, scenes[asked]))
        for at, (_, response) in zip(np.argwhere(asked), read, strict=True):
            for number, target in mine.items():
                place = target.building if alone is None else 0
                demand[number][*at] = demands.of(response, target, point, case, place)
        return {number: Sample(method, x[point], each, asked) for number, each in demand.items()}

    points, cases, analyses = layout.linked.shape[:3]
    for point in range(points):
        alone: list[dict[int, Sample]] = []
        for analysis in range(analyses):
            scenes = layout.alone[point, analysis]
            each = [looked_at(scenes[..., place], point, 0, place) for place in range(scenes.shape[-1])]
            alone.append({number: sample for some in each for number, sample in some.items()})
        for case, analysis in np.ndindex(cases, analyses):
            with_pounding = looked_at(layout.linked[point, case, analysis], point, case, None)
            for number, sample in with_pounding.items():
                yield Place(point, case, analysis, number), sample, alone[analysis].get(number)


def fits_of(rows: pd.DataFrame, suffix: str, method: str, times: np.ndarray) -> Fits:
    """The fits of the bootstrap of one curve, from its rows in the table of motions.

    suffix : ALONE or ""; times : `resamples` of as many motions
    """
    motion, _ = motion_numbers(rows)
    if method == "ida":
        held, passed = rows["held" + suffix].to_numpy(), rows["passed" + suffix].to_numpy()
        return draw(Brackets.of(motion, held, passed, times.shape[1]), times)
    demand, x = rows["demand" + suffix].to_numpy(), rows["intensity"].to_numpy()
    if method == "stripes":
        known = ~np.isnan(demand)
        above = demand[known] > 1
        low, high = np.where(above, 0.0, x[known]), np.where(above, x[known], np.inf)
        return draw(Brackets.of(motion[known], low, high, times.shape[1]), times)
    some = np.isfinite(demand) & (demand > 0)
    return cloud_draw(x[some], demand[some], 1.0, motion[some], times)


def motion_numbers(rows: pd.DataFrame) -> tuple[np.ndarray, int]:
    """The number of the motion of every row of one curve, and how many motions there are."""
    names = list(dict.fromkeys(rows["record"]))
    return rows["record"].map({name: number for number, name in enumerate(names)}).to_numpy(), len(names)
