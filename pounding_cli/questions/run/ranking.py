"""The case that is best for the building that fares worst in it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pounding_cli.laws.apart import Apart
from pounding_cli.model.scene import Analysis
from pounding_cli.numbers import join_limited
from pounding_cli.questions.run.twist import does_twist, line_values
from pounding_cli.report.evidence import Evidence
from pounding_cli.results.columns import column_of
from pounding_cli.results.flags import is_void
from pounding_cli.results.plausible import MAX_DUCTILITY
from pounding_cli.solver.response import DONE

if TYPE_CHECKING:
    from collections.abc import Iterator

ALIKE = 0.005
"""Cases whose worst responses differ by less than this part are alike [-]."""

MAX_NAMES = 200
"""Characters of the names of cases that are alike; more are counted."""

RANKED_RESPONSES = ((Analysis.ELASTIC, "V_ratio"), (Analysis.INELASTIC, "mu_ratio"), (Analysis.INELASTIC, "mu"))
"""Analysis and variable of every response by which cases are compared."""


@dataclass(frozen=True)
class Worst:
    """The worst response of any building in a case: the largest mean over the motions of any storey, or of any frame
    line where floors twist.

    value : [-]
    storey : from 1
    line : frame line from 1, of floors that twist; 0 of others
    """

    case: str
    value: float
    building: str
    storey: int
    line: int = 0

    @property
    def place(self) -> str:
        """Building, frame line where its floors twist, and storey."""
        line = f"line {self.line}, " if self.line else ""
        return f"{self.building}, {line}storey {self.storey}"


@dataclass(frozen=True)
class Ranking:
    """The cases by the worst response of any building, the best first.

    variable : the response, of RANKED_RESPONSES
    """

    analysis: str
    variable: str
    worst: tuple[Worst, ...]

    @property
    def best_cases(self) -> tuple[str, ...]:
        """The cases that are best, and alike."""
        limit = self.worst[0].value * (1 + ALIKE)
        return tuple(each.case for each in self.worst if each.value <= limit)

    def describe(self, motions: int, flags: Sequence[str]) -> str:
        """Return the response, and its value in the best, the next and the last case, as they stand in a sentence.

        motions : number of motions of the study
        flags : of the best cases
        """
        best = self.worst[0]
        label = f"{'mean ' if motions > 1 else ''}{column_of(self.variable).label}"
        others = self.worst[len(self.best_cases) :]
        flagged = [f"flagged: {join_limited(flags, MAX_NAMES)}"] if flags else []
        next_best = [f"next {others[0].case}, {others[0].value:#.3g}"] if others else []
        last = [f"last {others[-1].case}, {others[-1].value:#.3g}"] if len(others) > 1 else []
        details = "; ".join([best.place, *flagged, *next_best, *last])
        return f"{self.analysis} {label} {best.value:#.3g} ({details})"


def rank_cases(evidence: Evidence) -> list[Ranking]:
    """Return the rankings of the cases by every response that the study has; none of fewer than two cases.

    A case counts where it has links, and where all its time histories ended and mean something. Ductility demands rank
    no cases where the best one is far beyond the range of the storey law.
    """
    rankings = []
    for analysis, variable in RANKED_RESPONSES:
        if analysis not in evidence.analyses:
            continue
        worst = sorted(_iter_worst(evidence, analysis, variable), key=lambda each: each.value)
        is_beyond = variable == "mu" and len(worst) > 0 and worst[0].value > MAX_DUCTILITY
        if len(worst) > 1 and not is_beyond:
            rankings.append(Ranking(analysis, variable, tuple(worst)))
    return rankings


def _iter_worst(evidence: Evidence, analysis: str, variable: str) -> Iterator[Worst]:
    """Yield the worst response of every case that can be compared."""
    for case in evidence.cases:
        if not _is_comparable(evidence, case, analysis):
            continue
        worst = []
        for building in evidence.buildings_without_walls:
            means = mean_over_motions(evidence, variable, case, analysis, building)
            if np.isfinite(means).any():
                storey, *line = (int(each) + 1 for each in np.unravel_index(int(np.nanargmax(means)), means.shape))
                worst.append(Worst(case, float(np.nanmax(means)), building, storey, *line))
        if worst:
            yield max(worst, key=lambda each: each.value)


def mean_over_motions(evidence: Evidence, variable: str, case: str, analysis: str, building: str) -> np.ndarray:
    """Return the mean of a response over the motions, NaN where there is none, shape (storeys,); of a building whose
    floors twist that of its frame lines along the row, shape (storeys, lines)."""
    place = {"case": case, "analysis": analysis, "building": building}
    is_ratio = f"{variable}_mean" in evidence.results.arrays
    name = f"{variable}_mean" if is_ratio else variable
    if does_twist(evidence, building):
        values = line_values(evidence, f"line_{name}", **place)
    else:
        values = evidence.values(name, **place)
    return values if is_ratio else values.mean(axis=0)


def _is_comparable(evidence: Evidence, case: str, analysis: str) -> bool:
    """Return whether a case has links, and every time history ended and means something."""
    if "kind" not in evidence.results.arrays:
        return False
    if all(kind in ("", Apart.name) for kind in evidence.values("kind", case=case).tolist()):
        return False
    statuses = evidence.values("status", case=case, analysis=analysis)
    flags = evidence.values("flags", case=case, analysis=analysis)
    return bool((statuses == DONE).all()) and not any(map(is_void, flags.tolist()))


def describe_ranking(evidence: Evidence) -> str:
    """Return the case that is best for the building that fares worst in it; "" where there is nothing to compare."""
    rankings = rank_cases(evidence)
    if not rankings:
        return ""
    by_cases: dict[tuple[str, ...], list[Ranking]] = {}
    for ranking in rankings:
        by_cases.setdefault(ranking.best_cases, []).append(ranking)
    for_whom = "for the worse building" if len(evidence.buildings_without_walls) > 1 else "for the building"
    motions = len(evidence.names("record"))
    clauses = []
    for cases, group in by_cases.items():
        responses = ", ".join(
            ranking.describe(motions, _list_flags(evidence, cases, ranking.analysis)) for ranking in group
        )
        clauses.append(f"{_name_best(cases)} {for_whom} by {responses}")
        for_whom = ""
    return f"{'; '.join(' '.join(clause.split()) for clause in clauses)}."


def _list_flags(evidence: Evidence, cases: Sequence[str], analysis: str) -> list[str]:
    """Return the kinds of flags of some cases."""
    groups = [group for group in evidence.flag_groups if group.case in cases and group.analysis == analysis]
    return list(dict.fromkeys(group.flag for group in groups))


def _name_best(cases: Sequence[str]) -> str:
    if len(cases) == 1:
        return f"case {cases[0]} is best"
    return f"cases {join_limited(cases, MAX_NAMES)} are best, and alike,"
