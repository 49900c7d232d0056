"""`pound fragility`: what a study asks, checked; the intensities of its motions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pounding_cli import records
from pounding_cli.model.links import LinkPlace, columns_struck, ends_on_columns, link_places
from pounding_cli.numbers import Unit
from pounding_cli.study.build import places
from pounding_cli.study.expression import COLLAPSE, CONTACT, SHEAR_DEMAND, Limit, Target
from pounding_cli.study.file import Problems, get, nearest
from pounding_cli.study.plan import Plan
from pounding_cli.study.questions import FragilitySpec, Measure
from pounding_cli.study.study import Study
from pounding_cli.workflows.hazard import Hazard, hazard_of

if TYPE_CHECKING:
    from pounding_cli.records import Motion

INTENSITY_KEYS = {
    "records.scale": "factor", "records.scale.pga": "pga", "records.scale.pgv": "pgv", "records.scale.sa": "sa",
}  # fmt: skip
"""Keys whose sweep varies the intensity, and the measure that each is."""

_SWEEP = "write e.g. `sweep: {records.scale.pga: {from: 0.05 g, to: 2 g, step: 0.05 g}}`"


@dataclass(frozen=True)
class Question:
    """What `pound fragility` is asked of a study.

    spec : its section
    axis : number of the swept axis that varies the intensity; None of a cloud without one
    measure : the intensity measure of the curves; that of `axis` unless another is wanted
    targets : in the order of the limits
    hazard : how often a year an intensity is exceeded; None where nothing is asked of it
    """

    spec: FragilitySpec
    axis: int | None
    measure: Measure
    targets: tuple[Target, ...]
    hazard: Hazard | None = None


def question_of(study: Study) -> Question:
    """What a study asks.

    Raises
    ------
    InputError : no limit, one that concerns no building of the group, an intensity that is not swept
    """
    spec: FragilitySpec = study.model.fragility
    problems, root = Problems(study.file), study.root
    if not spec.limits:
        hint = "write e.g. `fragility: {limits: [mu > 4]}`"
        problems.at(root, ("fragility",), "the study has no limit, whose fragility could be sought", hint, key=True)
    is_list, targets = isinstance(get(root, "fragility", "limits"), list), list[Target]()
    for number, limit in enumerate(spec.limits):
        path = ("fragility", "limits", number) if is_list else ("fragility", "limits")
        for target in _targets(study, limit, path, problems):
            if target in targets:
                problems.at(root, path, f"the limit '{limit}' occurs twice", "remove one of the two")
            targets.append(target)
    axis = _axis(study, spec, problems)
    own = "pga" if axis is None else INTENSITY_KEYS.get(study.axes[axis].names[0], "pga")
    measure = spec.intensity or Measure(own)
    if measure == Measure("sa") and own != "sa" and (axis is not None or spec.method == "cloud"):
        what = "sa is not swept and has no period"
        problems.at(root, _place(study), what, "write e.g. `intensity: sa(0.5 s)`")
    if spec.method == "ida" and study.model.keep is not None:
        what = "histories cannot be kept where `pound fragility` chooses which intensities are solved"
        hint = "remove `keep:`, or write `method: stripes`; `pound run` keeps those of chosen intensities"
        problems.at(root, ("keep",), what, hint, key=True)
    problems.check()
    return Question(spec, axis, measure, tuple(targets), hazard_of(study, "fragility", measure))


# Limits


def _targets(study: Study, limit: Limit, path: tuple[str | int, ...], problems: Problems) -> list[Target]:
    """The buildings, or pairs, that a limit concerns; what is wrong with it is noted."""
    root, group, names = study.root, study.model.group, places(study.model.group)
    if limit.quantity == CONTACT:
        return [Target(limit, left) for left in range(len(names) - 1)]
    wanted = limit.building
    mine = [place for place, name in enumerate(names) if not wanted or wanted in (name, group[place])]
    who, storeys = " and ".join(names[place] for place in mine), _storeys(study, mine)
    if not mine:
        what = f"'{limit}': no building '{wanted}' in the group"
        problems.at(root, path, what, nearest(wanted, dict.fromkeys((*names, *group))))
    elif limit.level > max(storeys):
        hint = f"write a number from 1 to {max(storeys)}"
        problems.at(root, path, f"'{limit}': the highest is {max(storeys)}", hint)
    found = [Target(limit, place) for place, most in zip(mine, storeys, strict=True) if most >= limit.level]
    if limit.quantity == COLLAPSE and found:
        found = [target for target in found if _can_collapse(study, target)]
        if not found:
            hint = "write `p_delta: true` of a building that yields, or the drift: `collapse: 10 %`"
            problems.at(root, path, f"'{limit}': no storey of {who} can collapse", hint)
    if limit.quantity == SHEAR_DEMAND and found:
        found = [target for target in found if _can_be_struck(study, target)]
        if not found:
            where = f"storey {limit.level} of " * bool(limit.level) + who
            hint = "write `columns:` in a building that yields; `pound check` lists where slabs strike columns"
            what = f"'{limit}': no slab strikes columns of {where} whose strength is known"
            problems.at(root, path, what, hint)
    return found


def _storeys(study: Study, mine: Sequence[int]) -> list[int]:
    return [study.building((0,) * len(study.axes), place).storeys for place in mine]


def _can_collapse(study: Study, target: Target) -> bool:
    """Whether the building may collapse, at any point of the sweep."""
    return any(np.isfinite(study.building(at, target.building).collapse_drift).any() for at in _points(study))


def _can_be_struck(study: Study, target: Target) -> bool:
    """Whether a slab strikes columns of the building in any case, at any point of the sweep."""
    for at in _points(study):
        yield_shear = study.building(at, target.building).yield_shear
        for case in study.model.cases:
            if takes_blow(target, link_places(study.links(at, case) or ()), yield_shear):
                return True
    return False


def _points(study: Study) -> np.ndindex:
    return np.ndindex(*(len(axis.values) for axis in study.axes))


def takes_blow(target: Target, places: Sequence[LinkPlace], yield_shear: np.ndarray) -> list[int]:
    """Numbers of the links that strike columns of the target's building, of its only storey if the limit names one;
    those of storeys that cannot yield are left out: nothing says what they can carry.

    yield_shear : of the building's storeys [N], shape (storeys,)
    """
    found = []
    for number, place in enumerate(places):
        if ends_on_columns(place):
            building, storey = columns_struck(place)
            is_meant = building == target.building and target.limit.level in (0, storey)
            if is_meant and yield_shear[storey - 1] < np.inf:
                found.append(number)
    return found


# Intensities


def _place(study: Study) -> tuple[str, ...]:
    """Where the study says its intensity."""
    is_said = get(study.root, "fragility", "intensity") is not None
    return ("fragility", "intensity") if is_said else ("fragility",)


def _axis(study: Study, spec: FragilitySpec, problems: Problems) -> int | None:
    """The axis that varies the intensity; what is wrong with it is noted."""
    root = study.root
    for number, axis in enumerate(study.axes):
        if INTENSITY_KEYS.keys().isdisjoint(axis.names):
            continue
        name, together = axis.names[0], " and ".join(axis.names)
        if len(axis.names) > 1:
            what = f"{together} move together: the intensity is an axis of its own"
            problems.at(root, ("sweep",), what, _SWEEP, key=True)
        elif any(isinstance(value, str) for (value,) in axis.values):
            problems.at(root, ("sweep",), f"'{name}' takes values that are not numbers", _SWEEP, key=True)
        elif len(axis.values) < 2 and spec.method != "cloud":
            problems.at(root, ("sweep", name), "a fragility curve takes two intensities at least", _SWEEP)
        return number
    if spec.method != "cloud":
        what = f"the intensity{f' {spec.intensity}' if spec.intensity else ''} is not swept"
        hint = f"{_SWEEP}, or `method: cloud` for motions as they are"
        problems.at(root, _place(study), what, hint, key=len(_place(study)) == 1)
    return None


def swept_measure(plan: Plan, question: Question) -> str:
    """The measure that the sweep varies; "" without one."""
    return "" if question.axis is None else INTENSITY_KEYS[plan.axes[question.axis].names[0]]


def intensities(plan: Plan, question: Question) -> np.ndarray:
    """The intensity of every motion at every level, rising, in SI; shape (other points, motions, levels).

    Every way to scale is in proportion to its value, so a motion is measured once.
    """
    study, axis = plan.study, question.axis
    values = [1.0] if axis is None else [float(value) for (value,) in plan.axes[axis].values]
    levels = np.sort(values)
    points = list(np.ndindex(*(1 if number == axis else len(each.values) for number, each in enumerate(plan.axes))))
    if question.measure == Measure(swept_measure(plan, question)):
        return np.broadcast_to(levels, (len(points), len(plan.records), len(levels)))
    known: dict[tuple[int, ...], np.ndarray] = {}
    for point in points:
        key = study.key(point, ("records",))
        if key not in known:
            used = [study.motions(point)[name] for name in plan.records]
            measured = [_measured(each.motion, each.use.scale, question.measure) for each in used]
            known[key] = np.array(measured)[:, None] * levels / values[0]  # the level of `point`
    return np.array([known[study.key(point, ("records",))] for point in points])


def _measured(motion: Motion, scale: float, measure: Measure) -> float:
    if measure.name == "factor":
        return scale
    if measure.name == "pga":
        return motion.pga
    if measure.name == "pgv":
        return 1.0 / records.pgv_factor(motion, 1.0)
    return 1.0 / records.sa_factor(motion, 1.0, measure.period)


def intensity_unit(plan: Plan, question: Question) -> Unit:
    """The unit that people read intensities in."""
    name = question.measure.name
    if question.axis is not None and name == swept_measure(plan, question):
        return plan.axes[question.axis].unit(0)
    return {"factor": Unit(), "pgv": Unit("m/s", 1.0, "m/s")}.get(name) or plan.study.unit("acceleration")
