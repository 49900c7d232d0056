"""What a study may say but hardly means: warnings of values that are not plausible (`quantity.py` has the ranges)."""

from __future__ import annotations

import functools
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, get_args, get_origin

import numpy as np
from pydantic import BaseModel

from pounding_cli.errors import Problem
from pounding_cli.laws import link_laws
from pounding_cli.numbers import counted, listed
from pounding_cli.study.build import Group, tell_left_out
from pounding_cli.study.file import Problems, Steps, get
from pounding_cli.study.models import Case, StiffnessAt
from pounding_cli.study.motions import Used
from pounding_cli.study.quantity import FORCES, NUMBER, RANGES, STIFFNESSES, Plausible, Quantity, Text, lacks_unit
from pounding_cli.study.words import fields_of, leaves
from pounding_cli.units import GRAVITY

if TYPE_CHECKING:
    from pounding_cli.study.study import Point, Study

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

    for point in _points(study):
        root, group = study.at(point), study.group(point)
        assert group is not None  # the study was validated
        for name in study.model.buildings:
            if is_new(name, point, ("buildings", name)):
                doubt_building(study.building_spec(point, name), study.type(point, name), root, name, notes)
        if is_new("group", point, "buildings", "group"):
            tell_left_out(group.buildings, root, ("group",), notes)
        for name in study.model.cases:
            if is_new(name, point, "buildings", "group", "impact", ("cases", name)):
                doubt_case(study.case(point, name), study.section(point, "impact"), group, root, name, notes)
        if is_new("motions", point, "records"):
            doubt_values(study.section(point, "records"), root, ("records",), notes)
            doubt_motions(study.motions(point), root, notes)
    if study.model.impact.dashpot == "printed":
        message = "eq. (7) as printed has the unit 1/s, not kg/s: its dashpot depends on the unit of mass"
        hint = "leave it out for the dashpot that gives the coefficient of restitution"
        notes.at(study.root, ("impact", "dashpot"), message, hint)
    return few(notes.found)


def _points(study: Study) -> Iterator[Point]:
    """The first point of a sweep, and those that differ from it in one value."""
    first = (0,) * len(study.axes)
    yield first
    for place, axis in enumerate(study.axes):
        yield from ((*first[:place], index, *first[place + 1 :]) for index in range(1, len(axis)))


def few(problems: Iterable[Problem]) -> tuple[Problem, ...]:
    """Warnings in the order of their lines; of those in one line that differ in their numbers alone, as along a swept
    axis, the first, which counts the others."""
    alike: dict[Any, list[Problem]] = {}
    for each in problems:
        alike.setdefault((each.file, each.line, re.sub(r"[\d.e+-]+", "#", each.message)), []).append(each)
    kept = [
        replace(first, message=f"{first.message}; and {len(more)} more like it") if more else first
        for first, *more in alike.values()
    ]
    return tuple(sorted(kept, key=lambda note: (note.file, note.line, note.column)))


def doubt_building(spec: Any, building: Any, root: Any, name: str, notes: Problems) -> None:
    """Note what is unlikely about a building type: masses, heights, period, damping, yield shears."""
    path: Steps = ("buildings", name)
    doubt_values(spec, root, path, notes)
    if spec.wall is not None:
        return
    storeys, at = building.storeys, (*path, "period")
    if spec.stiffness is not None:
        at = (*path, "stiffness", "period" if isinstance(spec.stiffness, StiffnessAt) else 0)
    period = spec.period if spec.stiffness is None else float(building.periods[0])
    checked = [(RANGES["period of a storey"], 1 / storeys)] * (storeys > 1) + [(RANGES["period"], 1.0)]
    for fits, share in [each for each in checked if not each[0].holds(period * each[1])][:1]:
        what = f"a period of {_rounded(period)} s for {counted(storeys, 'storey')}: {fits.reason}"
        is_given = at[-1] == "period"
        notes.at(root, at, what, _hint(_text(root, at), period, fits, share) if is_given else "check its unit")
    if isinstance(spec.yield_shear, tuple):
        shear, share, fits = spec.yield_shear[0], 1 / building.weight, RANGES["base yield shear over weight"]
        if not fits.holds(shear * share):
            at = (*path, "yield_shear", 0)
            what = f"the lowest storey yields at {shown(shear, FORCES)}, {shear * share:.2g} of the building's weight"
            notes.at(root, at, f"{what}: {fits.reason}", _hint(_text(root, at), shear, fits, share))


def doubt_case(case: Case | None, impact: Any, group: Group, root: Any, name: str, notes: Problems) -> None:
    """Note what is unlikely about the links of a case: gaps, and stiffnesses beside those of the storeys."""
    assert case is not None  # the study was validated
    doubt_values(case, root, ("cases", name), notes)
    stiffest, fits = max(float(each.stiffness.max()) for each in group.buildings), RANGES["link stiffness"]
    for n, link in enumerate(case.links):
        law, given = link_laws().get(link.kind), getattr(link, "stiffness", None)
        if law is None or "stiffness" not in law.parameters() or (given is None and law.stiffness_default):
            continue
        at: Steps = ("impact", "stiffness") if given is None else ("cases", name, "links", n, "stiffness")
        stiffness = group.stiffness(given or impact.stiffness)
        if not fits.holds(stiffness / stiffest):
            share = f"{stiffness / stiffest:.2g} times that of the stiffest storey"
            message = f"the stiffness of the link is {shown(stiffness, STIFFNESSES)}, {share}: {fits.reason}"
            notes.at(root, at, message, f"write e.g. `20 x stiffest storey`; otherwise leave it, {_AS_MEANT}")


