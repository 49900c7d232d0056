"""The links of a case in words: their laws, where they end, and what is left out between the floors."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

from pounding_cli.laws.infill import InfillOnColumns
from pounding_cli.laws.law import in_series
from pounding_cli.laws.pounding import restitution_from_damping
from pounding_cli.model.links import BASE, Link
from pounding_cli.numbers import Unit, join_limited
from pounding_cli.study.check.values import format_value, units_of_size
from pounding_cli.study.construct.group import Group
from pounding_cli.study.construct.link_places import LinkEnds, Meeting
from pounding_cli.study.schema.street_places import find_shared_edge

SOFTENED = ("stiffness", "impact_stiffness")
"""Parameters of laws that the bending of columns softens."""


def describe_links(
    links: Sequence[Link], group: Group, width: Unit, strength: Unit, tells_street_places: bool = False
) -> str:
    """Return the links of a case in words: how many of every law, where those end that stand at unequal places, how
    much columns that bend soften them, and which places are left without a link.

    width, strength : units of gaps and of stiffnesses
    tells_street_places : whether to say where they stand along the street, beside buildings that have plans
    """
    if not links:
        return "no links: runs as buildings alone"
    alike: dict[str, dict[Link, list[Link]]] = {}
    for whole, parts in _join_parts(links).items():
        alike.setdefault(_describe_law(whole, width, strength), {})[whole] = parts
    sentences = []
    for words, members in alike.items():
        wholes = [*members]
        places = _describe_places(wholes, group)
        along_street = _describe_street_places(members, group) if tells_street_places else ""
        texts = (f"{len(members)} x {words}", places, along_street, _describe_bending(wholes, group))
        sentences.append(", ".join(filter(None, texts)))
    return "; ".join([*sentences, *_describe_free_places(links, group)])


def _join_parts(links: Sequence[Link]) -> dict[Link, list[Link]]:
    """Return every whole link with its parts at several places along the street; one that is whole is its own part."""
    parts: dict[Link, list[Link]] = {}
    for link in links:
        whole = link
        if link.whole_law is not None:
            whole = replace(link, law=link.whole_law, whole_law=None, left_arm=0.0, right_arm=0.0)
        parts.setdefault(whole, []).append(link)
    return parts


def _describe_street_places(links: Mapping[Link, Sequence[Link]], group: Group) -> str:
    """Return where links stand along the street, with their shares; "" beside buildings without plans.

    links : whole links with their parts
    """
    texts: dict[str, None] = {}
    for whole, parts in links.items():
        meeting = group.meetings[whole.left]
        if meeting.left.street is None and meeting.right.street is None:
            continue
        pair = f"{meeting.left.name}|{meeting.right.name} " if len(group.meetings) > 1 else ""
        if meeting.has_turning_end(whole):
            texts[f"{pair}{_describe_places_of_parts(parts, meeting)}"] = None
        else:
            texts[f"{pair}whole at the base, which does not turn"] = None
    return join_limited(texts)


def _describe_places_of_parts(parts: Sequence[Link], meeting: Meeting) -> str:
    """Return where the parts of a link stand along the street, with their shares."""
    places = [_find_ends_along_street(part, meeting) for part in parts]
    texts = [_format_street_place(*ends) for ends in places]
    if len(parts) == 1:
        return f"at {texts[0]} along the street"
    low, high = find_shared_edge(meeting.left.street, meeting.right.street)
    is_level = all(left == right for left, right in places)
    ends = [_drop_rounding(low), _drop_rounding(high)]
    has_ends_of_edge = is_level and [left for left, _ in places] == ends
    shares = [f"{100 * part.share:.3g} %" for part in parts]
    if len(set(shares)) == 1:
        part = "half" if len(parts) == 2 else f"1/{len(parts)}"
        if has_ends_of_edge:
            return f"{part} at each end of the edge that they share, {' and '.join(texts)} along the street"
        return f"{part} at each of {join_limited(texts)} along the street"
    each = (f"{share} at {text}" for share, text in zip(shares, texts, strict=True))
    return f"{join_limited(each)} along the street"


def _find_ends_along_street(link: Link, meeting: Meeting) -> tuple[float, float]:
    """Return the places of both ends of a link along the street [m], of a side without a plan that of the other."""
    left, right = meeting.left.street, meeting.right.street
    left_place = None if left is None else left.centre + link.left_arm
    right_place = None if right is None else right.centre + link.right_arm
    ends = [place for place in (left_place, right_place) if place is not None]
    return _drop_rounding(ends[0]), _drop_rounding(ends[-1])


def _drop_rounding(place: float) -> float:
    """Return a place [m] to the nearest nanometre, so that two that were computed apart compare as equal."""
    return round(place, 9) + 0.0


def _format_street_place(left: float, right: float) -> str:
    """Return the places of both ends of a link along the street, as one where they are level."""
    return f"{left:.4g} m" if left == right else f"{left:.4g} m | {right:.4g} m"


def _describe_law(link: Link, width: Unit, strength: Unit) -> str:
    """Return the law of a link with its gap, stiffness and parameters; without a stiffness that columns soften."""
    law = link.law
    words = [_name_law(link), f"gap {width.text(link.gap)}"]
    stiffness = getattr(law, "stiffness", law.max_slopes[0])
    if stiffness > 0 and not link.columns:
        words.append(strength.text(stiffness, 4))
    for name, field in law.parameters().items():
        value = getattr(law, name)
        unit = field.metadata["parameter"].unit
        if name in ("gap", *SOFTENED, "straight_below") or not isinstance(value, float):
            continue
        title = name.replace("_", " ").replace("1 m s", "1 m/s")
        if name == "damping_ratio":
            words.append(f"damping ratio {100 * value:.3g} % (restitution {restitution_from_damping(value):.3g})")
        elif unit.startswith("N"):
            words.append(f"{title} {format_value(value, units_of_size(unit))}")
        else:
            words.append(f"{title} {value:.3g}{'' if unit == '-' else f' {unit}'}")
    return ", ".join(words)


def _name_law(link: Link) -> str:
    """Return the name of a law, with what it stands between where that is no pair of floors."""
    if not link.columns:
        return link.kind
    if link.law.subtracts_gap:
        return "slab against columns"
    return f"{link.kind} on columns" if link.law.joins else f"{link.kind} between slab and columns"


def _describe_places(links: Sequence[Link], group: Group) -> str:
    """Return where links end, and how they are inclined; "" of floors that face each other, or of slabs that strike
    columns, all over a group."""
    meetings = group.meetings
    is_plain = all(meetings[link.left].has_facing_ends(link) for link in links)
    if is_plain and len(links) == sum(_count_alike(meeting, bool(links[0].columns)) for meeting in meetings):
        return ""
    texts: list[str] = []
    for left, meeting in enumerate(meetings):
        ends = [format_ends(link) for link in links if link.left == left]
        if ends:
            pair = f"{meeting.left.name}|{meeting.right.name} " if len(meetings) > 1 else ""
            texts.append(f"{pair}{'floors' if len(ends) > 1 else 'floor'} {join_limited(ends)}")
    angles = [math.degrees(link.inclination) for link in links]
    if max(angles) > 0.0:
        texts.append(f"inclined {_format_range(angles)} degrees")
    elif not is_plain:
        texts.append("level")
    return ", ".join(texts)


def _count_alike(meeting: Meeting, on_columns: bool) -> int:
    return len(meeting.strikes) if on_columns else len(meeting.floors)


def format_ends(link: Link | LinkEnds) -> str:
    """Return the ends of a link as a study writes them: `3`, `5|4`, `2 + 40 %|2`."""
    ends = [_format_end(link.left_floor, link.left_at), _format_end(link.right_floor, link.right_at)]
    return ends[0] if ends[0] == ends[1] else "|".join(ends)


def _format_end(floor: int, at: float) -> str:
    if at < 1.0:
        return f"{floor - 1} + {100 * at:.3g} %"
    return str(floor) if floor else BASE


def _format_range(values: Sequence[float]) -> str:
    """Return the range of some numbers: "16 to 22"; the number alone where it is one."""
    low = f"{min(values):.3g}"
    high = f"{max(values):.3g}"
    return low if low == high else f"{low} to {high}"


def _describe_bending(links: Sequence[Link], group: Group) -> str:
    """Return how much the bending of the columns that links end on leaves of their stiffness; "" of no columns."""
    on_columns = [link for link in links if link.columns]
    if not on_columns:
        return ""
    shares = [_find_share_left(link, group) for link in on_columns]
    known = [100.0 * share for share in shares if share is not None]
    if not known:
        return "the columns bend under it without being simulated: it has no spring"
    return f"bending columns leave {_format_range(known)} % of its stiffness"


def _find_share_left(link: Link, group: Group) -> float | None:
    """Return what part of the stiffness of a link the bending of columns leaves [-]; None of a law without one."""
    stiffness = getattr(link.law, "stiffness", None)
    if stiffness is None:
        return None
    meeting = group.meetings[link.left]
    if link.left_at < 1.0:
        flexibility = meeting.left.deflection(link.left_floor, link.left_at)
    else:
        flexibility = meeting.right.deflection(link.right_floor, link.right_at)
    if isinstance(link.law, InfillOnColumns):
        stiffness = in_series(stiffness, link.law.flexibility)
    return 1.0 - flexibility * stiffness


def _describe_free_places(links: Sequence[Link], group: Group) -> list[str]:
    """Return a sentence on the places where buildings face each other without a link: there nothing stops them."""
    parts = []
    for left, meeting in enumerate(group.meetings):
        linked = {link.ends for link in links if link.left == left}
        free = [LinkEnds(*floors) for floors in meeting.floors] + list(meeting.strikes)
        free = [ends for ends in free if _ends_at(left, ends) not in linked]
        if free:
            pair = f" of {meeting.left.name}|{meeting.right.name}" if len(group.meetings) > 1 else ""
            noun = "floors" if len(free) > 1 else "floor"
            parts.append(f"{noun} {join_limited(map(format_ends, free))}{pair}")
    return [f"no link at {' and '.join(parts)}: collisions there are not simulated"] if parts else []


def _ends_at(left: int, ends: LinkEnds) -> tuple[tuple[int, int, float], tuple[int, int, float]]:
    """Return ends as `Link.ends` has them."""
    return (left, ends.left_floor, ends.left_at), (left + 1, ends.right_floor, ends.right_at)
