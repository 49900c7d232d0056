"""Build the links of a case: what it and `impact` say of each, and its law."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from pounding_cli.errors import Problem
from pounding_cli.laws import KELVIN_VOIGT, contact_laws, link_laws
from pounding_cli.laws.law import LinkLaw
from pounding_cli.laws.pounding import DashpotLaw, damping_ratio, restitution_from_damping
from pounding_cli.model.links import Link
from pounding_cli.numbers import pluralize
from pounding_cli.study.file import nearest
from pounding_cli.study.group import Group
from pounding_cli.study.issues import Issue, Issues, IssuesFound, KeyPath
from pounding_cli.study.link_places import Floors, LinkEnds, Meeting
from pounding_cli.study.link_specs import (
    LOSSES,
    NO_LINK,
    PLACES,
    POUNDING,
    SHARED_KEYS,
    LinkSpec,
    SeveralLinksSpec,
    link_keys,
    list_links,
    list_words,
    needs_key,
    own_parameters,
    to_enum,
)
from pounding_cli.study.own_laws import OwnLaw
from pounding_cli.study.quantity import LINK_STIFFNESS, StoreyMultiple
from pounding_cli.study.street_places import WHOLE_AT_CENTRES, find_link_arms

RESTITUTION = 0.5
"""Coefficient of restitution where neither a link nor `impact` gives one or a damping ratio [-]."""


@dataclass(frozen=True, eq=False)
class CompleteLink:
    """A link with everything that it, its case and `impact` say of it.

    spec, path : the link as written, and where it stands
    law : the name of its law; of pounding, the law of contact that `impact` names
    values : what is written of the keys of its law
    paths : where each of these values stands
    """

    spec: LinkSpec
    path: KeyPath
    law: str
    values: Mapping[str, Any]
    paths: Mapping[str, KeyPath]

    @property
    def law_class(self) -> Any:
        """The class of its law; None of a law of the study's own, and of no link."""
        return link_laws().get(self.law)

    @property
    def title(self) -> str:
        """The name of its law in messages."""
        return self.law if self.law == self.spec.link else f"{POUNDING} of {self.law}"


# What a case says of its links


def complete_links(name: str, case: Any, impact: Any) -> tuple[CompleteLink, ...]:
    """Return the links of a case with what the case and `impact` say of them.

    A link takes from its case what its law has, except for a stiffness, which does not say whose it is; a law of
    contact takes the rest from `impact`, others only losses and the tension cut. The stiffness of `impact` is not among
    the values: `build_laws` takes it where a link has none.
    """
    shared = case if isinstance(case, SeveralLinksSpec) else None
    return tuple(_complete_link(link, path, shared, name, impact) for link, path in list_links(name, case))


def _complete_link(link: LinkSpec, path: KeyPath, case: Any, name: str, impact: Any) -> CompleteLink:
    law_name = impact.law if link.link == POUNDING and impact.law != KELVIN_VOIGT else link.link
    keys = _keys_of_law(law_name)
    law = link_laws().get(law_name)
    keys_of_impact = keys - {"stiffness"} if law is not None and law.subtracts_gap else keys & {*LOSSES, "tension_cut"}
    sources: list[tuple[Any, KeyPath, Collection[str]]] = [(link, path, keys)]
    if case is not None:
        sources.append((case, ("cases", name), keys - {"stiffness"}))
    sources.append((impact, ("impact",), keys_of_impact))
    values: dict[str, Any] = {}
    paths: dict[str, KeyPath] = {}
    for source, place, taken in sources:
        has_loss = any(loss in values for loss in LOSSES)
        for key in source.model_fields_set:
            value = getattr(source, key)
            if key in taken and key not in values and value is not None and not (has_loss and key in LOSSES):
                values[key] = value
                paths[key] = (*place, key)
    return CompleteLink(link, path, law_name, values, paths)


def _keys_of_law(law_name: str) -> frozenset[str]:
    """Return the keys that a link of a law takes; of a law of the study's own the gap alone."""
    law = link_laws().get(law_name)
    if law is not None:
        return link_keys(law)
    return frozenset() if law_name == NO_LINK else frozenset({"gap"})


def check_links(
    name: str, case: Any, links: tuple[CompleteLink, ...], names: Names, left_out: Collection[str] = ()
) -> tuple[CompleteLink, ...]:
    """Return the links of a case unchanged; those of unknown laws are not looked at.

    left_out : keys that `impact` has, but faulty

    Raises
    ------
    IssuesFound : a key is missing, does not apply to the law of its link, or to no link of the case
    """
    known = [link for link in links if link.law in (*link_laws(), *names.laws, NO_LINK)]
    issues = [issue for link in known for issue in find_key_issues(link, left_out)]
    if isinstance(case, SeveralLinksSpec) and len(known) == len(links):
        issues += find_idle_shared_keys(name, case, links)
    if issues:
        raise IssuesFound(issues)
    return links


