"""What a study may say but hardly means: warnings of values that are not plausible (`quantity.py` has the ranges)."""

from __future__ import annotations

import functools
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, get_args, get_origin

import numpy as np
from pydantic import BaseModel

from pounding_cli.errors import Problem
from pounding_cli.laws import link_laws
from pounding_cli.numbers import counted, listed
from pounding_cli.study import schema
from pounding_cli.study.axes import sweep_maps
from pounding_cli.study.build import Group, tell_left_out
from pounding_cli.study.file import Items, Map, Mark, Problems, Steps, get, locate
from pounding_cli.study.models import Case, StiffnessAt
from pounding_cli.study.motions import Used
from pounding_cli.study.quantity import (
    ACCELERATION,
    FORCES,
    NUMBER,
    RANGES,
    STIFFNESSES,
    Plausible,
    Quantity,
    Text,
    lacks_unit,
)
from pounding_cli.study.words import fields_of, leaves, quantity_at
from pounding_cli.units import GRAVITY

if TYPE_CHECKING:
    from pounding_cli.study.study import Point, Study

MOST_ALIKE = 3
"""Warnings told one by one that differ in their numbers alone, as along a swept axis."""

_MOST_IN_G = 3.0
# Of a number without unit: recorded peaks reach 3 g.

_AS_MEANT = "the study runs as it is"
_PARTED = re.compile(rf"\s*({NUMBER})\s*(.*?)\s*\Z")


def warnings(study: Study) -> tuple[Problem, ...]:
    """What is allowed in a study but should be known, in the order of its lines: at the first point of the sweep, and
    where one axis moves away from it."""
    notes, seen = study.notes, set[Any]()

    def is_new(name: str, point: Point, *subjects: Any) -> bool:
        """Whether something was not yet looked at where nothing that it depends on differs."""
        key = name, study.key(point, subjects)
        return key not in seen and not seen.add(key)  # type: ignore[func-returns-value]

    for point in _points([len(axis) for axis in study.axes]):
        root, group = study.at(point), study.group(point)
        assert group is not None  # the study was validated
        for name in study.model.buildings:
            if is_new(name, point, ("buildings", name)):
                doubt_building(study, point, name, root, notes)
        if is_new("group", point, "buildings", "group"):
            tell_left_out(group.buildings, root, ("group",), notes)
        for name in study.model.cases:
            if is_new(name, point, "buildings", "group", "impact", ("cases", name)):
                case, impact = study.case(point, name), study.section(point, "impact")
                assert case is not None
                doubt_values(case, root, ("cases", name), notes)
                doubt_stiffnesses(case, impact, group, root, ("cases", name), notes)
        if is_new("motions", point, "records"):
            doubt_motions(study.motions(point), root, notes)
    doubt_accelerations(study.root, notes)
    if study.model.impact.dashpot == "printed":
        message = "eq. (7) as printed has the unit 1/s, not kg/s: its dashpot depends on the unit of mass"
        hint = "leave it out for the dashpot that gives the coefficient of restitution"
        notes.at(study.root, ("impact", "dashpot"), message, hint)
    return tuple(few(sorted(notes.found, key=lambda note: (note.file, note.line, note.column))))


def _points(sizes: Sequence[int]) -> Iterator[Point]:
    """The first point of a sweep, and those that differ from it in one value."""
    first = (0,) * len(sizes)
    yield first
    for place, size in enumerate(sizes):
        yield from ((*first[:place], index, *first[place + 1 :]) for index in range(1, size))


# Buildings and links


def doubt_building(study: Study, point: Point, name: str, root: Any, notes: Problems) -> None:
    """Note what is unlikely about a building type: masses, heights, period, damping, yield shears."""
    spec, building, path = study.building_spec(point, name), study.type(point, name), ("buildings", name)
    assert spec is not None
    assert building is not None  # the study was validated
    doubt_values(spec, root, path, notes)
    if spec.wall is not None:
        return
    storeys = building.storeys
    at: Steps = (*path, "period")
    if spec.stiffness is not None:
        at = (*path, "stiffness", "period" if isinstance(spec.stiffness, StiffnessAt) else 0)
    period = spec.period if spec.stiffness is None else float(building.periods[0])
    assert period is not None  # a building has one or the other
    whole, each = RANGES["period"], RANGES["period of a storey"]
    fits = replace(each, low=max(each.low, whole.low / storeys)) if storeys > 1 else whole
    what = f"a period of {_rounded(period)} s for {counted(storeys, 'storey')}"
    if not (whole.holds(period) and (storeys == 1 or each.holds(period / storeys))):
        meant = _meant(_text(root, at), period, fits, 1 / storeys) if at[-1] == "period" else ""
        notes.at(root, at, f"{what}: {fits.reason}", _hint(meant))
    if isinstance(spec.yield_shear, tuple):
        weight, shear, at = building.weight, float(building.yield_shear[0]), (*path, "yield_shear", 0)
        fits = RANGES["base yield shear over weight"]
        if not fits.holds(shear / weight):
            what = f"the lowest storey yields at {shown(shear, FORCES)}, {shear / weight:.2g} of the building's weight"
            notes.at(root, at, f"{what}: {fits.reason}", _hint(_meant(_text(root, at), shear, fits, 1 / weight)))


