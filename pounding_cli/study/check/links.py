"""Check links: implausible stiffnesses and gaps, ends at unequal heights, links that stand nowhere."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from pounding_cli.errors import Issue, KeyPath
from pounding_cli.laws.joints import MAX_STABLE_STEP_AT_REST, Viscous
from pounding_cli.laws.law import LinkLaw
from pounding_cli.model.building import Building
from pounding_cli.model.wall import Wall
from pounding_cli.numbers import join_limited
from pounding_cli.study.check.values import (
    AS_MEANT,
    BARE,
    RelativeRange,
    Written,
    check_value,
    format_value,
    lacks_its_unit,
    list_quantities,
    suggest_unit,
)
from pounding_cli.study.check.view import View
from pounding_cli.study.construct.complete_links import CompleteLink
from pounding_cli.study.construct.group import Group
from pounding_cli.study.construct.link_places import build_ends
from pounding_cli.study.schema.floor_places import FloorPair
from pounding_cli.study.schema.quantity import FORCE_FACTORS, PLAUSIBLE_RANGES, Quantity
from pounding_cli.units import GRAVITY


def check_case(view: View, name: str) -> Iterator[Issue]:
    """Yield what is implausible about the links of a case: gaps, links that do nothing, contacts that floors pass."""
    group = view.group
    written = view.written
    for link, law in zip(view.links_of(name), view.laws_of(name), strict=True):
        compared = _compare_link(law, group) if law is not None else {}
        stiffness = link.values.get("stiffness")
        if stiffness is not None and "stiffness" in compared:
            path = link.paths["stiffness"]
            yield from _check_stiffness(written, group.stiffness(stiffness), path, compared["stiffness"])
        quantities = list_quantities(type(link.spec))
        for key, path in link.paths.items():
            quantity = quantities[key][1]
            value = link.values[key]
            if key != "stiffness" and quantity is not None and isinstance(value, float):
                yield from check_value(written, key, quantity, value, path, path, compared.get(key))
        if law is not None and _takes_impact_stiffness(law, link):
            contact = _compare_contact(group)
            stiffness_of_impact = group.stiffness(view.impact.stiffness)
            yield from _check_stiffness(written, stiffness_of_impact, ("impact", "stiffness"), contact)
        if isinstance(law, Viscous):
            yield from _check_stiff_damper(law, group, link.path)
        if law is not None:
            yield from _check_heights(link, law, group)
            yield from _check_stands_nowhere(link, law, group)


MIN_COSINE = 0.3
"""Cosine of the angle of a link below which it is warned about: it carries a tenth of what a level one does."""


def _check_heights(link: CompleteLink, law: LinkLaw, group: Group) -> Iterator[Issue]:
    """Yield links whose ends differ in height: joints that act level or are steep, contacts where nothing strikes."""
    floors = link.spec.floors if isinstance(link.spec.floors, tuple) else ()
    for place, floor in enumerate(floors):
        path: KeyPath = (*link.path, "floors", place)
        for number, meeting in enumerate(group.meetings, 1):
            if not isinstance(floor, FloorPair) or link.spec.pair not in (None, number):
                continue
            ends = build_ends(link.spec, floor, meeting, path)
            rise = abs(meeting.find_rise(ends))
            left_end = f"floor {floor.left} of {meeting.left.name}"
            which = f"the {law.name} from {left_end} to floor {floor.right} of {meeting.right.name}"
            heights = f"its ends differ by {rise:.3g} m in height"
            if law.joins and link.spec.distance is None and rise > meeting.reach:
                message = f"{which} acts level, though {heights}"
                hint = "write how far its ends are apart along the row, which gives its angle, e.g. `distance: 2 m`"
            elif not law.joins and rise > meeting.reach:
                message = f"{which} acts across the gap, though {heights}: these floors do not face each other"
                hint = "write `at: columns` or no floors for where slabs face columns"
            elif ends.cosine < MIN_COSINE:
                angle = np.degrees(np.arccos(ends.cosine))
                share = 100 * ends.cosine**2
                message = f"{which} is inclined {angle:.3g} degrees: "
                message += f"along the row it has {share:.2g} % of the stiffness and damping of a level link"
                hint = "choose floors nearer in height, or a longer `distance`"
            else:
                continue
            hint += f"; otherwise leave it, {AS_MEANT}"
            yield Issue(path, message, hint, code="slope", of=(*link.path, "floors"), excess=rise)


def _check_stands_nowhere(link: CompleteLink, law: LinkLaw, group: Group) -> Iterator[Issue]:
    """Yield a link that stands nowhere: no floors, or no slabs and columns, face each other in its pairs."""
    if isinstance(link.spec.floors, tuple):
        return  # the floors that it names are checked one by one
    meetings = [meeting for number, meeting in enumerate(group.meetings, 1) if link.spec.pair in (None, number)]
    at_columns = link.spec.at is not None
    has_floors = any(meeting.floors for meeting in meetings)
    has_strikes = any(meeting.strikes for meeting in meetings)
    if (has_floors and not at_columns) or (has_strikes and (at_columns or not law.joins)):
        return
    pairs = join_limited(f"{meeting.left.name} and {meeting.right.name}" for meeting in meetings)
    no_floors = f"no floors of {pairs} face each other"
    no_strikes = f"no slab faces columns of known share between {pairs}"
    if at_columns:
        reason = no_strikes
        hint = "write `columns:` in the building whose columns it ends on"
    elif law.joins:
        reason = no_floors
        hint = "write both of its ends, e.g. `floors: [[2, 2]]`"
    else:
        reason = f"{no_floors}, and {no_strikes}"
        hint = "write `columns:` in the building whose columns are struck"
    message = f"the {law.name} stands nowhere: {reason}"
    yield Issue((*link.path, "link"), message, f"{hint}; otherwise leave it, {AS_MEANT}", code="nowhere")


MAX_STEPS_PER_SECOND = 20_000
"""Steps for a second of the motion from which a viscous damper near rest is warned about: some tenths of a second."""


def _check_stiff_damper(law: Viscous, group: Group, path: KeyPath) -> Iterator[Issue]:
    """Yield a viscous damper whose slope at rest takes more steps than is usual."""
    lightest = min(float(building.mass.min()) for building in _frames(group))
    slope = law.force_at_1_m_s * law.straight_below ** (law.exponent - 1.0)
    steps = slope / (MAX_STABLE_STEP_AT_REST * lightest)
    if steps <= MAX_STEPS_PER_SECOND:
        return
    dashpot = f"near rest the viscous damper is a dashpot of {slope:.2g} N s/m, beside a floor of {lightest:.3g} kg"
    cost = f"it takes up to {steps:.1g} steps for each second in which the floors hardly move"
    hint = f"write `straight_below: 1 mm/s` for fewer, or an `exponent` nearer 1; otherwise leave it, {AS_MEANT}"
    excess = float(np.log10(steps / MAX_STEPS_PER_SECOND))
    yield Issue((*path, "exponent"), f"{dashpot}: {cost}", hint, code="damper-steps", excess=excess)


def _takes_impact_stiffness(law: LinkLaw, link: CompleteLink) -> bool:
    """Return whether a link strikes with the stiffness that `impact` has."""
    takes = law.parameters()
    if "impact_stiffness" in takes:
        return True
    return "stiffness" in takes and not law.stiffness_default and "stiffness" not in link.values


def _compare_contact(group: Group) -> RelativeRange:
    """Return what the spring of a contact is compared with."""
    than = "times that of the stiffest storey"
    return RelativeRange(
        PLAUSIBLE_RANGES["contact stiffness"], 1 / _stiffest_storey(group), "stiffness of the contact", than, "link"
    )


def _compare_link(law: LinkLaw, group: Group) -> dict[str, RelativeRange]:
    """Return what the parameters of a link are compared with: stiffnesses with a storey's, forces with weights."""
    stiffest = _stiffest_storey(group)
    weight = GRAVITY * max(float(each.mass.max()) for each in _frames(group))
    parameters = law.parameters()
    found = {}
    if "stiffness" in parameters:
        found["stiffness"] = _compare_contact(group)
        if law.stiffness_default:
            than = "times that of the stiffest storey"
            found["stiffness"] = RelativeRange(
                PLAUSIBLE_RANGES["link stiffness"], 1 / stiffest, "stiffness of the link", than, "link"
            )
    if "hertz_stiffness" in parameters:
        share = law.max_slopes[0] / law.hertz_stiffness / stiffest  # type: ignore[attr-defined]
        than = "times as stiff at 1 cm of penetration as the stiffest storey"
        fits = PLAUSIBLE_RANGES["stiffness of a Hertz contact"]
        found["hertz_stiffness"] = RelativeRange(fits, share, "hertz_stiffness", than, "link")
    force = PLAUSIBLE_RANGES["force of a damper"]
    for key in ("damping_coefficient", "force_at_1_m_s"):
        if key in parameters:
            than = "times the weight of the heaviest floor at 1 m/s"
            found[key] = RelativeRange(replace(force, units=DAMPER_UNITS[key]), 1 / weight, key, than, "link")
    if "slip_force" in parameters:
        than = "times the weight of the heaviest floor"
        found["slip_force"] = RelativeRange(force, 1 / weight, "slip_force", than, "link")
    return found