def doubt_motions(used: Mapping[str, Used], root: Any, notes: Problems) -> None:
    """Note peaks of the ground that are unlikely: as used, or more than 2 g both in the file and as used."""
    fits, uses = RANGES["peak of a motion"], [each.use for each in used.values()]
    unlikely = [use for use in uses if not fits.holds(use.pga) or use.pga / max(use.scale, 1.0) > 2 * GRAVITY]
    if unlikely:
        hint = f"check `unit:` of its file and `scale:`; otherwise leave it, {_AS_MEANT}"
        told = listed(f"{use.name} ({use.pga / GRAVITY:.3g} g)" for use in unlikely)
        place = "scale" if any(use.scale != 1 for use in unlikely) else "use"
        notes.at(root, ("records", place), f"unlikely peaks: {told}: {fits.reason}", hint)


# Values and their ranges


def doubt_values(spec: BaseModel, root: Any, path: Steps, notes: Problems) -> None:
    """Note values that a validated mapping, or one below it, gives and that are not plausible; of a list the first."""
    for key, (name, quantity) in _quantities(type(spec)).items():
        value, at = getattr(spec, name), (*path, key)
        if name not in spec.model_fields_set or (written := get(root, *at)) is None:
            continue
        several: Any = [((), value)]
        if isinstance(value, tuple):
            several = [((n,) if isinstance(written, list) else (), each) for n, each in enumerate(value)]
        elif isinstance(value, dict) and isinstance(written, dict):
            several = [((word,), each) for word, each in zip(written, value.values(), strict=False)]
        for below, each in several:
            here = (*at, *below)
            if isinstance(each, BaseModel):
                doubt_values(each, root, here, notes)
            elif quantity is not None and isinstance(each, float) and doubt(key, quantity, each, root, here, notes):
                break


@functools.cache
def _quantities(model: type[BaseModel]) -> dict[str, tuple[str, Quantity | None]]:
    """Of every key of a mapping its attribute, and the quantity that it takes."""
    names = {info.alias or name: name for name, info in model.model_fields.items()}
    found = {}
    for key, (hint, _) in fields_of(model).items():
        kinds = list(leaves(hint))
        kinds += [one for kind in kinds if get_origin(kind) in (tuple, dict) for one in leaves(get_args(kind)[-1])]
        kinds += [one for kind in kinds if get_origin(kind) is tuple for one in leaves(get_args(kind)[0])]
        quantities = (kind.quantity if isinstance(kind, Text) else kind for kind in kinds)
        found[key] = names[key], next((each for each in quantities if isinstance(each, Quantity)), None)
    return found


def doubt(key: str, quantity: Quantity, value: float, root: Any, path: Steps, notes: Problems) -> bool:
    """Note a value that is not plausible, with what may have been meant; whether it is one."""
    text, fits = _text(root, path), quantity.usual
    if quantity.si == "m/s2" and 0 < value <= _MOST_IN_G and lacks_unit(text, quantity):
        message = f"{key}: {text} has no unit: it is {value:.4g} m/s2 = {value / GRAVITY:.3f} g"
        notes.at(root, path, message, f"write `{text} g`, or `{text} m/s2` if that is meant")
        return True
    if fits is None or fits.holds(value):
        return False
    notes.at(root, path, f"{fits.name} is {shown(value, fits.units)}: {fits.reason}", _hint(text, value, fits))
    return True


def shown(value: float, units: Mapping[str, float]) -> str:
    """A value in the unit a person would use: the largest that it is at least one of, seconds from 0.01 s on."""
    sizes = sorted(units.items(), key=lambda unit: unit[1])
    fitting = [unit for unit in sizes if value >= unit[1] * (0.01 if unit[0] == "s" else 1 - 1e-12)]
    unit, factor = (fitting or sizes[:1])[-1]
    return f"{_rounded(value / factor)} {unit}"


def _hint(text: str, value: float, fits: Plausible, share: float = 1.0) -> str:
    """The same number in another unit, else with its decimal point elsewhere, `share` of which is plausible."""
    number = float(parted[1]) if (parted := _PARTED.match(text)) else 0.0
    meant = [
        f"{number:.4g} {unit}"
        for unit, factor in fits.units.items()
        if number > 0 and not np.isclose(number * factor, value) and fits.holds(number * factor * share)
    ]
    meant += [shown(value * f, fits.units) for f in (0.1, 10.0, 0.01, 100.0) if fits.holds(value * f * share)]
    return f"did you mean {meant[0]}? otherwise leave it, {_AS_MEANT}" if meant else f"leave it if meant, {_AS_MEANT}"


def _text(root: Any, path: Steps) -> str:
    value = get(root, *path)
    return "" if value is None else str(value)


def _rounded(value: float) -> str:
    return f"{value:.3g}" if value < 1000 else f"{value:.0f}"