def find_key_issues(link: CompleteLink, left_out: Collection[str] = ()) -> list[Issue]:
    """Return what is wrong with the keys of a link: missing, not of its law, or a word that its law does not know.

    left_out : keys that are written, but faulty
    """
    if link.law == NO_LINK:
        return []
    return [*_find_missing_keys(link, left_out), *_find_idle_keys(link), *_find_unknown_words(link)]


def find_idle_shared_keys(name: str, case: SeveralLinksSpec, links: Sequence[CompleteLink]) -> list[Issue]:
    """Return an issue for every key beside `links:` that none of them takes."""
    taken = frozenset().union(*(_keys_of_law(link.law) - {"stiffness"} for link in links))
    idle = [key for key in case.model_fields_set if key != "links" and key not in taken]
    return [Issue(("cases", name, key), *refuse_beside_links(key), at_key=True) for key in idle]


def refuse_beside_links(key: str) -> tuple[str, str]:
    """Return what is wrong with a key beside `links:` that none of them takes, and what to write."""
    hint = f"write it in the entry that it is of: `links: [{{link: ..., {key}: ...}}]`"
    return f"'{key}' beside `links:` does not apply to them, or does not say which it is of", hint


def refuse_key(key: str, title: str, keys: Iterable[str]) -> tuple[str, str]:
    """Return what is wrong with a key that the law of a link does not have, and what to write.

    title : of the law; keys : that it takes
    """
    owners = [law.name for law in link_laws().values() if key in link_keys(law)]
    takes = ", ".join(each for each in keys if each not in PLACES)
    hint = f"remove it: {title} takes {takes or 'none'}; it belongs to {', '.join(owners)}"
    return f"'{key}' does not apply to link: {title}", hint


def _find_missing_keys(link: CompleteLink, left_out: Collection[str]) -> list[Issue]:
    """Return an issue for every key that a law needs and nothing gives."""
    issues = []
    given = {*link.values, *left_out}
    if "gap" not in given:
        field = SHARED_KEYS["gap"][1]
        hint = f"write {field.description}, e.g. `gap: {field.examples[0]}`"
        issues.append(Issue(link.path, "'gap' is missing", hint))
    law = link.law_class
    for key, declared in own_parameters(law).items() if law is not None else ():
        if needs_key(law, key) and key not in given:
            contact = " here or under `impact`" if law.subtracts_gap else ""
            message = f"a {law.name} needs it{contact}: {declared.description}"
            issues.append(Issue(link.path, f"'{key}' is missing", message))
    return issues


def _find_idle_keys(link: CompleteLink) -> list[Issue]:
    """Return an issue for every key of a link as written that its law does not have."""
    law = link.law_class
    keys = _keys_of_law(link.law)
    issues = []
    ordered = [key for key in type(link.spec).model_fields if key in keys]
    for key in link.spec.model_fields_set - {*PLACES} - keys:
        issues.append(Issue((*link.path, key), *refuse_key(key, link.title, ordered), at_key=True))
    ratio = link.values.get("damping_ratio")
    if law is not None and ratio is not None and {*LOSSES} & law.parameters().keys() == {"restitution"}:
        message = f"'damping_ratio' is that of a Kelvin-Voigt contact; a {law.name} takes 'restitution'"
        hint = f"write `restitution: {restitution_from_damping(ratio):.3g}`, the e of that ratio there"
        issues.append(Issue(link.paths["damping_ratio"], message, hint, at_key=True))
    return issues


def _find_unknown_words(link: CompleteLink) -> list[Issue]:
    """Return an issue for every word that the law of a link does not know, though another law does."""
    issues = []
    for key, value in link.values.items() if link.law_class is not None else ():
        words = list_words(link.law_class, key)
        if words and value not in words:
            known = ", ".join(f"'{word}'" for word in words[:-1])
            choice = f"{known} or '{words[-1]}'" if known else f"'{words[-1]}'"
            is_here = link.paths[key][:-1] == link.path
            message = f"{key}: '{value}' is not known to link: {link.title}"
            hint = f"write {choice}" if is_here else f"write `{key}:` in this link: {choice}"
            issues.append(Issue(link.paths[key] if is_here else link.path, message, hint))
    return issues


