"""A study for people: the units it writes quantities in, and the study as plain data with every default."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

from pydantic import BaseModel

from pounding_cli.errors import InputError
from pounding_cli.numbers import Unit
from pounding_cli.study.construct.buildings import build_building, find_code_displacements, find_separation
from pounding_cli.study.construct.complete_links import complete_links, find_losses
from pounding_cli.study.construct.group import unique_names
from pounding_cli.study.schema.links import LOSSES, key_parameters, link_keys, needs_key
from pounding_cli.study.schema.quantity import MeasuredValue, Quantity, StoreyMultiple, written_unit
from pounding_cli.study.schema.study import StudySpec
from pounding_cli.study.text.file import get
from pounding_cli.study.vary.axes import Axis
from pounding_cli.study.vary.ranges import unit_of
from pounding_cli.units import GRAVITY

DISPLAY_UNITS: dict[str, tuple[tuple[tuple[str, ...], ...], tuple[str, ...], Unit]] = {
    "gap": ((("cases",),), ("gap",), Unit("cm", 0.01, "m")),
    "link stiffness": ((("cases",), ("impact",)), ("stiffness",), Unit("MN/m", 1e6, "N/m")),
    "acceleration": ((("records", "scale"),), ("pga", "sa", "target", "ag", "sds", "sd1"), Unit("g", GRAVITY, "m/s2")),
    "time step": ((("time_step",),), (), Unit("s", 1.0, "s")),
}
"""The quantities that screens and tables show in the unit of the study: the sections at or below which it writes them,
the keys there (none: any), and the unit where it does not write them."""


def find_unit(tree: Any, quantity: str) -> Unit:
    """Return the unit a study writes a quantity of DISPLAY_UNITS in: the first one, SI where all numbers are bare."""
    sections, keys, usual = DISPLAY_UNITS[quantity]
    values = [value for section in sections for value in _iter_scalars(get(tree, *section), keys, not keys)]
    unit = unit_of(values, Quantity(quantity, usual.si, ""))
    is_written = any(written_unit(value) == unit.name or isinstance(value, int | float) for value in values)
    return unit if is_written else usual


def _iter_scalars(node: Any, keys: Sequence[str], inside: bool) -> Iterator[Any]:
    """Yield the scalars at or below `node` that stand under one of `keys`; all of them where `inside`.

    The spectrum of a code, a mapping with `code`, has quantities of several kinds: those under one of `keys` count.
    """
    if isinstance(node, dict):
        are_alike = inside and "code" not in node
        for key, below in node.items():
            yield from _iter_scalars(below, keys, are_alike or key in keys)
    elif isinstance(node, list):
        for below in node:
            yield from _iter_scalars(below, keys, inside)
    elif inside and node is not None:
        yield node


def to_plain_data(value: Any) -> Any:
    """Return a value of a validated model as plain data: SI numbers, multiples of stiffnesses as text."""
    if isinstance(value, StoreyMultiple):
        return str(value)
    if isinstance(value, MeasuredValue):
        return value.text
    if isinstance(value, BaseModel):
        fields = type(value).model_fields.items()
        return {info.alias or name: to_plain_data(getattr(value, name)) for name, info in fields}
    if isinstance(value, dict):
        return {str(key): to_plain_data(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [to_plain_data(item) for item in value]
    return value


def describe_study(spec: StudySpec, title: str, axes: Sequence[Axis]) -> dict[str, Any]:
    """Return a study as plain data: every default filled in, SI numbers, the sweep set aside.

    spec : the study as written, validated
    title : its title or its name
    axes : of its sweep

    Buildings also carry what was derived (`derived`: mass, height, stiffness, yield_shear, alpha, beta, period);
    the places of the group are under `places`, and `separation` holds the code separation [m] of each pair of
    neighbours, None where no code set the yield shears. Links stand with everything that case and `impact` give them.
    """
    plain: dict[str, Any] = {name: to_plain_data(getattr(spec, name)) for name in type(spec).model_fields}
    plain["title"] = title
    plain["sweep"] = [{"names": list(axis.names), "values": [list(v) for v in axis.values]} for axis in axes]
    plain["cases"] = {name: {"links": _describe_links(case, name, spec.impact)} for name, case in spec.cases.items()}
    displacements = {}
    for name, building_spec in spec.buildings.items():
        try:
            building = build_building(name, building_spec)
        except InputError:  # as written it cannot stand; the sweep gives it other values
            continue
        plain["buildings"][name]["derived"] = _describe_building(building)
        displacements[name] = find_code_displacements(building_spec, building)
    plain["places"] = list(unique_names(spec.group))
    pairs = zip(spec.group, spec.group[1:], strict=False)
    gaps = [find_separation(*(displacements.get(name, {}) for name in pair)) for pair in pairs]
    plain["separation"] = [None if math.isnan(gap) else gap for gap in gaps]
    return plain


def _describe_links(case: Any, name: str, impact: Any) -> list[dict[str, Any]]:
    """Return the links of a case as plain data."""
    links = []
    for link in complete_links(name, case, impact):
        spec = link.spec
        place = {"link": link.title, "floors": spec.floors, "pair": spec.pair, "at": spec.at, "distance": spec.distance}
        law = link.law_class
        values = dict(link.values)
        if law is not None:
            losses = find_losses(values, law)
            keys = link_keys(law)
            values = {
                **_list_defaults(law),
                **values,
                **{key: losses[key] for key in LOSSES if key in keys and key in losses},
            }
        links.append(to_plain_data(place | values))
    return links


def _list_defaults(law: Any) -> dict[str, Any]:
    """Return the keys of a law with their defaults; None for those without one."""
    defaults: dict[str, Any] = dict.fromkeys(sorted(link_keys(law)))
    for key in key_parameters(law):
        if not needs_key(law, key):
            default = law.parameters()[key].default
            defaults[key] = str(default) if isinstance(default, str) else default
    return defaults


def _describe_building(building: Any) -> dict[str, Any]:
    """Return what was derived of a building as plain data."""
    derived: dict[str, Any] = {key: getattr(building, key).tolist() for key in ("mass", "height", "stiffness")}
    derived["yield_shear"] = [None if math.isinf(shear) else shear for shear in building.yield_shear.tolist()]
    derived["alpha"] = building.alpha
    derived["beta"] = building.beta
    derived["period"] = float(building.periods[0])
    if building.gravity_load is not None:
        derived["theta"] = building.stability_coefficient.tolist()
    return derived


LIST_ENTRIES = {"lines": "line", "across": "line across", "links": "link", "places": "place", "shares": "share"}
"""Key of a list -> one of its entries in words; the entries of other lists are of storeys."""

KEY_WORDS = {"y": "place", "x": "place", "places": "place", "accidental": "accidental eccentricity"}
"""Keys that words name otherwise."""


def key_words(key: str) -> str:
    """A dotted key in words: "stiffness of connected" for `cases.connected.stiffness`, "place of line 1 of corner" for
    `buildings.corner.plan.lines.0.y`; one of one part as it is."""
    section, *rest = key.split(".")
    if not rest:
        return key
    words: list[str] = []
    for step, below in zip(rest[1:] or rest, [*rest[2:], ""], strict=False):
        if step.isdigit():
            continue
        if not below.isdigit():
            words.append(KEY_WORDS.get(step, step).replace("_", " "))
        elif step in LIST_ENTRIES:
            words.append(f"{LIST_ENTRIES[step]} {int(below) + 1}")
        else:
            words.append(f"{step.replace('_', ' ')} of storey {int(below) + 1}")
    *above, last = words
    is_place = last.startswith(("place", "share"))  # of which every link may have some
    numbered = [each for each in above if each[-1].isdigit() and (is_place or not each.startswith("link "))]
    words_of_key = " of ".join([last, *reversed(numbered)])
    is_named = section in ("buildings", "cases") and words_of_key != rest[0]
    return f"{words_of_key} of {rest[0]}" if is_named else words_of_key
