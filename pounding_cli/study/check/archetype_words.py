"""Sentences of `pound check` on buildings that are only seen: every number, its source and how uncertain it is; and
the doubts about them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from pounding_cli.errors import Issue
from pounding_cli.model.archetypes import (
    DAMAGE_STATES,
    MANUAL,
    SOURCES,
    SPREAD_SOURCES,
    find_archetype,
    list_designs,
    list_types,
)
from pounding_cli.numbers import format_number, pluralize
from pounding_cli.study.schema.archetypes import Seen, list_seen
from pounding_cli.study.study import Study
from pounding_cli.study.text.file import Map

_TITLES = {"strength": "base shear V/W", "height": "storey height"}
"""Quantity -> its name in a line where it has another."""


def describe_seen_buildings(study: Study) -> list[str]:
    """Return in lines where the numbers of buildings that are only seen come from; none without such buildings.

    Numbers are those of the first point of the sweep.
    """
    lines = []
    for seen in list_seen(study.units_from):
        swept = [key for axis in study.axes for key in axis.names if key.startswith(f"buildings.{seen.name}.")]
        where = f"; at the first value of {' and '.join(swept)}" if swept else ""
        lines.append(f"seen       {seen.name}: {describe_archetype(seen)}{where}")
        rows = [
            _Row("quantity", "median" if seen.spec.sample == 0 else "value", "β", "source"),
            *_iter_rows(study, seen),
        ]
        widths = [max(len(row[column]) for row in rows) for column in range(3)]
        for *cells, source in rows:
            padded = "  ".join(f"{cell:<{width}}" for cell, width in zip(cells, widths, strict=True))
            lines.append(f"  {padded}  {source}".rstrip())
        lines.append(f"  {_describe_use(seen)}")
    return lines


def describe_archetype(seen: Seen) -> str:
    """Return a building that is only seen in words: "C1M, concrete moment frame, mid-rise; pre-code, 5 storeys"."""
    storeys = pluralize(seen.spec.storeys, "storey")
    return f"{seen.spec.type}, {seen.archetype.description}; {seen.spec.design}, {storeys} ({MANUAL})"


class _Row(NamedTuple):
    """A line about one number: what it is, its value, the dispersion of its logarithm, and its source."""

    quantity: str
    value: str
    spread: str
    source: str


def _iter_rows(study: Study, seen: Seen) -> Iterator[_Row]:
    """Yield the lines about a building that is only seen."""
    archetype = seen.archetype
    building = study.parts.types[seen.name].value_at(study.first_point)
    spec = study.parts.building_specs[seen.name].value_at(study.first_point)
    damping = f"{format_number(100 * spec.damping, 3)} %" if spec.rayleigh is None else "by `rayleigh`"
    yield _build_row(
        seen,
        "period",
        f"{format_number(building.periods[0], 4)} s",
        f"{format_number(seen.median('period'), 4)} s",
        f"{format_number(archetype.period_per_storey, 4)} s a storey; {SOURCES['period']}",
    )
    yield _build_row(
        seen,
        "strength",
        format_number(building.base_shear_ratio, 3),
        format_number(seen.median("strength"), 3),
        f"Cs {archetype.design_strength:g}, overstrength {archetype.gamma:g} and {archetype.lambda_:g}, Ay "
        f"{archetype.yield_acceleration:g} g times the share of the first mode; {SOURCES['strength']}",
    )
    yield _build_row(seen, "damping", damping, f"{100 * archetype.damping:g} %", SOURCES["damping"])
    height = f"{archetype.storey_height:g} m"
    yield _build_row(seen, "height", str(seen.building.get("height", height)), height, SOURCES["height"])
    hardening = format_number(archetype.hardening, 3)
    ductility = format_number(archetype.ultimate_ductility, 3)
    source = f"{SOURCES['hardening']}; ultimate point at a ductility of {ductility}"
    yield _build_row(seen, "hardening", str(seen.building.get("hardening", hardening)), hardening, source)
    mass = "given in the study" if "mass" in seen.building else "default of studies; HAZUS has none: write `mass`"
    yield _Row("floor mass", f"{format_number(building.mass.mean() / 1e3, 4)} t", "", mass)
    for state in DAMAGE_STATES:
        drift = f"{100 * archetype.drift_limits[state]:.4g} %"
        yield _build_row(seen, "drift", drift, drift, SOURCES["drift"])._replace(quantity=f"drift, {state}")


def _build_row(seen: Seen, quantity: str, value: str, of_type: str, source: str) -> _Row:
    """Return the line about a number that the type gives, or the study beside it.

    value : of the building
    of_type : of its type
    source : where that stands
    """
    title = _TITLES.get(quantity, quantity)
    if seen.is_known(quantity):
        return _Row(title, value, "", f"given in the study; of the type: {of_type}")
    is_drawn = quantity in SPREAD_SOURCES and seen.uncertain_quantities() and seen.spec.sample == 0
    if not is_drawn:
        return _Row(title, value, "", source)
    return _Row(title, value, f"{seen.archetype.spreads[quantity]:.2f}", f"{source}; β: {SPREAD_SOURCES[quantity]}")


def _describe_use(seen: Seen) -> str:
    """Return which of the buildings that it may be the commands take."""
    if seen.spec.sample:
        return f"taken: number {seen.spec.sample} of the {seen.spec.neighbours} buildings that it may be"
    if not seen.spec.uncertain:
        return "taken as certain: the median building"
    if not seen.uncertain_quantities():
        return "period, strength and damping are given: nothing is drawn"
    return (
        f"`pound run` takes the median building; `pound gap` and `pound fragility` draw {seen.spec.neighbours}, "
        "`pound sensitivity` varies them"
    )


def check_storeys(tree: Map) -> Iterator[Issue]:
    """Yield buildings that are only seen whose type does not have as many storeys.

    tree : the study at a point of its sweep
    """
    for seen in list_seen(tree):
        if not seen.archetype.has_storeys(seen.spec.storeys):
            message = (
                f"{seen.name} has {pluralize(seen.spec.storeys, 'storey')}, but {seen.spec.type} of HAZUS is of "
                f"{seen.archetype.describe_range()}: its numbers are taken beyond their range"
            )
            yield Issue(("buildings", seen.name, "archetype", "storeys"), message, _hint_type(seen), code="archetype")


def _hint_type(seen: Seen) -> str:
    """Return the type of the same system that has as many storeys, or what to do without one."""
    system = seen.spec.type.rstrip("LMH")
    for name in list_types():
        is_alike = name.rstrip("LMH") == system and seen.spec.design in list_designs(name)
        if is_alike and find_archetype(name, seen.spec.design).has_storeys(seen.spec.storeys):
            return f"write `type: {name}`, or leave it if the range is meant to be passed"
    return "choose another type, or leave it if the range is meant to be passed"
