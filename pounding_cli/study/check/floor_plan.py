"""Check plans of floors that twist that hardly any building has."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from pounding_cli.errors import Issue, KeyPath
from pounding_cli.model.building import Building
from pounding_cli.model.plan import FloorPlan
from pounding_cli.model.twist import needs_plan
from pounding_cli.numbers import join_limited
from pounding_cli.study.check.values import AS_MEANT, format_value, units_of_size
from pounding_cli.study.schema.floor_plan import PlanSpec
from pounding_cli.study.schema.links import list_links
from pounding_cli.study.study import Study
from pounding_cli.study.text.file import get

RATIOS_OF_TWIST = (0.7, 3.0)
"""Frequency of the twist over that along the row [-] beyond which it is warned of: frames at all edges give 1 to 1.5, a
core alone in the middle 0.7, walls at all edges 2."""

RADII_OF_GYRATION = (0.2, 0.8)
"""Radius of gyration of a floor over its width [-] beyond which it is warned of: a narrow strip along the street has
0.29, a floor that is twice as deep as wide 0.65."""

MAX_ECCENTRICITY = 0.35
"""Eccentricity over the width [-] above which it is warned of: a core at one end, frames at the other give a third."""


MAX_OFFSET_ACROSS = 0.1
"""Distance of the centre of the lines across from that of mass, over that of the line farthest from it [-], above which
it is warned of the motion along the street that is left out."""


def check_plan(spec: PlanSpec, building: Building, path: KeyPath) -> Iterator[Issue]:
    """Yield a plan that hardly any building has: eccentricity, rotary inertia, resistance to the twist."""
    plan = building.plan
    assert plan is not None
    yield from _check_eccentricity(spec, plan, path)
    yield from _check_lines_across(plan, path)
    if spec.inertia is not None:
        yield from _check_inertia(spec, plan, building.mass, path)
    yield from _check_frequency_ratio(spec, building.name, plan.frequency_ratio(building.mass), path)


def _check_eccentricity(spec: PlanSpec, plan: FloorPlan, path: KeyPath) -> Iterator[Issue]:
    """Yield centres of stiffness that stand far from those of mass."""
    largest = float(np.abs(plan.eccentricity).max()) / spec.width
    if largest <= MAX_ECCENTRICITY:
        return
    key_path: KeyPath = (*path, "lines" if spec.lines is not None else "eccentricity")
    share = f"{100 * largest:.3g} % of the width"
    message = f"the centre of stiffness stands {share} from the centre of mass: "
    message += "a core at one end with frames at the other gives a third"
    hint = f"check the places and the stiffness of the lines; otherwise leave it, {AS_MEANT}"
    yield Issue(key_path, message, hint, code="eccentricity", excess=largest)


def _check_inertia(spec: PlanSpec, plan: FloorPlan, mass: np.ndarray, path: KeyPath) -> Iterator[Issue]:
    """Yield a rotary inertia that no floor of this width has; mass : of the floors [kg], shape (n,)."""
    radius = np.sqrt(plan.inertia / mass) / spec.width
    low, high = RADII_OF_GYRATION
    wrong = np.flatnonzero((radius < low) | (radius > high))
    if not wrong.size:
        return
    storey = int(wrong[0])
    key_path: KeyPath = (*path, "inertia")
    if isinstance(spec.inertia, tuple):
        key_path = (*key_path, storey)
    usual = float(mass[storey]) * spec.width**2 / np.array([9.0, 4.0])
    distance = f"{radius[storey] * spec.width:.3g} m"
    message = f"floor {storey + 1} turns as if its mass stood {distance} from its centre"
    message += f", on a plan {spec.width:g} m wide"
    units = units_of_size("kg m2")
    texts = " to ".join(format_value(float(each), units) for each in usual)
    hint = f"write an inertia near {texts}; otherwise leave it, {AS_MEANT}"
    excess = abs(float(np.log10(radius[storey])))
    yield Issue(key_path, message, hint, code="rotary-inertia", of=(*path, "inertia"), excess=excess)


def _check_frequency_ratio(spec: PlanSpec, name: str, ratio: float, path: KeyPath) -> Iterator[Issue]:
    """Yield a twist that is much slower or faster than the motion along the row; name : of the building."""
    low, high = RATIOS_OF_TWIST
    if low <= ratio <= high:
        return
    keys = ("frequency_ratio", "torsional_stiffness", "lines")
    key = next(each for each in keys if each in spec.model_fields_set)
    message = f"{name} turns {ratio:.3g} times as fast as it moves along the row, each by itself: "
    message += "frames at the edges give 1 to 1.5, a core in the middle 0.7, walls at all edges 2"
    hint = "check the places of lines, the torsional stiffness and the inertia; "
    hint += f"otherwise leave it, {AS_MEANT}"
    yield Issue((*path, key), message, hint, code="twist-frequency", excess=abs(float(np.log10(ratio))))


def _check_lines_across(plan: FloorPlan, path: KeyPath) -> Iterator[Issue]:
    """Yield lines across the row that move floors along the street when these twist, which is left out."""
    if not plan.lines_across:
        return
    places = np.array([line.arm for line in plan.lines_across])
    stiffness = np.array([line.stiffness for line in plan.lines_across])  # shape (lines, storeys)
    key_path: KeyPath = (*path, "across")
    farthest = float(np.abs(places).max())
    if farthest == 0.0:
        message = "all lines across the row stand at the centre of mass, where they resist no twist"
        hint = f"let `x` be where they stand; otherwise leave it, {AS_MEANT}"
        yield Issue(key_path, message, hint, code="across")
        return
    offset = float(np.abs(places @ stiffness / stiffness.sum(axis=0)).max())
    if offset > MAX_OFFSET_ACROSS * farthest:
        message = (
            f"the centre of the lines across the row stands {offset:.3g} m from that of mass: floors that twist then "
        )
        message += "also move along the street, which is left out"
        hint = f"write all frames and walls across the row, on both sides; otherwise leave it, {AS_MEANT}"
        yield Issue(key_path, message, hint, code="across", excess=offset / farthest)


def check_accidental(study: Study) -> Iterator[Issue]:
    """Yield that codes, with whose displacements `gap:` compares, ask for an accidental eccentricity."""
    if study.tree.get("gap") is None:
        return
    names = []
    for name in dict.fromkeys(study.spec.group):
        building = study.parts.types[name].value_at(study.first_point)
        has_displacements = bool(study.parts.displacements(name).value_at(study.first_point))
        if has_displacements and needs_plan(building) and not _has_accidental(study, name):
            names.append(name)
    if names:
        message = f"the displacements that codes expect of {join_limited(names)} "
        message += "leave out an accidental eccentricity"
        hint = "they count the twist under forces through the centres of mass; "
        hint += "codes move these by 5 % of the width to either side: "
        hint += "write `accidental: +-5 %` in the plan"
        yield Issue(("gap",), message, hint, at_key=True, code="accidental")


def _has_accidental(study: Study, name: str) -> bool:
    """Return whether the centres of mass of a building move off at some point of the sweep."""
    specs = (spec for _, spec in study.parts.building_specs[name].iter_values())
    return any(spec.plan is not None and spec.plan.accidental for spec in specs)


def check_shift(study: Study) -> Iterator[Issue]:
    """Yield that the place of a plan along the street does nothing where no neighbour and no link has one."""
    with_plans = [
        name
        for name in study.spec.group
        if any(spec.plan is not None for _, spec in study.parts.building_specs[name].iter_values())
    ]
    cases = study.spec.cases.items()
    has_places = any(link.places is not None for case in cases for link, _ in list_links(*case))
    if len(with_plans) != 1 or len(study.spec.group) == 1 or has_places:
        return
    (name,) = with_plans
    key = f"buildings.{name}.plan.shift"
    varied: list[KeyPath] = [("sweep",), ("uncertain",), ("optimise", "over")]
    paths = [(*section, key) for section in varied if key in (get(study.tree, *section) or ())]
    if any(spec.plan is not None and spec.plan.shift for _, spec in study.parts.building_specs[name].iter_values()):
        paths.append(("buildings", name, "plan", "shift"))
    if paths:
        message = f"`shift` of {name} has no effect: no other building has a plan, so each is as wide as {name}, "
        message += "and no link names its places"
        hint = f"give the neighbours of {name} a `plan:`, or the links their `places:`; otherwise leave it, {AS_MEANT}"
        yield Issue(paths[0], message, hint, code="shift")
