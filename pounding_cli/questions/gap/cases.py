"""Judge whether the gaps of the cases of a study are enough."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from pounding_cli.model.links import Link, LinkPlace
from pounding_cli.questions.gap.apart import BuildingKeys, find_building_keys
from pounding_cli.questions.gap.edges import PLACE_TOLERANCE
from pounding_cli.questions.gap.statistics import build_point_table
from pounding_cli.questions.gap.tables import CASES_COLUMNS, CASES_TABLE, MOTION_RULES, NO, UNKNOWN, YES
from pounding_cli.study import Plan, Study
from pounding_cli.study.construct.swept import Point
from pounding_cli.tables import Table

if TYPE_CHECKING:
    import pandas as pd


class CaseGaps(NamedTuple):
    """The gaps of a case at one point of the plan.

    point : by number
    case : by its place in the study
    gaps : place among the links of the plan -> smallest gap there [m]
    """

    point: int
    case: int
    gaps: tuple[tuple[int, float], ...]


def build_cases_table(study: Study, plan: Plan, separations: pd.DataFrame) -> Table:
    """Return CASES_TABLE: a row for every point, case, set of gaps, analysis, pair of neighbours and rule.

    A gap is enough where it is no narrower than what is required and its numerical error, at all floors of the pair.

    separations : of every place, rule, analysis and motion
    """
    import pandas as pd

    keys = ["point", "given", "number", "analysis", "rule"]
    gaps = build_gap_frame(study, plan)
    rows = separations.merge(gaps, on=["point", "place"])
    values = {name: rows[name].to_numpy() for name in ("motion", "value", "error", "gap")}
    depends_on_motions = rows["rule"].isin(MOTION_RULES).to_numpy()
    chosen: list[int] = []
    verdicts: list[Verdict] = []
    for positions in rows.groupby(keys, observed=True).indices.values():
        motion_count = int(values["motion"][positions[-1]]) + 1
        value, error, gap = (values[name][positions].reshape(-1, motion_count) for name in ("value", "error", "gap"))
        verdict = judge_gaps(value, error, gap[:, 0])
        if verdict is None:
            continue
        chosen.append(positions[verdict.floors * motion_count])
        verdicts.append(verdict if depends_on_motions[positions[0]] else verdict._replace(enough_for=0, motions=0))
    judged = pd.DataFrame(verdicts, rows.index[chosen], columns=list(Verdict._fields)).drop(columns="floors")
    rows = rows.iloc[chosen].join(judged).sort_values(keys, ignore_index=True)
    return build_point_table(plan, CASES_TABLE, rows, [each.name for each in CASES_COLUMNS if each.name in rows])


class Verdict(NamedTuple):
    """The verdict on the gaps between two neighbours.

    floors : number of the governing floors, which lack most or have least to spare
    required : there, the largest of the motions [m]
    enough : YES, NO or UNKNOWN, at all floors and under all motions
    enough_for : number of motions for which they are, at all floors
    motions : number of motions whose runs did not fail
    """

    floors: int
    required: float
    enough: str
    enough_for: int
    motions: int


def judge_gaps(value: np.ndarray, error: np.ndarray, gap: np.ndarray) -> Verdict | None:
    """Return whether gaps are enough; None where all runs failed.

    value, error : required separations and their numerical errors [m], shape (floors, motions); NaN of a failed run
    gap : of every two floors [m], shape (floors,)
    """
    is_known = ~np.isnan(value).any(axis=0)
    if not is_known.any():
        return None
    fits = (value + np.nan_to_num(error) <= gap[:, None])[:, is_known].all(axis=0)
    required = value[:, is_known].max(axis=1)
    governing = int(np.argmin(gap - required))
    enough = YES if is_known.all() else UNKNOWN
    if not fits.all():
        enough = NO
    return Verdict(governing, float(required[governing]), enough, int(fits.sum()), int(is_known.sum()))


def build_gap_frame(study: Study, plan: Plan) -> pd.DataFrame:
    """Return the gaps of the cases [m] by `point`, `case` and `place` of the plan, of neighbours that are only seen at
    their median buildings.

    At each point stands every set of gaps (`given`, by number) that the sweep of the study gives a case.
    """
    import pandas as pd

    cases = list(study.spec.cases)
    sets = sorted(dict.fromkeys(_iter_case_gaps(study, plan)), key=lambda each: (each.point, each.case))
    rows = [
        (each.point, given, cases[each.case], place, gap) for given, each in enumerate(sets) for place, gap in each.gaps
    ]
    frame = pd.DataFrame(rows, columns=["point", "given", "case", "place", "gap"])
    return frame.astype({"point": int, "place": int})


def _iter_case_gaps(study: Study, plan: Plan) -> Iterator[CaseGaps]:
    """Yield the gaps of every case at every point of the study.

    Left out are cases in which something acts between the buildings before a gap has closed, so that they do not move
    alone, and those without links.
    """
    axes = [find_building_keys(axis) for axis in study.axes]
    numbers_by_place: dict[LinkPlace, list[int]] = {}
    for number, link_place in enumerate(plan.links.places):
        numbers_by_place.setdefault(link_place._replace(name=""), []).append(number)
    for index in np.ndindex(*(len(axis) for axis in study.axes)):
        point = _find_plan_point(plan, axes, index)
        for case_number, case in enumerate(study.spec.cases):
            links = study.links(index, case)
            if not links or not all(link.law.subtracts_gap for link in links):
                continue
            gaps: dict[int, float] = {}
            for link in links:
                place = _find_place(plan, point, numbers_by_place.get(link.place, ()), link)
                gaps[place] = min(link.gap, gaps.get(place, link.gap))
            yield CaseGaps(point, case_number, tuple(gaps.items()))


def _find_place(plan: Plan, point: int, numbers: Sequence[int], link: Link) -> int:
    """Return the place of the plan at which a link ends where floors, or slab and columns, face each other; -1 if none.

    A link may end on the same columns at another height: what the place requires is not meant there. Floors that do not
    twist while nothing acts between them close alike everywhere, and have one place.

    numbers : of the places of its floors
    """
    links = plan.links
    where: tuple[Any, ...] = (*np.unravel_index(point, plan.shape[:-3]), 0)
    facing = []
    for number in numbers:
        heights = links.left_at[(*where, number)], links.right_at[(*where, number)]
        if np.allclose((link.left_at, link.right_at), heights):
            facing.append(number)
    if len(facing) == 1:
        return facing[0]
    for number in facing:
        arms = links.left_arm[(*where, number)], links.right_arm[(*where, number)]
        if np.allclose((link.left_arm, link.right_arm), arms, rtol=0.0, atol=PLACE_TOLERANCE):
            return number
    return -1


def _find_plan_point(plan: Plan, axes: list[BuildingKeys], index: Point) -> int:
    """Return the number of the plan's point at a point of the study, whose axes have these building keys; of further
    axes it is the first."""
    kept = [keys.values.index(keys.by_point[place]) for keys, place in zip(axes, index, strict=True) if keys.places]
    shape = plan.shape[:-3]
    kept += [0] * (len(shape) - len(kept))
    return int(np.ravel_multi_index(kept, shape)) if kept else 0
