"""Put the laws of the links of a case (`complete_links.py`) at the floors where these stand (`link_places.py`)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from pounding_cli.errors import InputError, Issue, KeyPath
from pounding_cli.laws.law import LinkLaw
from pounding_cli.model.links import Link
from pounding_cli.study.construct.complete_links import CompleteLink
from pounding_cli.study.construct.link_places import Floors, LinkEnds, Meeting
from pounding_cli.study.schema.street_places import WHOLE_AT_CENTRES, find_link_arms


def build_links(
    links: Sequence[CompleteLink],
    laws: Sequence[LinkLaw | None],
    floors: Floors,
    meetings: Sequence[Meeting],
) -> tuple[Link, ...]:
    """Return the links of all pairs of neighbours, by pair and then from the ground up.

    Raises
    ------
    InputError : two links are alike, a link across a gap is inclined, or stands between a slab and columns without
        a law for that
    """
    issues: dict[Issue, None] = {}
    built: list[Link] = []
    for pair, meeting in enumerate(meetings):
        at_meeting_floors = [LinkEnds(*both) for both in meeting.floors]
        listed = {ends for of_link in floors[pair] for ends in of_link}
        elsewhere = listed.difference(at_meeting_floors, meeting.strikes)
        for ends in (*at_meeting_floors, *sorted(elsewhere)):
            here = [number for number, law in enumerate(laws) if law is not None and ends in floors[pair][number]]
            built += _build_links_at(pair, ends, here, links, laws, meeting, issues)
        members = [number for number, link in enumerate(links) if link.spec.pair in (None, pair + 1)]
        at_columns = _choose_links_at_columns(meeting, members, links, laws, issues)
        for ends in meeting.strikes:
            here = [number for number, law in enumerate(laws) if law is not None and ends in floors[pair][number]]
            built += _build_links_at(pair, ends, sorted({*at_columns, *here}), links, laws, meeting, issues)
    if issues:
        raise InputError(issues)
    return tuple(built)


def _build_links_at(
    pair: int,
    ends: LinkEnds,
    numbers: Sequence[int],
    links: Sequence[CompleteLink],
    laws: Sequence[LinkLaw | None],
    meeting: Meeting,
    issues: dict[Issue, None],
) -> list[Link]:
    """Return the links of a case that stand between the same ends; parts of one link where it stands at several places.

    numbers : of these links among those of the case
    """
    parts_by_law: dict[LinkLaw, list[list[Link]]] = {}
    built: list[Link] = []
    for number in numbers:
        path = links[number].path
        law = laws[number]
        assert law is not None
        alike = parts_by_law.setdefault(law, [])
        distance = links[number].spec.distance
        if distance is not None and not law.joins:
            message = f"'distance' does not apply to link: {links[number].title}, which acts level across its gap"
            issues[Issue((*path, "distance"), message, "remove it", at_key=True)] = None
            continue
        if distance is not None and distance < law.gap:
            message = f"the ends of the link are {distance:g} m apart, closer than the gap of {law.gap:g} m"
            issues[Issue((*path, "distance"), message, "write the distance of its ends along the row")] = None
        if ends.flexibility:
            softened = law.soften(ends.flexibility * ends.cosine**2)
            if softened is None:
                issues[_refuse_at_columns(links[number], links[number].title)] = None
                continue
            law = softened
        whole = Link(
            pair, ends.left_floor, ends.right_floor, law, ends.left_at, ends.right_at, ends.columns, ends.cosine
        )
        try:
            parts = _part_link(whole, links[number], meeting)
        except InputError as refused:
            issues |= {issue: None for issue in refused.issues if not issue.is_placed}
            continue
        issue = _find_link_alike(parts, alike, path)
        if issue is not None:
            issues[issue] = None
        alike.append(parts)
        built += parts
    return built


def _find_link_alike(parts: Sequence[Link], alike: Sequence[Sequence[Link]], path: KeyPath) -> Issue | None:
    """Return what is wrong with a link beside others of one law between the same ends; None if nothing is.

    parts : of the link along the street
    alike : parts of every other link
    """
    message = f"two {parts[0].law.name} links alike between the same floors"
    if any(_act_at_one_place(parts, others) for others in alike):
        return Issue(path, message, "give one, or let them differ")
    if any(len(parts) > 1 or len(others) > 1 for others in alike):
        hint = "write one link with all of the `places:` and their `shares:`"
        return Issue(path, f"{message}, at several places", hint)
    return None


def _act_at_one_place(parts: Sequence[Link], others: Sequence[Link]) -> bool:
    """Return whether two links of one law between the same ends have the same places along the street."""
    places = {(link.left_arm, link.right_arm, link.law) for link in parts}
    return places == {(link.left_arm, link.right_arm, link.law) for link in others}


def _part_link(whole: Link, link: CompleteLink, meeting: Meeting) -> list[Link]:
    """Return a link as it stands along the street, or its parts at several places.

    Raises
    ------
    InputError : it stands where it cannot, or its law cannot be parted
    """
    left, right = meeting.left, meeting.right
    arms = find_link_arms(link.spec, link.path, (left.name, right.name), left.street, right.street)
    if arms is WHOLE_AT_CENTRES:
        return [whole]
    if len(arms) == 1:
        return [replace(whole, left_arm=arms[0].left_arm, right_arm=arms[0].right_arm)]
    parts = []
    for left_arm, right_arm, share in arms:
        law = whole.law.scale(share)
        if law is None:
            message = f"link: {link.title} cannot stand at several places, and floors that twist strike at both ends"
            raise InputError([Issue(link.path, message, "write one place, e.g. `places: 0 m`")])
        parts.append(replace(whole, law=law, left_arm=left_arm, right_arm=right_arm, whole_law=whole.law))
    return parts


def _choose_links_at_columns(
    meeting: Meeting,
    members: Sequence[int],
    links: Sequence[CompleteLink],
    laws: Sequence[LinkLaw | None],
    issues: dict[Issue, None],
) -> list[int]:
    """Return the links that stand where slabs strike columns: those that say so, else those across a gap that list no
    floors.

    members : numbers of the links of the pair
    """
    if not meeting.strikes:
        return []
    speaking = [number for number in members if links[number].spec.at is not None]
    if not speaking:
        unlisted = [number for number in members if not isinstance(links[number].spec.floors, tuple)]
        unlisted = [number for number in unlisted if laws[number] is not None]
        speaking = [number for number in unlisted if not _is_joint(laws[number])]
        if unlisted and not speaking:
            number = unlisted[0]
            issues[_refuse_silent_joint(links[number], meeting)] = None
    return [number for number in speaking if laws[number] is not None]


def _is_joint(law: LinkLaw | None) -> bool:
    return law is not None and law.joins


def _refuse_silent_joint(link: CompleteLink, meeting: Meeting) -> Issue:
    """Return what is wrong with a joint that does not say where it stands, though slabs strike columns."""
    message = f"slabs strike columns here, and a {link.law} that does not say so does not stand between a slab and "
    message += "columns"
    left = meeting.strikes[0].left_floor
    right = meeting.strikes[0].right_floor
    hint = f"write where it stands, both ends `floors: [[{left}, {right}]]` or `at: columns`; or an entry beside it, "
    hint += "`{link: pounding, at: columns}` or `{link: none, at: columns}`"
    return Issue((*link.path, "link"), message, hint)


def _refuse_at_columns(link: CompleteLink, words: str) -> Issue:
    """Return what is wrong with a link that does not stand between a slab and columns; words : what it is."""
    message = f"slabs strike columns here, and {words} does not stand between a slab and columns"
    hint = "write an entry `{link: pounding, at: columns}`, and `impact: {law: kelvin-voigt}`; or `link: none`"
    is_of_impact = link.law != link.spec.link
    return Issue(("impact", "law") if is_of_impact else (*link.path, "link"), message, hint)
