"""The names that links and `impact` use: laws, buildings, pairs of neighbours.

They are read from the file itself, so that a name which the study lacks is told of a faulty case too.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from pydantic_core import PydanticCustomError

from pounding_cli.errors import InputError, Issue, KeyPath
from pounding_cli.laws import contact_laws, link_laws
from pounding_cli.numbers import pluralize
from pounding_cli.study.construct.own_laws import OwnLaw
from pounding_cli.study.schema.links import MAX_PAIR, NO_LINK
from pounding_cli.study.schema.quantity import LINK_STIFFNESS, StoreyMultiple
from pounding_cli.study.text.file import Items, Map, get, nearest


@dataclass(frozen=True)
class Names:
    """The names of the laws and buildings of a study, and the number of pairs of neighbours."""

    laws: tuple[str, ...]
    buildings: tuple[str, ...]
    pairs: int


def find_names(tree: Map, specs: Mapping[KeyPath, Any]) -> Names:
    """Return the names of laws and buildings of a study, whether or not these are sound."""
    sections = (tree.get("laws"), tree.get("buildings"))
    laws, buildings = (tuple(section) if isinstance(section, Map) else () for section in sections)
    group = specs.get(("group",))
    return Names(laws, buildings, 0 if group is None else len(group) - 1)


@dataclass(frozen=True)
class _NamedInLink:
    """The names in a link: its law, the number of a pair (0 for every pair), and its stiffness.

    None stands for what is unknown.
    """

    path: KeyPath
    law: str | None
    pair: int
    stiffness: Any


def _list_named(tree: Map, path: KeyPath) -> tuple[_NamedInLink, ...]:
    """Return what the links of a case name, as the file has them."""
    case = get(tree, *path)
    entries = case.get("links") if isinstance(case, Map) else None
    if isinstance(entries, Items):
        return tuple(_read_named(entry, (*path, "links", number)) for number, entry in enumerate(entries))
    return (_read_named(case if isinstance(case, Map) else None, path),)


def _read_named(link: Any, path: KeyPath) -> _NamedInLink:
    """Return what a link names; a word stands for the law of a link without further keys."""
    written = link if isinstance(link, Map) else {"link": link}
    law = written.get("link")
    pair = written.get("pair")
    is_law = isinstance(law, str | int | float) and not isinstance(law, bool)
    if not isinstance(pair, int) or isinstance(pair, bool) or pair > MAX_PAIR:
        pair = 0
    return _NamedInLink(path, str(law) if is_law else None, pair, _read_stiffness(written.get("stiffness")))


def _read_stiffness(value: Any) -> Any:
    """Return a stiffness as the file has it; None where it cannot be read, which is told elsewhere."""
    try:
        return LINK_STIFFNESS.read(value)
    except PydanticCustomError:
        return None


def check_link_names(tree: Map, case: str, names: Names) -> bool:
    """Return True.

    Raises
    ------
    InputError : a link of the case is of a law, a pair or a building that the study does not have
    """
    issues: list[Issue] = []
    laws = (*link_laws(), *names.laws, NO_LINK)
    for link in _list_named(tree, ("cases", case)):
        if link.law is not None and link.law not in laws:
            message = f"link: '{link.law[:60]}' is not known"
            hint = f"{nearest(link.law, laws)}; a law of your own stands under `laws`"
            issues.append(Issue((*link.path, "link"), message, hint))
        if 0 < names.pairs < link.pair:
            message = f"pair: {link.pair}, but the group has {pluralize(names.pairs, 'pair')} of neighbours"
            hint = f"write a number from 1 to {names.pairs}, or leave it out"
            issues.append(Issue((*link.path, "pair"), message, hint))
        issues += _find_unknown_building(link.stiffness, (*link.path, "stiffness"), names)
    if issues:
        raise InputError(issues)
    return True


def check_impact_names(tree: Map, names: Names) -> bool:
    """Return True.  Raises InputError: the impact element names a law or building that the study lacks."""
    law = get(tree, "impact", "law")
    stiffness = _read_stiffness(get(tree, "impact", "stiffness"))
    issues = _find_unknown_building(stiffness, ("impact", "stiffness"), names)
    if isinstance(law, str) and law.strip() not in (*contact_laws(), *names.laws):
        issues.append(_refuse_contact(law.strip(), names.laws))
    if issues:
        raise InputError(issues)
    return True


def check_contact_law(impact: Any, laws: Mapping[str, OwnLaw]) -> Any:
    """Return the impact element unchanged.  Raises InputError: it names a law of the study that is none of contact."""
    contact = [name for name, law in laws.items() if law.is_contact]
    if impact.law in (*contact_laws(), *contact):
        return impact
    raise InputError([_refuse_contact(impact.law, contact)])


def _refuse_contact(word: str, laws: Iterable[str]) -> Issue:
    """Return what is wrong with a law of contact that nobody knows; laws : those of the study."""
    message = f"'{word[:60]}' is not a law of contact"
    return Issue(("impact", "law"), message, f"write {', '.join((*contact_laws(), *laws))}")


def _find_unknown_building(stiffness: Any, path: KeyPath, names: Names) -> list[Issue]:
    """Return what is wrong with a stiffness that is a multiple of a storey of a building that is not defined."""
    if not isinstance(stiffness, StoreyMultiple) or stiffness.building in (None, *names.buildings):
        return []
    building = str(stiffness.building)
    return [Issue(path, f"no building '{building}' is defined", nearest(building, names.buildings))]
