"""Check buildings: values, periods, strengths and moving bases that hardly any building has."""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np

from pounding_cli.errors import Issue, KeyPath
from pounding_cli.model.building import Building
from pounding_cli.numbers import pluralize
from pounding_cli.study.check.floor_plan import check_plan
from pounding_cli.study.check.values import (
    BARE,
    RelativeRange,
    Written,
    check_values,
    format_rounded,
    format_value,
    lacks_its_unit,
    suggest_value,
)
from pounding_cli.study.check.view import View
from pounding_cli.study.schema.building import BuildingSpec, StiffnessAtSpec
from pounding_cli.study.schema.quantity import FORCE_FACTORS, NUMBER_PATTERN, PLAUSIBLE_RANGES, Quantity
from pounding_cli.units import GRAVITY

FORCE_OF_STOREY = Quantity("force", "N", "900 kN")


def check_building(view: View, name: str) -> Iterator[Issue]:
    """Yield what is implausible about a building type: masses, heights, period, damping, yield shears, isolators."""
    spec = view.building_spec(name)
    building = view.building(name)
    written = view.written
    path: KeyPath = ("buildings", name)
    yield from check_values(written, spec, path)
    if spec.wall is not None:
        return
    yield from _check_period(written, spec, building, path)
    lines = () if spec.plan is None else spec.plan.lines or ()
    if isinstance(spec.yield_shear, tuple):
        yield from _check_yield_shear(written, building, (*path, "yield_shear", 0))
    elif lines and all(isinstance(line.yield_shear, tuple) for line in lines):
        yield from _check_yield_shear(written, building, (*path, "plan", "lines", 0, "yield_shear", 0), len(lines))
    yield from _check_base(written, building, path)
    if spec.plan is not None:
        yield from check_plan(spec.plan, building, (*path, "plan"))


def _check_yield_shear(written: Written, building: Building, path: KeyPath, lines: int = 1) -> Iterator[Issue]:
    """Yield a yield shear of the lowest storey that is implausible beside the weight.

    path : of the yield shear, or of that of the first of its frame lines
    lines : number of these
    """
    fits = PLAUSIBLE_RANGES["base yield shear over weight"]
    compared = RelativeRange(fits, 1 / building.weight, "yield shear", "of the building's weight", "strength")
    shear = float(building.yield_shear[0])
    if fits.holds(shear * compared.share):
        return
    share = compared.ratio_in_words(shear)
    message = f"the lowest storey yields at {format_value(shear, FORCE_FACTORS)}, {share}: {fits.reason}"
    text = written.find_text(path)
    is_bare = written.needs_units and lacks_its_unit(text, FORCE_OF_STOREY)
    hint = "check the yield shears of its lines"
    if lines == 1:
        hint = suggest_value(text, shear, fits, compared.share, "N" if is_bare else "")
    excess = fits.excess(shear * compared.share) + (BARE if is_bare else 0.0)
    yield Issue(path, message, hint, code="strength", of=path[:-1], excess=excess)


def _check_period(written: Written, spec: BuildingSpec, building: Building, path: KeyPath) -> Iterator[Issue]:
    """Yield a period that is implausible for so many storeys."""
    storeys = building.storeys
    key_path: KeyPath = (*path, "period")
    period = float(building.periods[0]) if spec.period is None else spec.period
    if spec.stiffness is not None:
        key_path = (*path, "stiffness", "period" if isinstance(spec.stiffness, StiffnessAtSpec) else 0)
    elif spec.period is None:
        key_path = (*path, "plan", "lines", 0, "stiffness", 0)
    compared = [(PLAUSIBLE_RANGES["period of a storey"], 1 / storeys)] if storeys > 1 else []
    compared.append((PLAUSIBLE_RANGES["period"], 1.0))
    for fits, share in compared:
        if fits.holds(period * share):
            continue
        message = f"a period of {format_rounded(period)} s for {pluralize(storeys, 'storey')}: {fits.reason}"
        is_written = key_path[-1] == "period"
        hint = suggest_value(written.find_text(key_path), period, fits, share) if is_written else "check its unit"
        of = key_path if is_written else key_path[:-1]
        yield Issue(key_path, message, hint, code="period", of=of, excess=fits.excess(period * share))
        return


def _check_base(written: Written, building: Building, path: KeyPath) -> Iterator[Issue]:
    """Yield a base so soft that the building would float on it."""
    base = building.foundation
    if base is None or not base.sways:
        return
    fits = PLAUSIBLE_RANGES["period on a moving base"]
    weight = building.weight + base.mass * GRAVITY
    if base.isolation is None:
        key_path: KeyPath = (*path, "foundation", "sway_stiffness")
        period = 2 * np.pi * float(np.sqrt(weight / GRAVITY / base.sway_stiffness))
    else:
        key_path = (*path, "foundation", "isolation")
        reach = base.isolation.capacity if np.isfinite(base.isolation.capacity) else 0.1
        period, _ = base.isolation.effective(weight, reach)
    if fits.holds(period):
        return
    message = f"{building.name} has a period of {format_rounded(period)} s on its base: {fits.reason}"
    text = written.find_text(key_path)
    is_bare = written.needs_units and base.isolation is None and bool(re.fullmatch(rf"\s*{NUMBER_PATTERN}\s*", text))
    hint = f"did you mean {text} kN/m? otherwise write `{text} N/m`" if is_bare else "check its stiffness"
    excess = fits.excess(period) + (BARE if is_bare else 0.0)
    yield Issue(key_path, message, hint, code="period", excess=excess)
