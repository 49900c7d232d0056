"""Names of laws and buildings that a case and `impact` may use."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from pounding_cli.errors import Issue, KeyPath
from pounding_cli.laws import contact_laws, link_laws
from pounding_cli.numbers import pluralize
from pounding_cli.study.construct.own_laws import OwnLaw
from pounding_cli.study.schema.links import NO_LINK, list_links
from pounding_cli.study.schema.quantity import StoreyMultiple
from pounding_cli.study.text.file import nearest
from pounding_cli.study.text.issues import IssuesFound


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