DAMPER_UNITS: dict[str, Mapping[str, float]] = {
    "damping_coefficient": {"kN s/m": 1e3, "MN s/m": 1e6, "N s/m": 1.0},
    "force_at_1_m_s": FORCE_FACTORS,
}
"""Units in which people write the parameters of dampers."""


def _frames(group: Group) -> Sequence[Building]:
    """Return the buildings of a group that are no walls; all where there are walls only."""
    return [each for each in group.buildings if not isinstance(each, Wall)] or group.buildings


def _stiffest_storey(group: Group) -> float:
    """Return the stiffness of the stiffest storey of a group [N/m]."""
    return max(float(each.stiffness.max()) for each in _frames(group))


def _check_stiffness(written: Written, value: float, path: KeyPath, compared: RelativeRange) -> Iterator[Issue]:
    """Yield a stiffness of a link that has no unit, or is implausible beside a storey's."""
    text = written.find_text(path)
    is_bare = written.needs_units and lacks_its_unit(text, BARE_STIFFNESS)
    fits = compared.fits
    ratio = value * compared.share
    if fits.holds(ratio) and not is_bare:
        return
    size = f"{format_value(value, fits.units)}, {compared.ratio_in_words(value)}"
    reason = "" if fits.holds(ratio) else f": {fits.reason}"
    if is_bare:
        message = f"{path[-1]}: {text} has no unit: it is {size}{reason}"
        wide = replace(fits, low=PLAUSIBLE_RANGES["link stiffness"].low)
        hint = suggest_unit(text, value, wide, compared.share, "N/m", "stiffest storey")
        yield Issue(path, message, hint, code="unit", excess=BARE + fits.excess(ratio))
        return
    message = f"the {compared.name} is {size}{reason}"
    hint = f"write e.g. `20 x stiffest storey`; otherwise leave it, {AS_MEANT}"
    yield Issue(path, message, hint, code=compared.code, excess=fits.excess(ratio))


BARE_STIFFNESS = Quantity("stiffness", "N/m", "200 kN/mm")
