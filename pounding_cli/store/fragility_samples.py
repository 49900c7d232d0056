"""What each curve of `pound fragility` rests on: demand over limit of every motion and intensity, from the tables."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pounding_cli.digests import DigestList, pieces
from pounding_cli.fragility import (
    Brackets,
    Curve,
    Fits,
    cloud,
    cloud_draw,
    draw,
    fit,
)
from pounding_cli.fragility.hunt import found
from pounding_cli.model.placed import among
from pounding_cli.store.answers import Read
from pounding_cli.store.fragility_demand import Demands
from pounding_cli.study.fragility import intensities
from pounding_cli.study.fragility_rounds import Layout

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
    demand : over limit [-], above 1 where the limit is passed; NaN where the scene failed, was not asked for or ended
        with a collapse that leaves it unknown
    asked : whether the scene was
    ended : whether a collapse ended the scene
    """

    method: str
    intensity: np.ndarray
    demand: np.ndarray
    asked: np.ndarray
    ended: np.ndarray

    @property
    def failed(self) -> int:
        """Scenes that failed."""
        return int((self.asked & np.isnan(self.demand) & ~self.ended).sum())  # fault: failed-scenes-counted

    @property
    def undecided(self) -> int:
        """Scenes that did not fail and tell nothing of the limit: a collapse ended them first or, of a cloud, their
        demand has no logarithm."""
        known = self._drawable if self.method == "cloud" else ~np.isnan(self.demand)
        return int((self.asked & ~known).sum()) - self.failed

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
        known = ~np.isnan(self.demand)  # fault: failed-scene-of-stripes
        above = self.demand[known] > 1
        x = self.intensity[known]
        return Brackets.of(
            np.nonzero(known)[0], np.where(above, 0.0, x), np.where(above, x, np.inf), motions
        )  # fmt: skip

    def curve(self) -> Curve:
        """The fit."""
        if self.method != "cloud":
            return fit(self.brackets())
        some = self._drawable
        return cloud(self.intensity[some], self.demand[some], 1.0, np.nonzero(some)[0]).curve

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
    plan: Plan, read: Read, question: Question, layout: Layout
) -> Iterator[tuple[Place, Sample, Sample | None]]:
    """Every curve: with pounding, and alone (None: what takes a neighbour)."""
    demands = Demands(plan, read, question, layout)
    x, method = intensities(plan, question), question.spec.method
    digests = DigestList(plan.rows.table.digests)
    is_asked = np.concatenate([among(plan.scenes, some) for some in pieces(digests)])
    asked, asked_alone = is_asked[layout.linked], is_asked[layout.alone]
    for point, case, analysis in np.ndindex(*asked.shape[:3]):
        for number, target in enumerate(question.targets):
            with_pounding, free = demands.of(target, point, case, analysis)
            alone = None
            if free is not None:
                mine = asked_alone[point, analysis, :, :, target.building]
                alone = Sample(method, x[point], free.demand, mine, free.ended)
            here = asked[point, case, analysis]
            one = Sample(method, x[point], with_pounding.demand, here, with_pounding.ended)
            yield Place(point, case, analysis, number), one, alone


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
