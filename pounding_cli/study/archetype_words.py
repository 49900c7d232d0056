"""What `pound check` says of buildings that are only seen: every number, its source and how uncertain it is; and what
is doubtful about them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

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
from pounding_cli.study.archetypes import UNCERTAIN_KEYS, Seen, list_seen

if TYPE_CHECKING:
    from pounding_cli.study.file import Problems
    from pounding_cli.study.study import Study

_TITLES = {"period": "period", "strength": "base shear V/W", "damping": "damping"}
"""Quantity -> its name in a line."""


def describe_seen_buildings(study: Study) -> list[str]:
    """Return in lines where the numbers of buildings that are only seen come from; none without such buildings."""
    lines = []
    for seen in list_seen(study.tree):
        lines.append(f"seen       {seen.name}: {describe_archetype(seen)}")
        rows = [("quantity", "median", "β", "source"), *_iter_rows(study, seen)]
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


def _iter_rows(study: Study, seen: Seen) -> Iterator[tuple[str, str, str, str]]:
    """Yield a row for every number: what it is, its median, its dispersion and its source."""
    archetype = seen.archetype
    spec = study.resolved.building_specs[seen.name].at(study.first_point)
    building = study.resolved.types[seen.name].at(study.first_point)
    period = f"{format_number(building.periods[0], 4)} s"
    shear = f"{format_number(building.base_shear_ratio, 3)}"
    hazus = {
        "period": f"{format_number(seen.median('period'), 4)} s",
        "strength": format_number(seen.median("strength"), 3),
        "damping": f"{100 * archetype.damping:g} %",
    }
    is_rayleigh = spec.rayleigh is not None
    values = {
        "period": period,
        "strength": shear,
        "damping": "by rayleigh" if is_rayleigh else f"{format_number(100 * spec.damping, 3)} %",
    }
    details = {
        "period": f"{format_number(archetype.period_per_storey, 4)} s a storey; {SOURCES['period']}",
        "strength": (
            f"Cs {archetype.design_strength:g}, overstrength {archetype.gamma:g} and {archetype.lambda_:g}, "
            f"Ay {archetype.yield_acceleration:g} g times the share of the first mode; {SOURCES['strength']}"
        ),
        "damping": SOURCES["damping"],
    }
    for quantity in UNCERTAIN_KEYS:
        if seen.is_known(quantity):
            yield _TITLES[quantity], values[quantity], "", f"given in the study; of the type: {hazus[quantity]}"
            continue
        spread = f"{archetype.spreads[quantity]:.2f}" if seen.spec.uncertain else ""
        source = details[quantity] + (f"; β: {SPREAD_SOURCES[quantity]}" if spread else "")
        yield _TITLES[quantity], values[quantity], spread, source
    height = f"{archetype.storey_height:g} m"
    if "height" in seen.building:
        yield "storey height", str(seen.building["height"]), "", f"given in the study; of the type: {height}"
    else:
        yield "storey height", height, "", SOURCES["height"]
    hardening = format_number(archetype.hardening, 3)
    if "hardening" in seen.building:
        yield "hardening", str(seen.building["hardening"]), "", f"given in the study; of the type: {hardening}"
    else:
        yield (
            "hardening",
            hardening,
            "",
            f"{SOURCES['hardening']}; ultimate point at a ductility of "
            + format_number(archetype.ultimate_ductility, 3),
        )
    mass = "given in the study" if "mass" in seen.building else "default of studies; HAZUS has none: write `mass`"
    yield "floor mass", f"{format_number(building.mass.mean() / 1e3, 4)} t", "", mass
    spread = f"{archetype.spreads['drift']:.2f}" if seen.spec.uncertain else ""
    for state in DAMAGE_STATES:
        source = SOURCES["drift"] + (f"; β: {SPREAD_SOURCES['drift']}" if spread else "")
        yield f"drift, {state}", f"{100 * archetype.drift_limits[state]:.4g} %", spread, source


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


def warn_storeys_outside(study: Study, notes: Problems) -> None:
    """Note buildings that are only seen whose type does not have as many storeys."""
    for seen in list_seen(study.tree):
        if not seen.archetype.has_storeys(seen.spec.storeys):
            message = (
                f"{seen.name} has {pluralize(seen.spec.storeys, 'storey')}, but {seen.spec.type} of HAZUS is of "
                f"{seen.archetype.describe_range()}: its numbers are taken beyond their range"
            )
            notes.add(seen.building["archetype"].marks["storeys"][1], message, _hint_type(seen))


def _hint_type(seen: Seen) -> str:
    """Return the type of the same system that has as many storeys, or what to do without one."""
    system = seen.spec.type.rstrip("LMH")
    for name in list_types():
        is_alike = name.rstrip("LMH") == system and seen.spec.design in list_designs(name)
        if is_alike and find_archetype(name, seen.spec.design).has_storeys(seen.spec.storeys):
            return f"write `type: {name}`, or leave it if the range is meant to be passed"
    return "choose another type, or leave it if the range is meant to be passed"
