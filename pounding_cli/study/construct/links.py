"""Build the laws and the links of a case."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from pounding_cli.errors import Issue, KeyPath
from pounding_cli.laws.law import LinkLaw
from pounding_cli.laws.pounding import DashpotLaw
from pounding_cli.model.links import Link
from pounding_cli.study.construct.complete_links import CompleteLink, find_losses
from pounding_cli.study.construct.group import Group
from pounding_cli.study.construct.link_places import Floors, LinkEnds, Meeting
from pounding_cli.study.construct.own_laws import OwnLaw
from pounding_cli.study.schema.links import NO_LINK, to_enum
from pounding_cli.study.schema.quantity import LINK_STIFFNESS, StoreyMultiple
from pounding_cli.study.schema.street_places import WHOLE_AT_CENTRES, find_link_arms
from pounding_cli.study.text.issues import Issues, IssuesFound

# Laws


def list_multiples(links: Sequence[CompleteLink], impact: Any) -> tuple[StoreyMultiple, ...]:
    """Return the stiffnesses of links that are multiples of a storey's, each once."""
    multiples: dict[StoreyMultiple, None] = {}
    for link in links:
        law = link.law_class
        if law is None:
            continue
        stiffnesses = [value for key, value in link.values.items() if key != "stiffness"]
        stiffnesses.append(link.values.get("stiffness") or _default_stiffness(law, impact))
        if "impact_stiffness" in law.parameters():
            stiffnesses.append(impact.stiffness)
        multiples |= {each: None for each in stiffnesses if isinstance(each, StoreyMultiple)}
    return tuple(multiples)


def evaluate_multiples(multiples: Sequence[StoreyMultiple], group: Group) -> tuple[tuple[StoreyMultiple, float], ...]:
    """Return multiples of a storey's stiffness, each with what it comes to [N/m]."""
    return tuple((multiple, group.stiffness(multiple)) for multiple in multiples)


def _default_stiffness(law: Any, impact: Any) -> Any:
    """Return the stiffness of a link that gives none: that of its law, else that of `impact`."""
    return LINK_STIFFNESS.read(law.stiffness_default) if law.stiffness_default else impact.stiffness


def build_laws(
    links: Sequence[CompleteLink],
    impact: Any,
    laws: Mapping[str, OwnLaw],
    multiples: Sequence[tuple[StoreyMultiple, float]],
    floors: Floors,
) -> tuple[LinkLaw | None, ...]:
    """Return the law of every link of a case; None of no link.

    Raises
    ------
    IssuesFound : the parameters of a law do not go together, of a link that joins something
    """
    issues = Issues()
    built = []
    for number, link in enumerate(links):
        law = None
        may_be_at_columns = link.spec.at is not None or (link.law_class is not None and not link.law_class.joins)
        joins = may_be_at_columns or any(of_pair[number] for of_pair in floors)
        found: Sequence[Issue] = ()
        try:
            law = _build_law(link, impact, laws, dict(multiples))
        except IssuesFound as refused:
            found = refused.issues
        except ValueError as error:
            found = [Issue(link.path, str(error).removeprefix("link: "), "correct it")]
        if joins:
            issues.add_written(found)
        built.append(law)
    issues.check()
    return tuple(built)


def _build_law(
    link: CompleteLink, impact: Any, laws: Mapping[str, OwnLaw], multiples: Mapping[Any, float]
) -> LinkLaw | None:
    if link.law == NO_LINK:
        return None
    law = link.law_class
    if law is None:
        return laws[link.law].build(link.values["gap"])
    values = {
        "stiffness": _default_stiffness(law, impact),
        "impact_stiffness": impact.stiffness,
        "dashpot": DashpotLaw(impact.dashpot),
        "tension_cut": impact.tension_cut,
        **link.values,
        **find_losses(link.values, law),
    }
    parameters = {name: to_enum(law, name, values[name]) for name in law.parameters() if name in values}
    parameters = {
        name: multiples[value] if isinstance(value, StoreyMultiple) else value for name, value in parameters.items()
    }
    numbers = {name: value for name, value in parameters.items() if isinstance(value, float)}
    if conflict := law.find_conflict(**numbers):
        key, message, hint = conflict
        raise IssuesFound([Issue(link.paths.get(key, (*link.path, key)), message, hint)])
    built: LinkLaw = law(**parameters)
    return built


# Links


def build_links(
    links: Sequence[CompleteLink],
    laws: Sequence[LinkLaw | None],
    floors: Floors,
    meetings: Sequence[Meeting],
) -> tuple[Link, ...]:
    """Return the links of all pairs of neighbours, by pair and then from the ground up.

    Raises
    ------
    IssuesFound : two links are alike, a link across a gap is inclined, or stands between a slab and columns without
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
        raise IssuesFound(issues)
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
        except IssuesFound as refused:
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
    IssuesFound : it stands where it cannot, or its law cannot be parted
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
            raise IssuesFound([Issue(link.path, message, "write one place, e.g. `places: 0 m`")])
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
