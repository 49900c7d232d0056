"""What a study may say but hardly means: warnings of values that are not plausible (`usual.py` has the ranges)."""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import product
from typing import TYPE_CHECKING, Any, get_args, get_origin

import numpy as np
from pydantic import BaseModel

from pounding_cli.errors import Problem
from pounding_cli.laws import link_laws
from pounding_cli.model.building import Building
from pounding_cli.model.links import Link
from pounding_cli.numbers import counted, listed
from pounding_cli.study import schema
from pounding_cli.study.axes import SweepAxis
from pounding_cli.study.build import tell_left_out
from pounding_cli.study.file import Items, Map, Mark, Problems, Steps, get, locate
from pounding_cli.study.laws import kind_of
from pounding_cli.study.models import Building as BuildingSpec
from pounding_cli.study.models import StiffnessAt
from pounding_cli.study.motions import Used
from pounding_cli.study.quantity import (
    ACCELERATION,
    ACCELERATIONS,
    FORCES,
    LENGTHS,
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

if TYPE_CHECKING:
    from pounding_cli.study.study import Study

MOST_CORNERS = 256
"""Combinations of swept values that are looked at for what is implausible together."""

MOST_ALIKE = 3
"""Warnings told one by one that differ in their numbers alone, as along a swept axis."""

_MOST_IN_G = 3.0
# Of a number without unit: recorded peaks reach 3 g.

_AS_MEANT = "the study runs as it is"
_PARTED = re.compile(rf"\s*({NUMBER})\s*(.*?)\s*\Z")


def warnings(study: Study) -> tuple[Problem, ...]:
    """What is allowed in a study but should be known, in the order of its lines."""
    notes, first = study.notes, (0,) * len(study.swept)
    for point in (first, *_along(study.swept, first), *_corners(study)):
        _doubt_point(study, point, notes)
    doubt_accelerations(study.root, notes)
    tell_held(study, notes)
    if study.model.impact.dashpot == "printed":
        message = "eq. (7) as printed has the unit 1/s, not kg/s: its dashpot depends on the unit of mass"
        hint = "leave it out for the dashpot that gives the coefficient of restitution"
        notes.at(study.root, ("impact", "dashpot"), message, hint)
    return tuple(few(sorted(notes.found, key=lambda note: (note.file, note.line, note.column))))


def _along(axes: Sequence[SweepAxis], first: Point) -> Iterator[Point]:
    """The points of the sweep that differ from the first in one value."""
    for place, axis in enumerate(axes):
        yield from ((*first[:place], index, *first[place + 1 :]) for index in range(1, len(axis)))


def _corners(study: Study) -> Iterator[Point]:
    """The points where every axis is at an end of its values, at most MOST_CORNERS.

    What is judged grows or falls with each value, so that the worst combinations stand there."""
    ends: list[tuple[int, ...]] = []
    for axis in study.axes:
        sizes = [next((value for value in values if not isinstance(value, str)), 0.0) for values in axis.values]
        order = sorted(range(len(sizes)), key=sizes.__getitem__)
        ends.append((order[0], order[-1]) if 2 ** len(ends) < MOST_CORNERS else (0,))
    yield from product(*ends)


def _doubt_point(study: Study, point: Point, notes: Problems) -> None:
    """Note what is sound at a point of the sweep, but unlikely or less than it seems; each answer is asked for once."""
    root = study.at(point)

    def noted(name: Any, subjects: tuple[Any, ...], work: Callable[[Problems], None]) -> None:
        """Take over what `work` notes; where several swept values make it together, they are named."""

        def take(at: Point, _: Problems) -> None:
            own = Problems(study.file)
            work(own)
            mine = [(axis, place) for axis, place in zip(study.swept, at, strict=True) if place >= 0]
            where = ", ".join(axis.told(place) for axis, place in mine)
            jointly = sum(place > 0 for _, place in mine) > 1
            for problem in own.found:
                if jointly and problem not in notes.found:
                    problem = replace(problem, message=f"{problem.message} (where {where})")
                notes.extend([problem])

        study.once(("doubt", name), point, subjects, take)

    for name in study.root["buildings"]:
        spec, building = study.building_spec(point, name), study.type(point, name)
        assert spec is not None
        assert building is not None  # the study was validated
        work = partial(doubt_building, spec, building, root, ("buildings", name))
        noted(("building", name), (("buildings", name),), work)
    group = study.group(point)
    if group is not None:
        noted("group", ("buildings", "group"), partial(tell_left_out, group.buildings, group.common, root, ("group",)))
        for case in study.root["cases"]:
            work = partial(doubt_links, study.links(point, case) or (), group.buildings, root, ("cases", case))
            noted(("case", case), ("buildings", "group", "impact", "laws", ("cases", case)), work)
    noted("motions", ("records",), partial(doubt_motions, study.motions(point), root))


def doubt_building(spec: BuildingSpec, building: Building, root: Any, path: Steps, notes: Problems) -> None:
    """Note what is unlikely about a building: masses, heights, period, damping, yield shears."""
    doubt_values(spec, root, path, notes)
    if spec.wall is not None:
        return
    _doubt_period(spec, building, root, path, notes)
    if isinstance(spec.yield_shear, tuple):
        weight = GRAVITY * float(np.sum(building.mass))
        share = float(building.yield_shear[0]) / weight
        if not (fits := RANGES["base yield shear over weight"]).holds(share):
            at = (*path, "yield_shear", 0)
            meant = _meant(_text(root, at), float(building.yield_shear[0]), fits, lambda value: value / weight)
            notes.at(
                root,
                at,
                f"the lowest storey yields at {shown(float(building.yield_shear[0]), FORCES)}, {share:.2g} of the "
                f"building's weight: {fits.reason}",
                _hint(meant),
            )


def slip_of_height(building: Building, root: Any, path: Steps) -> str:
    """The first storey height of a building that is unlikely, with what may have been meant; "" where there is none."""
    fits = RANGES["storey height"]
    height = next((value for value in building.height.tolist() if not fits.holds(value)), None)
    if height is None:
        return ""
    meant = _meant(_text(root, (*path, "height")), height, fits, lambda read: read)
    return f"a storey height of {building.name} is {shown(height, LENGTHS)}" + (
        f": did you mean {meant}?" if meant else ""
    )


def _doubt_period(spec: BuildingSpec, building: Building, root: Any, path: Steps, notes: Problems) -> None:
    period, storeys = spec.period if spec.stiffness is None else float(building.periods[0]), building.storeys
    assert period is not None  # a building has one or the other
    whole, each = RANGES["period"], RANGES["period of a storey"]
    if whole.holds(period) and (storeys == 1 or each.holds(period / storeys)):
        return
    a_storey = f", {_rounded(period / storeys)} s a storey" if storeys > 1 else ""
    reason = each.reason if storeys > 1 else whole.reason
    words = f"period of {_rounded(period)} s for {counted(storeys, 'storey')}{a_storey}: {reason}"
    fits = replace(each, low=max(each.low, whole.low / storeys)) if storeys > 1 else whole
    if spec.stiffness is None:
        at: Steps = (*path, "period")
        meant = _meant(_text(root, at), period, fits, lambda value: value / storeys)
        notes.at(root, at, f"a {words}", _hint(meant))
    else:
        if isinstance(spec.stiffness, StiffnessAt):
            at = (*path, "stiffness", "period")
            meant = _meant(_text(root, at), period, fits, lambda value: value / storeys)
            notes.at(root, at, f"this stiffness gives a {words}", _hint(meant))
            return
        at = (*path, "stiffness", 0)
        stiffness = replace(fits, units=STIFFNESSES)
        first = float(building.stiffness[0])
        meant = _meant(_text(root, at), first, stiffness, lambda value: period * (first / value) ** 0.5 / storeys)
        notes.at(root, at, f"these stiffnesses give a {words}", _hint(meant))


def doubt_links(links: Sequence[Link], group: Sequence[Building], root: Any, path: Steps, notes: Problems) -> None:
    """Note gaps and stiffnesses of a case's links that are unlikely, each once."""
    stiffest = max((float(building.stiffness.max()) for building in group), default=0.0)
    gaps = dict.fromkeys(link.gap for link in links if link.gap > 0)
    for gap in (gap for gap in gaps if not RANGES["gap"].holds(gap)):
        doubt("gap", RANGES["gap"], gap, root, _leaf(root, path, "gap"), notes)
    facing = (link.law for link in links if not link.columns)  # slabs strike columns in series with these
    springs = (law for law in facing if "stiffness" in law.parameters())  # others are not in N/m
    kinds = dict.fromkeys((not law.stiffness_default, law.initial_stiffness) for law in springs)
    for pounds, stiffness in kinds if stiffest else ():
        what = f"{'impact' if pounds else 'link'} stiffness over the stiffest storey's"
        if (fits := RANGES[what]).holds(stiffness / stiffest):
            continue
        at = _stiffness_of(root, path, pounds)
        text = _text(root, at)
        number = _PARTED.match(text)
        if number and not number[2] and fits.holds(float(number[1])):
            meant = f"{number[1]} x stiffest storey"
        else:
            meant = _meant(text, stiffness, fits, lambda value: value / stiffest)
        notes.at(
            root,
            at,
            f"the {what.split(' over')[0]} is {shown(stiffness, STIFFNESSES)}, {stiffness / stiffest:.2g} times that "
            f"of the stiffest storey: {fits.reason}",
            _hint(meant),
        )


def _stiffness_of(root: Any, path: Steps, pounds: bool) -> Steps:
    """The place of the stiffness of the first link of a case that gives one, of those that strike or of the others."""
    for place, link in enumerate(get(root, *path, "links") or ()):
        law = link_laws().get(kind_of(str(get(link, "link"))))
        if law is not None and (not law.stiffness_default) == pounds and "stiffness" in link:
            return (*path, "links", place, "stiffness")
    return ("impact", "stiffness") if pounds else path


def doubt_accelerations(root: Map, notes: Problems) -> None:
    """Note numbers without a unit that stand for an acceleration and would be plausible in g: 0.4 is 0.4 m/s2."""
    swept = swept_keys(root)
    found = [
        each for key, (value, mark) in swept.items() for each in _accelerations(tuple(key.split(".")), value, mark)
    ]
    at = ("records", "scale")
    if get(root, *at) is not None and "records.scale" not in swept:
        own = _accelerations(at, get(root, *at), locate(root, at))
        found += [each for each in own if ".".join(map(str, each[0])) not in swept]
    bare: dict[Steps, list[tuple[Any, Mark]]] = {}
    for path, value, mark in found:
        bare.setdefault(path[:3], []).append((value, mark))
    for place, values in bare.items():
        first, mark = values[0]
        value = ACCELERATION.read(first)
        all_of, what = listed((str(each) for each, _ in values), 60), "has no unit: it"
        if len(values) > 1:
            what = f"have no unit: {first}"
        message = f"{place[-1]}: {all_of} {what} is {value:.4g} m/s2 = {value / GRAVITY:.3f} g"
        notes.add(mark, message, f"write `{first} g`, or `{first} m/s2` if that is meant")


def swept_keys(root: Map) -> dict[str, tuple[Any, Mark]]:
    """The swept keys, dotted, with what stands there and where."""
    sweep = root.get("sweep")
    holders = sweep if isinstance(sweep, Items) else [sweep]
    return {key: (node[key], node.marks[key][1]) for node in holders if isinstance(node, Map) for key in node}


def _accelerations(path: Steps, node: Any, mark: Mark) -> Iterator[tuple[Steps, Any, Mark]]:
    """The numbers without unit at or below a key that are accelerations and would be plausible in g, with their keys
    and places."""
    if isinstance(node, Items):
        below = [(path, value, at) for value, at in zip(node, node.marks, strict=True)]
    elif isinstance(node, Map) and "from" in node and "spectrum" not in node:  # a range
        below = [(path, node[end], node.marks[end][1]) for end in ("from", "to") if end in node]
    elif isinstance(node, Map) and "values" in node:  # low, middle and high
        below = [(path, node["values"], node.marks["values"][1])]
    elif isinstance(node, Map):
        below = [((*path, name), value, node.marks[name][1]) for name, value in node.items()]
    else:
        quantity = quantity_at(schema.Study, tuple(map(str, path)))
        is_one = quantity is not None and quantity.si == "m/s2" and lacks_unit(node, quantity)
        if is_one and 0 < ACCELERATION.read(node) <= _MOST_IN_G:
            yield path, node, mark
        return
    for each in below:
        yield from _accelerations(*each)


def doubt_motions(used: Mapping[str, Used], root: Any, notes: Problems) -> None:
    """Note peaks of the ground that are unlikely, asked for or as they come out."""
    asked, at = get(root, "records", "scale", "pga"), ("records", "scale", "pga")
    if asked is not None:
        pga = next((each.use.pga for each in used.values()), None)
        swept, mark = swept_keys(root()).get("records.scale.pga", (None, (0, 0)))
        told = any(_accelerations(at, swept or asked, mark))  # without unit
        fits = RANGES["peak ground acceleration asked for"]
        if pga is not None and not told and not _in_plausible_range(swept):
            doubt(fits.name, fits, pga, root, at, notes)
        return
    read, fits = RANGES["peak of a motion as read and as used"], RANGES["peak of a motion as used"]
    peaks = {name: each.use.pga for name, each in used.items() if each.use.pga}
    as_read = {name: peak / used[name].use.scale for name, peak in peaks.items()}
    strong = {name: peak for name, peak in as_read.items() if min(peak, peaks[name]) > read.high}
    unlikely = {name: peak for name, peak in peaks.items() if not fits.holds(peak) and name not in strong}
    for how, reason, found in (("read", read.reason, strong), ("used", fits.reason, unlikely)):
        if not found:
            continue
        names = [f"{name} ({peak / GRAVITY:.3g} g)" for name, peak in found.items()]
        one, peak = next(iter(found.items()))
        message = f"'{one}' peaks at {peak / GRAVITY:.3g} g as it is {how}: {reason}"
        if len(found) > 1:
            message = f"{len(found)} motions have unlikely peaks as they are {how}: {reason}: {listed(names)}"
        hint = f"check `unit:` of its file and `scale:`; otherwise leave it, {_AS_MEANT}"
        if how == "read" and "assumed" in used[one].use.source:
            hint = (
                f"the file states no unit, so g is assumed; if {one} is in m/s2, its peak is "
                f"{peak / GRAVITY**2:.3g} g: write `unit: m/s2` beside `file:`. Otherwise leave it, {_AS_MEANT}"
            )
        scaled = used[one].use.scale != 1
        notes.at(root, ("records", "scale") if scaled else ("records", "use"), message, hint)


def _in_plausible_range(swept: Any) -> bool:
    """Whether an acceleration runs over a range one end of which is plausible: then its unit is right, and low
    intensities are meant, as those that an incremental dynamic analysis begins with."""
    fits = RANGES["peak ground acceleration asked for"]
    ends = [str(swept[key]) for key in ("from", "to") if isinstance(swept, Map) and key in swept]
    read = [_PARTED.match(text) for text in ends]
    return any(one and fits.holds(float(one[1]) * ACCELERATIONS.get(one[2], np.nan)) for one in read)


def few(problems: Iterable[Problem]) -> list[Problem]:
    """Of warnings that differ in their numbers alone the first MOST_ALIKE; the last of those counts the others."""
    kept: list[Problem] = []
    alike: dict[str, list[int]] = {}
    for problem in problems:
        kind = re.sub(r"[\d.e+-]+", "#", problem.message)
        places = alike.setdefault(kind, [])
        if len(places) < MOST_ALIKE:
            kept.append(problem)
        places.append(len(kept) - 1)
    for places in alike.values():
        more = len(places) - MOST_ALIKE
        if more > 0:
            last = kept[places[MOST_ALIKE - 1]]
            kept[places[MOST_ALIKE - 1]] = replace(last, message=f"{last.message}; and {more} more like it")
    return kept


def shown(value: float, units: Mapping[str, float]) -> str:
    """A value in the unit a person would use: the largest that it is at least one of, seconds from 0.01 s on."""
    sizes = sorted(units.items(), key=lambda unit: unit[1])
    fitting = [unit for unit in sizes if value >= unit[1] * (0.01 if unit[0] == "s" else 1 - 1e-12)]
    unit, factor = (fitting or sizes[:1])[-1]
    return f"{_rounded(value / factor)} {unit}"


def doubt_values(spec: BaseModel, root: Any, path: Steps, notes: Problems) -> None:
    """Note values that a validated mapping, or one below it, gives and that are not plausible."""
    for key, (name, fits) in _usuals(type(spec)).items():
        value = getattr(spec, name)
        if name not in spec.model_fields_set or get(root, *path, key) is None:
            continue
        if isinstance(value, BaseModel):
            doubt_values(value, root, (*path, key), notes)
        elif fits is not None:
            several = isinstance(value, tuple)
            numbers = [each for each in (value if several else [value]) if isinstance(each, float)]
            wrong = next((n for n, each in enumerate(numbers) if not fits.holds(each)), None)
            if wrong is not None:
                doubt(fits.name, fits, numbers[wrong], root, (*path, key, wrong) if several else (*path, key), notes)


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
    if fits.holds(value):
        return
    meant = _meant(_text(root, path), value, fits, lambda read: read)
    notes.at(root, path, f"{what} is {shown(value, fits.units)}: {fits.reason}", _hint(meant))


def _hint(meant: str) -> str:
    return (
        f"did you mean {meant}? otherwise leave it, {_AS_MEANT}" if meant else f"leave it if it is meant, {_AS_MEANT}"
    )


def _meant(text: str, value: float, fits: Plausible, measured: Callable[[float], float]) -> str:
    """The same number in another unit, else with its decimal point elsewhere, that makes `measured` plausible."""
    parted = _PARTED.match(text)
    if parted:
        number = float(parted[1])
        for unit, factor in fits.units.items():
            if number > 0 and abs(number * factor - value) > 1e-9 * value and fits.holds(measured(number * factor)):
                return f"{number:.4g} {unit}"
    for factor in (0.1, 10.0, 0.01, 100.0):
        if fits.holds(measured(value * factor)):
            return shown(value * factor, fits.units)
    return ""


def _text(root: Any, path: Steps) -> str:
    value = get(root, *path)
    return "" if value is None else str(value)


def _leaf(root: Any, path: Steps, key: str) -> Steps:
    """The place of the first `key` at or below `path`."""
    stack: list[Steps] = [path]
    while stack:
        here = stack.pop(0)
        node = get(root, *here)
        if isinstance(node, dict):
            if key in node:
                return (*here, key)
            stack += [(*here, name) for name in node]
        elif isinstance(node, list):
            stack += [(*here, place) for place in range(len(node))]
    return path


def _rounded(value: float) -> str:
    return f"{value:.3g}" if value < 1000 else f"{value:.0f}"


_VARIED = (("sweep",), ("uncertain",), ("optimise", "over"))


def tell_held(study: Study, notes: Problems) -> None:
    """Note every mass that varies in a building with a `period`: its stiffness follows the mass, and its yield shears
    follow the weight, which an uncertain mass is hardly meant to do."""
    from pounding_cli.study.study import touched_by

    model, specs = study.model, dict[str, Any]()
    specs |= {name: study.building_spec(study.base, name) for name in dict.fromkeys(model.group)}
    for key, mark, beside in _masses(study.root):
        touched = touched_by([key], study.root)
        names = [
            name
            for name, spec in specs.items()
            if ("buildings", name) in touched and spec.stiffness is None and f"buildings.{name}.period" not in beside
        ]
        if names:
            is_weight = "inelastic" in model.analyses and specs[names[0]].yield_shear is None
            _tell(names, is_weight, mark, study, notes)


def _masses(root: Map) -> Iterator[tuple[str, Mark, frozenset[str]]]:
    """The keys of masses that vary, where each stands, and the keys that move with it."""
    for section in _VARIED:
        node = get(root, *section)
        for holder in node if isinstance(node, list) else [node]:
            for key in holder if isinstance(holder, Map) else ():
                path = key.split(".")
                if path[0] == "buildings" and path[2:3] == ["mass"]:
                    yield key, holder.marks[key][0], frozenset(holder) if isinstance(node, list) else frozenset()


def _tell(names: list[str], is_weight: bool, mark: Mark, study: Study, notes: Problems) -> None:
    first = names[0]
    buildings, building = study.tree(study.base)["buildings"], study.type(study.base, first)
    assert building is not None  # the study was validated
    period = _as_file_says(get(buildings, first, "period"), "")
    mass = _as_file_says(get(buildings, first, "mass"), str(BuildingSpec.model_fields["mass"].default))
    one = len(names) == 1
    what = f"the period of {first} is held at {period}" if one else f"the periods of {listed(names)} are held"
    strength = ", and so do the yield shears, which are a part of the weight" if is_weight else ""
    hint = f"to hold the stiffness instead, write `stiffness: {{period: {period}, mass: {mass}}}` in place of `period`"
    if is_weight:
        shears = ", ".join(f"{shear / 1e3:.5g} kN" for shear in building.yield_shear.tolist())
        hint += f"; to hold the yield shears too, `yield_shear: [{shears}]` in place of `yield`"
    hint += "" if one else f" (of {first}; likewise in the others)"
    notes.add(mark, f"where the mass varies, {what}: the stiffness changes in proportion to the mass{strength}", hint)


def _as_file_says(value: Any, default: str) -> str:
    """A value as the file says it."""
    if value is None:
        return default
    return f"[{', '.join(map(str, value))}]" if isinstance(value, list) else str(value)