def doubt_stiffnesses(case: Case, impact: Any, group: Group, root: Any, path: Steps, notes: Problems) -> None:
    """Note stiffnesses of links that are unlikely beside those of the storeys."""
    stiffest = max(float(building.stiffness.max()) for building in group.buildings)
    for n, link in enumerate(case.links):
        law = link_laws().get(link.kind)
        if law is None or "stiffness" not in law.parameters():
            continue
        given = getattr(link, "stiffness", None)
        if given is None and law.stiffness_default:
            continue
        at = ("impact", "stiffness") if given is None else (*path, "links", n, "stiffness")
        stiffness, what = group.stiffness(given or impact.stiffness), "link" if law.stiffness_default else "impact"
        fits = RANGES[f"{what} stiffness over the stiffest storey's"]
        if not fits.holds(stiffness / stiffest):
            share = f"{stiffness / stiffest:.2g} times that of the stiffest storey"
            message = f"the {what} stiffness is {shown(stiffness, STIFFNESSES)}, {share}: {fits.reason}"
            notes.at(root, at, message, f"write e.g. `20 x stiffest storey`; otherwise leave it, {_AS_MEANT}")


# Motions


def doubt_accelerations(root: Map, notes: Problems) -> None:
    """Note numbers without a unit that stand for an acceleration and would be plausible in g: 0.4 is 0.4 m/s2."""
    at, swept = (
        ("records", "scale"),
        {key: (node[key], node.marks[key][1]) for node in sweep_maps(root) for key in node},
    )
    found = [
        each for key, (value, mark) in swept.items() for each in _accelerations(tuple(key.split(".")), value, mark)
    ]
    if get(root, *at) is not None and "records.scale" not in swept:
        own = _accelerations(at, get(root, *at), locate(root, at))
        found += [each for each in own if ".".join(map(str, each[0])) not in swept]
    first: dict[Steps, tuple[Any, Mark]] = {}
    for path, value, mark in found:
        first.setdefault(path[:3], (value, mark))
    for place, (value, mark) in first.items():
        si = ACCELERATION.read(value)
        message = f"{place[-1]}: {value} has no unit: it is {si:.4g} m/s2 = {si / GRAVITY:.3f} g"
        notes.add(mark, message, f"write `{value} g`, or `{value} m/s2` if that is meant")


def _accelerations(path: Steps, node: Any, mark: Mark) -> Iterator[tuple[Steps, Any, Mark]]:
    """The numbers without unit at or below a key that are accelerations and would be plausible in g, with their keys
    and places."""
    if isinstance(node, Items):
        for value, at in zip(node, node.marks, strict=True):
            yield from _accelerations(path, value, at)
    elif isinstance(node, Map):
        is_key = ("from" in node and "spectrum" not in node) or "values" in node  # a range, or an unknown value
        for name, value in node.items():
            yield from _accelerations(path if is_key else (*path, name), value, node.marks[name][1])
    else:
        quantity = quantity_at(schema.Study, tuple(map(str, path)))
        is_one = quantity is not None and quantity.si == "m/s2" and lacks_unit(node, quantity)
        if is_one and 0 < ACCELERATION.read(node) <= _MOST_IN_G:
            yield path, node, mark


def doubt_motions(used: Mapping[str, Used], root: Any, notes: Problems) -> None:
    """Note peaks of the ground that are unlikely, asked for or as they come out."""
    asked, at = get(root, "records", "scale", "pga"), ("records", "scale", "pga")
    if asked is not None:
        # An axis may begin low, as incremental dynamic analyses do.
        is_swept = any("records.scale.pga" in node for node in sweep_maps(root()))
        if not is_swept and not any(_accelerations(at, asked, (0, 0))):
            fits = RANGES["peak ground acceleration asked for"]
            doubt(fits.name, fits, next(iter(used.values())).use.pga, root, at, notes)
        return
    strong, fits = RANGES["peak of a motion as read and as used"], RANGES["peak of a motion as used"]
    unlikely = dict[str, list[str]]()
    for name, each in used.items():
        peak, read = each.use.pga, each.use.pga / each.use.scale
        if peak and (not strong.holds(min(peak, read)) or not fits.holds(peak)):
            reason = strong.reason if not strong.holds(min(peak, read)) else fits.reason
            unlikely.setdefault(reason, []).append(f"{name} ({peak / GRAVITY:.3g} g)")
    for reason, names in unlikely.items():
        assumed = any("assumed" in each.use.source for each in used.values())
        unit = "no unit is stated, so g is assumed: write e.g. `unit: m/s2` beside `file:`" if assumed else ""
        hint = f"{unit or 'check `unit:` of its file and `scale:`'}; otherwise leave it, {_AS_MEANT}"
        scaled = any(each.use.scale != 1 for each in used.values())
        message = f"unlikely peaks: {listed(names)}: {reason}"
        notes.at(root, ("records", "scale") if scaled else ("records", "use"), message, hint)


