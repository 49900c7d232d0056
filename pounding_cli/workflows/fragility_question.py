"""`pound fragility`: what a study asks, checked; the intensities of its motions."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pounding_cli import records
from pounding_cli.model.links import LinkPlace, columns_struck, ends_on_columns, link_places
from pounding_cli.numbers import Unit
from pounding_cli.study.build import places
from pounding_cli.study.expression import COLLAPSE, CONTACT, SHEAR_DEMAND, Target
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
    targets = _targets(study, spec, problems)
    axis, measure = _intensity(study, spec, problems)
    if spec.method == "ida" and study.model.keep is not None:
        what = "histories cannot be kept where `pound fragility` chooses which intensities are solved"
        hint = "remove `keep:`, or write `method: stripes`; `pound run` keeps those of chosen intensities"
        problems.at(root, ("keep",), what, hint, key=True)
    problems.check()
    assert measure is not None
    return Question(spec, axis, measure, targets, hazard_of(study, "fragility", measure))


def _targets(study: Study, spec: FragilitySpec, problems: Problems) -> tuple[Target, ...]:
    root, group = study.root, study.model.group
    names = places(group)
    is_list = isinstance(get(root, "fragility", "limits"), list)
    found: dict[Target, None] = {}
    for number, limit in enumerate(spec.limits):
        path = ("fragility", "limits", number) if is_list else ("fragility", "limits")
        if limit.quantity == CONTACT:
            found |= {Target(limit, left): None for left in range(len(names) - 1)}
            continue
        mine = [
            place for place, name in enumerate(names) if not limit.building or limit.building in (name, group[place])
        ]
        if not mine:
            known = dict.fromkeys((*names, *group))
            problems.at(
                root, path, f"'{limit}': no building '{limit.building}' in the group", nearest(limit.building, known)
            )
        if limit.quantity == COLLAPSE and mine:
            standing, mine = mine, [place for place in mine if _can_collapse(study, place)]
            if not mine:
                who = " and ".join(names[place] for place in standing)
                hint = "write `p_delta: true` of a building that yields, or the drift: `collapse: 10 %`"
                problems.at(root, path, f"'{limit}': no storey of {who} can collapse", hint)
        tall = [place for place in mine if study.building((0,) * len(study.axes), place).storeys >= limit.level]
        if mine and not tall:
            most = max(study.building((0,) * len(study.axes), place).storeys for place in mine)
            problems.at(root, path, f"'{limit}': the highest is {most}", f"write a number from 1 to {most}")
        if limit.quantity == SHEAR_DEMAND and tall:
            tall = [place for place in tall if _can_be_struck(study, Target(limit, place))]
            if not tall:
                where = f"storey {limit.level} of " * bool(limit.level) + " and ".join(names[place] for place in mine)
                what = f"'{limit}': no slab strikes columns of {where} whose strength is known"
                hint = "write `columns:` in a building that yields; `pound check` lists where slabs strike columns"
                problems.at(root, path, what, hint)
        for place in tall:
            target = Target(limit, place)
            if target in found:
                problems.at(root, path, f"the limit '{limit}' occurs twice", "remove one of the two")
            found[target] = None
    return tuple(found)


def _can_collapse(study: Study, place: int) -> bool:
    """Whether a building may collapse, at any of `_some_points`."""
    return any(np.isfinite(study.building(point, place).collapse_drift).any() for point in _some_points(study))


def _can_be_struck(study: Study, target: Target) -> bool:
    """Whether a slab strikes columns of the target in any case, at any of `_some_points`."""
    return any(
        takes_blow(target, link_places(links), study.building(point, target.building).yield_shear)
        for point in _some_points(study)
        for case in study.model.cases
        if (links := study.links(point, case))
    )


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


def _some_points(study: Study) -> Iterator[tuple[int, ...]]:
    """The first point of the sweep, and those where one axis has another value."""
    first = [0] * len(study.axes)
    yield tuple(first)
    for number, axis in enumerate(study.axes):
        yield from ((*first[:number], value, *first[number + 1 :]) for value in range(1, len(axis.values)))


def _intensity(study: Study, spec: FragilitySpec, problems: Problems) -> tuple[int | None, Measure | None]:
    """The axis that varies the intensity and the measure of the curves."""
    root = study.root
    where = ("fragility", "intensity") if get(root, "fragility", "intensity") is not None else ("fragility",)
    varied = [number for number, axis in enumerate(study.axes) if not INTENSITY_KEYS.keys().isdisjoint(axis.names)]
    axis = varied[0] if varied else None
    if axis is None and spec.method != "cloud":
        what = f"the intensity{f' {spec.intensity}' if spec.intensity else ''} is not swept"
        problems.at(
            root, where, what, f"{_SWEEP}, or `method: cloud` for motions as they are", key=where[-1] == "fragility"
        )
        return None, None
    if axis is not None:
        _check_axis(study, axis, spec, problems)
    own = INTENSITY_KEYS.get(study.axes[axis].names[0]) if axis is not None else None
    wanted = spec.intensity or Measure(own or "pga")
    if wanted == Measure("sa") and own != "sa":
        problems.at(root, where, "sa is not swept and has no period", "write e.g. `intensity: sa(0.5 s)`")
    return axis, wanted


def _check_axis(study: Study, number: int, spec: FragilitySpec, problems: Problems) -> None:
    root, axis = study.root, study.axes[number]
    name = axis.names[0]
    if len(axis.names) > 1:
        together = " and ".join(axis.names)
        problems.at(
            root, ("sweep",), f"{together} move together: the intensity is an axis of its own", _SWEEP, key=True
        )
    elif any(isinstance(value, str) for (value,) in axis.values):
        problems.at(root, ("sweep",), f"'{name}' takes values that are not numbers", _SWEEP, key=True)
    elif len(axis.values) < 2 and spec.method != "cloud":
        problems.at(root, ("sweep", name), "a fragility curve takes two intensities at least", _SWEEP)


def intensities(plan: Plan, question: Question) -> np.ndarray:
    """The intensity of every motion at every level, rising, in SI; shape (other points, motions, levels).

    Every way to scale is in proportion to its value, so a motion is measured once.
    """
    study, axes, axis = plan.study, plan.axes, question.axis
    levels = np.ones(1) if axis is None else np.sort([float(value) for (value,) in axes[axis].values])
    others = [1 if number == axis else len(each.values) for number, each in enumerate(axes)]
    found = np.zeros((int(np.prod(others)), len(plan.records), len(levels)))
    if axis is not None and question.measure == Measure(INTENSITY_KEYS[axes[axis].names[0]]):
        return found + levels
    touched = study.touching("records")
    known: dict[tuple[int, ...], np.ndarray] = {}
    for number, point in enumerate(np.ndindex(*others)):
        key = tuple(place for place, is_touched in zip(point, touched, strict=True) if is_touched)
        if key not in known:
            used = study.motions(point)
            measured = [_measured(used[name].motion, used[name].use.scale, question.measure) for name in plan.records]
            first = 1.0 if axis is None else float(axes[axis].values[0][0])  # the level of `point`
            known[key] = np.array(measured)[:, None] * levels / first
        found[number] = known[key]
    return found


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
    if question.axis is not None and question.measure.name == INTENSITY_KEYS[plan.axes[question.axis].names[0]]:
        return plan.axes[question.axis].unit(0)
    if question.measure.name == "factor":
        return Unit()
    return Unit("m/s", 1.0, "m/s") if question.measure.name == "pgv" else plan.study.unit("acceleration")
