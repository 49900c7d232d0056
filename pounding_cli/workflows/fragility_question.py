"""`pound fragility`: what a study asks, checked; the intensities of its motions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pounding_cli import records
from pounding_cli.model.links import LinkPlace, columns_struck, ends_on_columns, link_places
from pounding_cli.numbers import Unit
from pounding_cli.study.build import places
from pounding_cli.study.expression import COLLAPSE, CONTACT, SHEAR_DEMAND, Limit, Target
from pounding_cli.study.file import Problems, get, nearest
from pounding_cli.study.plan import Plan
from pounding_cli.study.questions import FragilitySpec, Measure
from pounding_cli.study.study import Point, Study
from pounding_cli.workflows.hazard import INTENSITY_KEYS, Hazard, hazard_of
from pounding_cli.workflows.workflow import refuse_histories

_SWEEP = "write e.g. `sweep: {records.scale.pga: {from: 0.05 g, to: 2 g, step: 0.05 g}}`"


@dataclass(frozen=True)
class Question:
    """What `pound fragility` is asked of a study.

    spec : its section
    axis : number of the swept axis that varies the intensity; None of a cloud without one
    swept : the measure that it varies; "" without one
    measure : the intensity measure of the curves; `swept` unless another is wanted
    targets : in the order of the limits
    hazard : how often a year an intensity is exceeded; None where nothing is asked of it
    """

    spec: FragilitySpec
    axis: int | None
    swept: str
    measure: Measure
    targets: tuple[Target, ...]
    hazard: Hazard | None


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
    swept = "" if axis is None else INTENSITY_KEYS.get(study.axes[axis].names[0], "")
    measure = spec.intensity or Measure(swept or "pga")
    if measure == Measure("sa") and swept != "sa" and (axis is not None or spec.method == "cloud"):
        problems.at(root, _said(study), "sa is not swept and has no period", "write e.g. `intensity: sa(0.5 s)`")
    if spec.method == "ida":
        refuse_histories(study, "the scenes that `pound fragility` chooses", problems)
    problems.check()
    return Question(spec, axis, swept, measure, tuple(targets), hazard_of(study, "fragility", measure))


# Limits


def _targets(study: Study, limit: Limit, path: tuple[str | int, ...], problems: Problems) -> list[Target]:
    """The buildings, or pairs, that a limit concerns; what is wrong with it is noted."""
    group, names = study.model.group, places(study.model.group)
    if limit.quantity == CONTACT:
        return [Target(limit, left) for left in range(len(names) - 1)]
    first, wanted = (0,) * len(study.axes), limit.building
    mine = [place for place, name in enumerate(names) if not wanted or wanted in (name, group[place])]
    storeys = {place: study.building(first, place).storeys for place in mine}
    found = [Target(limit, place) for place in mine if storeys[place] >= limit.level]
    able = {COLLAPSE: _can_collapse, SHEAR_DEMAND: _can_be_struck}.get(limit.quantity)
    if not mine:
        what = f"'{limit}': no building '{wanted}' in the group"
        problems.at(study.root, path, what, nearest(wanted, dict.fromkeys((*names, *group))))
    elif not found:
        most = max(storeys.values())
        problems.at(study.root, path, f"'{limit}': the highest is {most}", f"write a number from 1 to {most}")
    elif able is not None:
        points = list(np.ndindex(*(len(axis.values) for axis in study.axes)))
        found = [target for target in found if any(able(study, target, at) for at in points)]
        if not found:
            problems.at(study.root, path, f"'{limit}': no storey there can pass it", _CANNOT[limit.quantity])
    return found


_CANNOT = {
    COLLAPSE: "write `p_delta: true` of a building that yields, or the drift: `collapse: 10 %`",
    SHEAR_DEMAND: "write `columns:` in a building that yields; `pound check` lists where slabs strike columns",
}


def _can_collapse(study: Study, target: Target, at: Point) -> bool:
    return bool(np.isfinite(study.building(at, target.building).collapse_drift).any())


def _can_be_struck(study: Study, target: Target, at: Point) -> bool:
    """Whether a slab strikes columns of the building in any case."""
    yield_shear = study.building(at, target.building).yield_shear
    links = (place for case in study.model.cases for place in link_places(study.links(at, case) or ()))
    return any(takes_blow(target, place, yield_shear) for place in links)


def takes_blow(target: Target, place: LinkPlace, yield_shear: np.ndarray) -> bool:
    """Whether a link strikes columns of the target's building, of its only storey if the limit names one; not those of
    storeys that cannot yield: nothing says what they can carry.

    yield_shear : of the building's storeys [N], shape (storeys,)
    """
    if not ends_on_columns(place):
        return False
    building, storey = columns_struck(place)
    is_meant = building == target.building and target.limit.level in (0, storey)
    return bool(is_meant and yield_shear[storey - 1] < np.inf)


# Intensities


def _said(study: Study) -> tuple[str, ...]:
    """Where the study says its intensity."""
    is_said = get(study.root, "fragility", "intensity") is not None
    return ("fragility", "intensity") if is_said else ("fragility",)


def _axis(study: Study, spec: FragilitySpec, problems: Problems) -> int | None:
    """The axis that varies the intensity; what is wrong with it is noted."""
    root = study.root
    for number, axis in enumerate(study.axes):
        if INTENSITY_KEYS.keys().isdisjoint(axis.names):
            continue
        name = axis.names[0]
        if len(axis.names) > 1:
            what = f"{' and '.join(axis.names)} move together: the intensity is an axis of its own"
            problems.at(root, ("sweep",), what, _SWEEP, key=True)
        elif any(isinstance(value, str) for (value,) in axis.values):
            problems.at(root, ("sweep",), f"'{name}' takes values that are not numbers", _SWEEP, key=True)
        elif len(axis.values) < 2 and spec.method != "cloud":
            problems.at(root, ("sweep", name), "a fragility curve takes two intensities at least", _SWEEP)
        return number
    if spec.method != "cloud":
        hint = f"{_SWEEP}, or `method: cloud` for motions as they are"
        problems.at(root, _said(study), "the intensity is not swept", hint, key=len(_said(study)) == 1)
    return None


def intensities(plan: Plan, question: Question) -> np.ndarray:
    """The intensity of every motion at every level, rising, in SI; shape (other points, motions, levels).

    Every way to scale is in proportion to its value, so a motion is measured once.
    """
    study, axis, measure = plan.study, question.axis, question.measure
    values = [1.0] if axis is None else [float(value) for (value,) in plan.axes[axis].values]
    levels = np.sort(values)
    points = list(np.ndindex(*(1 if number == axis else len(each.values) for number, each in enumerate(plan.axes))))
    found = np.broadcast_to(levels, (len(points), len(plan.records), len(levels)))
    if measure == Measure(question.swept):
        return found
    known: dict[Point, np.ndarray] = {}
    for point in points:
        key = study.key(point, ("records",))
        if key not in known:
            used = study.motions(point)
            known[key] = np.array(
                [_measured(used[name].motion, used[name].use.scale, measure) for name in plan.records]
            )
    scale = np.array([known[study.key(point, ("records",))] for point in points])
    return scale[..., None] * found / values[0]  # of the point where they were measured


def _measured(motion: records.Motion, scale: float, measure: Measure) -> float:
    if measure.name == "factor":
        return scale
    if measure.name == "pga":
        return motion.pga
    if measure.name == "pgv":
        return records.pgv(motion)
    return float(records.spectrum(motion, (measure.period,))[0])


def intensity_unit(plan: Plan, question: Question) -> Unit:
    """The unit that people read intensities in."""
    name = question.measure.name
    if question.axis is not None and name == question.swept:
        return plan.axes[question.axis].units[0]
    return {"factor": Unit(), "pgv": Unit("m/s", 1.0, "m/s")}.get(name) or plan.study.unit("acceleration")