# Values and their ranges


def few(problems: Iterable[Problem]) -> list[Problem]:
    """Of warnings that differ in their numbers alone the first MOST_ALIKE; the last of those counts the others."""
    alike: dict[str, list[Problem]] = {}
    for problem in problems:
        alike.setdefault(re.sub(r"[\d.e+-]+", "#", problem.message), []).append(problem)
    kept: list[Problem] = []
    for several in alike.values():
        more, last = len(several) - MOST_ALIKE, several[:MOST_ALIKE][-1]
        kept += several[: MOST_ALIKE - 1] if more > 0 else several
        kept += [replace(last, message=f"{last.message}; and {more} more like it")] if more > 0 else []
    return sorted(kept, key=lambda note: (note.file, note.line, note.column))


def shown(value: float, units: Mapping[str, float]) -> str:
    """A value in the unit a person would use: the largest that it is at least one of, seconds from 0.01 s on."""
    sizes = sorted(units.items(), key=lambda unit: unit[1])
    fitting = [unit for unit in sizes if value >= unit[1] * (0.01 if unit[0] == "s" else 1 - 1e-12)]
    unit, factor = (fitting or sizes[:1])[-1]
    return f"{_rounded(value / factor)} {unit}"


def doubt_values(spec: BaseModel, root: Any, path: Steps, notes: Problems) -> None:
    """Note values that a validated mapping, or one below it, gives and that are not plausible."""
    for key, (name, fits) in _usuals(type(spec)).items():
        value, at = getattr(spec, name), (*path, key)
        if name not in spec.model_fields_set or get(root, *at) is None:
            continue
        several = enumerate(value) if isinstance(value, tuple) else [(None, value)]
        for n, each in several:
            here = at if n is None else (*at, n)
            if isinstance(each, BaseModel):
                doubt_values(each, root, here, notes)
            elif fits is not None and isinstance(each, float) and not fits.holds(each):
                doubt(fits.name, fits, each, root, here, notes)
                break


@functools.cache
def _usuals(model: type[BaseModel]) -> dict[str, tuple[str, Plausible | None]]:
    """Of every key of a mapping its attribute, and the plausible range of the quantities that it takes."""
    names = {info.alias or name: name for name, info in model.model_fields.items()}
    found = {}
    for key, (hint, _) in fields_of(model).items():
        kinds = list(leaves(hint))
        kinds += [one for kind in kinds if get_origin(kind) is tuple for one in leaves(get_args(kind)[0])]
        quantities = [kind.quantity if isinstance(kind, Text) else kind for kind in kinds]
        fits = (quantity.usual for quantity in quantities if isinstance(quantity, Quantity))
        found[key] = names[key], next(filter(None, fits), None)
    return found


def doubt(what: str, fits: Plausible, value: float, root: Any, path: Steps, notes: Problems) -> None:
    """Note a value that its range does not hold, with what may have been meant."""
    if not fits.holds(value):
        meant = _meant(_text(root, path), value, fits)
        notes.at(root, path, f"{what} is {shown(value, fits.units)}: {fits.reason}", _hint(meant))


def _hint(meant: str) -> str:
    return f"did you mean {meant}? otherwise leave it, {_AS_MEANT}" if meant else f"leave it if meant, {_AS_MEANT}"


def _meant(text: str, value: float, fits: Plausible, share: float = 1.0) -> str:
    """The same number in another unit, else with its decimal point elsewhere, `share` of which is plausible; or ""."""
    number = float(parted[1]) if (parted := _PARTED.match(text)) else 0.0
    for unit, factor in fits.units.items():
        if number > 0 and not np.isclose(number * factor, value, rtol=1e-9) and fits.holds(number * factor * share):
            return f"{number:.4g} {unit}"
    for factor in (0.1, 10.0, 0.01, 100.0):
        if fits.holds(value * factor * share):
            return shown(value * factor, fits.units)
    return ""


def _text(root: Any, path: Steps) -> str:
    value = get(root, *path)
    return "" if value is None else str(value)


def _rounded(value: float) -> str:
    return f"{value:.3g}" if value < 1000 else f"{value:.0f}"