def find_losses(values: Mapping[str, Any], law: Any) -> dict[str, float]:
    """Return damping ratio and coefficient of restitution of a link [-]: one is given, the other follows from it.

    Empty for a law that takes neither. What gives neither has that of a restitution of RESTITUTION.
    """
    ratio = values.get("damping_ratio")
    restitution = values.get("restitution")
    if ratio is not None:
        return {"damping_ratio": ratio, "restitution": restitution_from_damping(ratio)}
    if restitution is None:
        if not link_keys(law) & {*LOSSES}:
            return {}
        restitution = RESTITUTION
    return {"damping_ratio": damping_ratio(restitution) + 0.0, "restitution": restitution}  # no negative zero at e = 1


# Names that a case may not have


@dataclass(frozen=True)
class Names:
    """The names of the laws and buildings of a study, and the number of pairs of neighbours."""

    laws: tuple[str, ...]
    buildings: tuple[str, ...]
    pairs: int


@dataclass(frozen=True)
class NamedInLink:
    """The names in a link: its law, the number of a pair (0 for every pair), and its stiffness.

    None stands for what is unknown.
    """

    path: KeyPath
    law: str | None
    pair: int
    stiffness: Any


def check_case_names(name: str, case: Any, names: Names) -> Any:
    """Return a case unchanged.

    Raises
    ------
    IssuesFound : one of its links is of a law, a pair or a building that the study does not have
    """
    issues: list[Issue] = []
    for link, path in list_links(name, case):
        named = NamedInLink(path, link.link, link.pair or 0, getattr(link, "stiffness", None))
        issues += find_link_name_issues(named, names)
    if issues:
        raise IssuesFound(issues)
    return case


def find_link_name_issues(link: NamedInLink, names: Names) -> list[Issue]:
    """Return an issue for every law, pair and building that a link names and the study does not have."""
    issues: list[Issue] = []
    if link.law is not None and link.law not in (*link_laws(), *names.laws, NO_LINK):
        issues.append(Issue((*link.path, "link"), *refuse_law(link.law, names.laws)))
    if 0 < names.pairs < link.pair:
        issues.append(Issue((*link.path, "pair"), *refuse_pair(link.pair, names.pairs)))
    return issues + _find_unknown_building(link.stiffness, (*link.path, "stiffness"), names)


def check_impact_names(impact: Any, names: Names) -> Any:
    """Return the impact element unchanged.  Raises IssuesFound: it names a law or building that the study lacks."""
    issues = find_impact_name_issues(impact.law, impact.stiffness, names)
    if issues:
        raise IssuesFound(issues)
    return impact


def find_impact_name_issues(law: str | None, stiffness: Any, names: Names) -> list[Issue]:
    """Return an issue for every law and building that the impact element names and the study does not have."""
    issues = _find_unknown_building(stiffness, ("impact", "stiffness"), names)
    if law is not None and law not in (*contact_laws(), *names.laws):
        issues.append(Issue(("impact", "law"), *refuse_contact(law, names.laws)))
    return issues


def _find_unknown_building(stiffness: Any, path: KeyPath, names: Names) -> list[Issue]:
    """Return what is wrong with a stiffness that is a multiple of a storey of a building that is not defined."""
    if not isinstance(stiffness, StoreyMultiple) or stiffness.building in (None, *names.buildings):
        return []
    building = str(stiffness.building)
    return [Issue(path, f"no building '{building}' is defined", nearest(building, names.buildings))]


def check_contact_law(impact: Any, laws: Mapping[str, OwnLaw]) -> Any:
    """Return the impact element unchanged.  Raises IssuesFound: it names a law of the study that is none of contact."""
    contact = [name for name, law in laws.items() if law.is_contact]
    if impact.law in (*contact_laws(), *contact):
        return impact
    raise IssuesFound([Issue(("impact", "law"), *refuse_contact(impact.law, contact))])


def refuse_law(word: str, laws: Iterable[str]) -> tuple[str, str]:
    """Return what is wrong with a link whose law nobody knows, and what to write; laws : those of the study."""
    known = (*link_laws(), *laws, NO_LINK)
    return f"link: '{word[:60]}' is not known", f"{nearest(word, known)}; a law of your own stands under `laws`"


def refuse_contact(word: str, laws: Iterable[str]) -> tuple[str, str]:
    """Return what is wrong with a law of contact that nobody knows, and what to write; laws : those of the study."""
    return f"'{word[:60]}' is not a law of contact", f"write {', '.join((*contact_laws(), *laws))}"


def refuse_pair(pair: int, pairs: int) -> tuple[str, str]:
    """Return what is wrong with the number of a pair of neighbours that a group lacks, and what to write."""
    message = f"pair: {pair}, but the group has {pluralize(pairs, 'pair')} of neighbours"
    return message, f"write a number from 1 to {pairs}, or leave it out"


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
        found: Sequence[Issue | Problem] = ()
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
            issues |= {issue: None for issue in refused.issues if isinstance(issue, Issue)}
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
