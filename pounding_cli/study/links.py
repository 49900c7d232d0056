"""From a validated case to the links of a scene, and the laws of links that a study writes itself."""

from __future__ import annotations

import functools
import keyword
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from pydantic_core import PydanticCustomError

from pounding_cli.laws import contact_laws, link_laws
from pounding_cli.laws.formula import GIVEN, WRITTEN, FormulaError, WrittenLaw
from pounding_cli.laws.law import LinkLaw
from pounding_cli.laws.pounding import DashpotLaw, Pounding, damping_ratio, restitution_of
from pounding_cli.model.links import BASE, Link
from pounding_cli.model.meetings import Strike, column_flexibility
from pounding_cli.numbers import counted
from pounding_cli.study.build import Group
from pounding_cli.study.file import Items, Map, Problems, Quoted, Steps, get, locate, nearest
from pounding_cli.study.laws import FORMULA, LOSSES, keys_of, link_models, own, tag_of, typed
from pounding_cli.study.models import Case
from pounding_cli.study.quantity import LINK_STIFFNESS, StoreyMultiple
from pounding_cli.study.spell import GONE
from pounding_cli.study.words import fields_of

RESTITUTION = 0.5
"""Coefficient of restitution where neither a link nor `impact` gives one or a damping ratio [-]."""

_TRIED = 0.01
"""Gap [m] at which a formula is tried when it is read."""


OwnLaw = functools.partial[WrittenLaw]
"""law(gap) -> a law of the study's own across a gap [m]."""


def own_laws(specs: Mapping[str, Any], root: Any, problems: Problems) -> dict[str, OwnLaw] | None:
    """The laws of a study by name; None where something is wrong with one, which is noted."""
    found, first = dict[str, OwnLaw](), len(problems.found)
    for name, spec in specs.items():
        path, before = ("laws", name), len(problems.found)
        if name in (*link_laws(), "none", "apart"):
            problems.at(root, path, f"'{name}' is a law of this program", "give yours another name", key=True)
        for parameter in spec.parameters:
            if not parameter.isidentifier() or keyword.iskeyword(parameter) or parameter in (*GIVEN, "sqrt"):
                hint = f"write a name of letters, digits and _ other than {', '.join(GIVEN)} and sqrt"
                at = (*path, "parameters", parameter)
                problems.at(root, at, f"'{parameter}' cannot be a parameter", hint, key=True)
        constants = tuple((key, value.value, value.dimension) for key, value in spec.parameters.items())
        formula, cut = spec.force.strip(), spec.tension_cut
        law = functools.partial(WRITTEN[spec.acts], called=name, formula=formula, constants=constants, tension_cut=cut)
        found[name] = law
        if len(problems.found) > before:
            continue
        try:
            law(_TRIED)
        except FormulaError as error:
            (line, column), text = locate(root, (*path, "force")), get(root, *path, "force")
            if error.line == 0 and isinstance(column, int) and "\n" not in text:
                column += error.column + len(text) - len(text.lstrip()) + isinstance(text, Quoted)
            problems.add((line, column), f"force: {error.message}", error.hint)
        except ValueError as error:
            problems.at(root, (*path, "force"), f"{error}", "write a shorter formula")
    return None if len(problems.found) > first else found


def check_contact(word: str, laws: Mapping[str, OwnLaw], root: Any, problems: Problems) -> bool:
    """Whether what `impact.law` names is a law of contact; noted where it is none."""
    written = [name for name, law in laws.items() if law(_TRIED).subtracts_gap]
    if word in (*contact_laws(), *written):
        return True
    problems.at(root, ("impact", "law"), *refuse_contact(word, written))
    return False


def refuse_contact(word: str, laws: Iterable[str]) -> tuple[str, str]:
    """Return what is wrong with a law of contact that nobody knows, and what to write; laws : those of the study."""
    return f"'{word[:60]}' is not a law of contact", f"write {', '.join((*contact_laws(), *laws))}"


def check_places(case: Case, group: Group, path: Steps, root: Any, problems: Problems) -> None:
    """Note the pairs and floors of links that the group does not have."""
    _Builder(group, None, {}, root, problems).check_places(case, (*path, "links"))


def refuse_law(word: str, laws: Iterable[str]) -> tuple[str, str]:
    """Return what is wrong with a link whose law nobody knows, and what to write; laws : those of the study."""
    known = (*link_laws(), *laws, "none")
    return f"link: '{word[:60]}' is not known", f"{nearest(word, known)}; a law of your own stands under `laws`"


def refuse_pair(pair: int, pairs: int) -> tuple[str, str]:
    """Return what is wrong with the number of a pair of neighbours that a group lacks, and what to write."""
    message = f"pair: {pair}, but the group has {counted(pairs, 'pair')} of neighbours"
    return message, f"write a number from 1 to {pairs}, or leave it out"


def refuse_building(name: str, buildings: Iterable[str]) -> tuple[str, str]:
    """Return what is wrong with a building that a stiffness is a multiple of, and what to write."""
    return f"no building '{name}' is defined", nearest(name, buildings)


def check_link_names(root: Map, problems: Problems) -> None:
    """Note the laws, buildings, pairs and keys of links that the study does not have, whatever else is wrong in it.

    root : the tree of the study as written
    """
    sections = (get(root, name) for name in ("laws", "cases", "impact"))
    laws, cases, impact = ([*each] if isinstance(each, Map) else [] for each in sections)
    is_known = get(root, "impact", "law") in (None, *contact_laws(), *laws)
    _check_multiple(root, ("impact", "stiffness"), problems)
    contact = get(root, "impact", "law")
    if impact and isinstance(contact, str) and not is_known:
        problems.at(root, ("impact", "law"), *refuse_contact(contact, laws))
    keys = dict.fromkeys(key for model in link_models().values() for key in fields_of(model))
    for name in cases:
        case = root["cases"][name]
        several = isinstance(case, Map) and isinstance(case.get("links"), Items)
        for path in [("cases", name, "links", n) for n in range(len(case["links"]))] if several else [("cases", name)]:
            _check_entry(root, path, laws, is_known, keys, problems)


def _check_entry(
    root: Map, path: Steps, laws: Sequence[str], is_contact_known: bool, keys: Iterable[str], problems: Problems
) -> None:
    """Note the names that a link as written has and the study does not.

    is_contact_known : whether the law of contact that `impact` names is one; keys : of all laws
    """
    entry = get(root, *path)
    word = entry if isinstance(entry, str) else get(entry, "link")
    is_known = not isinstance(word, str) or word in (*link_laws(), *laws, "none")
    if not is_known:
        problems.at(root, path if isinstance(entry, str) else (*path, "link"), *refuse_law(word, laws))
    if not isinstance(entry, Map):
        return
    if not is_known or (word == Pounding.name and not is_contact_known):
        for key in entry:
            if key not in (*keys, *GONE):  # the keys of a law that is known are looked at where it is read
                problems.at(root, (*path, key), f"unknown key '{key}'", nearest(key, keys), key=True)
    _check_multiple(root, (*path, "stiffness"), problems)
    group, pair = get(root, "group"), entry.get("pair")
    pairs = len(group) - 1 if isinstance(group, list) else 0
    if type(pair) is int and 0 < pairs < pair <= MAX_PAIR:
        problems.at(root, (*path, "pair"), *refuse_pair(pair, pairs))


MAX_PAIR = 19
"""Largest number of a pair of neighbours."""


def _check_multiple(root: Map, path: Steps, problems: Problems) -> None:
    """Note a stiffness that is a multiple of a storey of a building that is not defined."""
    buildings = get(root, "buildings")
    try:
        value = LINK_STIFFNESS.read(get(root, *path))
    except PydanticCustomError:
        return  # told where it is read
    if isinstance(value, StoreyMultiple) and isinstance(buildings, Map) and value.building not in (None, *buildings):
        problems.at(root, path, *refuse_building(str(value.building), buildings))


def links_of(
    case: Case, group: Group, impact: Any, laws: Mapping[str, OwnLaw], path: Steps, root: Any, problems: Problems
) -> tuple[Link, ...] | None:
    """All links of a case, by pair and then from the ground up; None where something is wrong, which is noted."""
    before = len(problems.found)
    links = _Builder(group, impact, laws, root, problems).links(case, path)
    return links if len(problems.found) == before else None


def build_law(
    link: Any, group: Group, impact: Any, laws: Mapping[str, OwnLaw], path: Steps, root: Any
) -> LinkLaw | None:
    """Return the law of a link of a validated case; None for `none`, and where something is wrong with it."""
    return _Builder(group, impact, laws, root, Problems("")).law(link, path)


def content(case: Case, group: Group, impact: Any, laws: Mapping[str, OwnLaw]) -> Any:
    """What the links of a case follow from: it, floors that meet, and what stiffnesses come to; None where they depend
    on more, as links on columns do."""
    if any(group.strikes):
        return None
    try:
        values = tuple(map(group.stiffness, (*_multiples(case), impact.stiffness)))
    except KeyError:
        return None
    floors = tuple(tuple(common.items()) for common in group.common)
    return case, tuple(laws.values()), impact.dashpot, impact.tension_cut, floors, values


def find_losses(link: Any, kind: type[LinkLaw]) -> dict[str, float]:
    """Return damping ratio and coefficient of restitution of a link [-]: one is given, the other follows from it.

    Empty for a law that takes neither. What gives neither has that of a restitution of RESTITUTION.
    """
    ratio, e = getattr(link, "damping_ratio", None), getattr(link, "restitution", None)
    if ratio is not None:
        return {"damping_ratio": ratio, "restitution": restitution_of(ratio)}
    if e is None and not keys_of(kind) & {*LOSSES}:
        return {}
    e = RESTITUTION if e is None else e
    return {"damping_ratio": damping_ratio(e) + 0.0, "restitution": e}  # no negative zero at e = 1


@functools.lru_cache(maxsize=500)
def _multiples(case: Case) -> tuple[Any, ...]:
    """The stiffnesses of a case that are multiples of a storey's."""
    given: list[Any] = [
        value for link in case.links for value in vars(link).values() if isinstance(value, StoreyMultiple)
    ]
    words = (law.stiffness_default for law in link_laws().values() if law.stiffness_default)
    return tuple(dict.fromkeys([*given, *map(LINK_STIFFNESS.read, words)]))


@dataclass(eq=False)
class _Builder:
    """Builds the links of one case; what is wrong is noted in `problems`."""

    group: Group
    impact: Any
    laws: Mapping[str, OwnLaw]
    root: Any
    problems: Problems

    def note(self, path: Steps, message: str, hint: str) -> None:
        self.problems.at(self.root, path, message, hint)

    def links(self, case: Any, path: Steps) -> tuple[Link, ...]:
        """The links of all pairs of neighbours."""
        path, known = (*path, "links"), (*link_laws(), *self.laws, "none")
        for n, link in enumerate(case.links):
            if link.kind not in known:
                self.note((*path, n, "link"), *refuse_law(link.link, self.laws))
        self._check_pairs(case, path)
        found = list[Link]()
        for place, common in enumerate(self.group.common):
            mine = [(n, link) for n, link in enumerate(case.links) if link.pair in (None, place + 1)]
            listed = {floor for _, link in mine if isinstance(link.floors, tuple) for floor in link.floors}
            laws, floors = dict[int, LinkLaw](), dict[int, list[int]]()
            for n, link in mine:
                floors[n] = self._floors(link, place, listed, (*path, n))
                if floors[n] and (law := self.law(link, (*path, n))) is not None:
                    laws[n] = law
            for floor, right in common.items():
                here = [n for n in laws if floor in floors[n]]
                for k, n in enumerate(here):
                    if laws[n] in [laws[other] for other in here[:k]]:
                        message = f"two {laws[n].name} links alike between the same floors"
                        self.note((*path, n), message, "give one, or let them differ")
                    found.append(Link(place, floor, right, laws[n]))
            found += self._at_columns(mine, place, path)
        return tuple(found)

    def _check_pairs(self, case: Any, path: Steps) -> None:
        """Note the pairs that the group does not have."""
        pairs = len(self.group.common)
        for n, link in enumerate(case.links):
            if (link.pair or 0) > pairs:
                self.note((*path, n, "pair"), *refuse_pair(link.pair, pairs))

    def check_places(self, case: Any, path: Steps) -> None:
        """Note the pairs and floors of links that the group does not have."""
        self._check_pairs(case, path)
        for place in range(len(self.group.common)):
            for n, link in enumerate(case.links):
                if link.pair in (None, place + 1):
                    self._floors(link, place, set(), (*path, n))

    def _floors(self, link: Any, place: int, listed: set[int], path: Steps) -> list[int]:
        """The floors of a link between a pair of neighbours.

        listed : those that links of the pair list
        """
        common, is_list = self.group.common[place], isinstance(link.floors, tuple)
        named = link.floors if is_list else getattr(link.floors, "floors", ())
        for k, floor in enumerate(named):
            if floor not in common:
                one, other = self.group.buildings[place : place + 2]
                at = (*path, "floors", *(() if is_list else ("except",)), k)
                message = f"{one.name} and {other.name} have no common floor {floor or BASE}"
                self.note(at, message, f"write floors among {', '.join(str(each or BASE) for each in common)}")
        out = listed if link.floors == "rest" else named
        chosen = list(named) if is_list else [floor for floor in common if floor not in out]
        return chosen if link.at is None else []

    def _at_columns(self, mine: list[Any], place: int, path: Steps) -> list[Link]:
        """The links of slabs that strike columns: those that say so, else those that list no floors."""
        strikes = self.group.strikes[place]
        spoken = [each for each in mine if each[1].at is not None]
        for n, link in spoken:
            self.law(link, (*path, n))
        spoken = spoken or [each for each in mine if not isinstance(each[1].floors, tuple)]
        spoken = [each for each in spoken if each[1].link != "none"]
        if not strikes or not spoken:
            return []
        n, link = spoken[-1] if len(spoken) < 2 else spoken[1]
        if len(spoken) > 1 or link.link != Pounding.name:
            what = "several links" if len(spoken) > 1 else link.kind
            message = f"slabs strike columns here, and {what} between a slab and columns is not modelled"
            hint = "write an entry `{link: pounding, at: columns}`, and `impact: {law: kelvin-voigt}`; or `link: none`"
            at = ("impact", "law") if link.kind != link.link and len(spoken) == 1 else (*path, n, "link")
            self.note(at, message, hint)
        elif isinstance(law := self.law(link, (*path, n)), Pounding):
            return [_on_columns(strike, law, place, self.group) for strike in strikes]
        return []

    def law(self, link: Any, path: Steps) -> LinkLaw | None:
        """The law of a link; None for none, and where something is wrong, which is noted."""
        word = link.kind
        if link.link == "none":
            return None
        if tag_of(link) == FORMULA:
            mine = self.laws.get(word)
            return self._made(lambda: mine(link.gap), path) if mine is not None else None
        kind, impact, stiffness = link_laws()[word], self.impact, getattr(link, "stiffness", None)
        if stiffness is None:
            stiffness = LINK_STIFFNESS.read(kind.stiffness_default) if kind.stiffness_default else impact.stiffness
        cut = getattr(link, "tension_cut", None)
        values: dict[str, Any] = {
            "gap": link.gap,
            "stiffness": stiffness,
            "impact_stiffness": impact.stiffness,
            "dashpot": DashpotLaw(impact.dashpot),
            "tension_cut": impact.tension_cut if cut is None else cut,
            **find_losses(link, kind),
            **{name: getattr(link, name) for name in own(kind)},
        }
        wanted = {name: typed(kind, name, values[name]) for name in kind.parameters() if name in values}
        for name, value in wanted.items():
            try:
                wanted[name] = self.group.stiffness(value)
            except KeyError:
                at = (*path, name) if getattr(link, name, None) is not None else ("impact", "stiffness")
                self.note(at, *refuse_building(value.building, self.group.types))
                return None
        if conflict := kind.conflict(**{name: value for name, value in wanted.items() if isinstance(value, float)}):
            self.note((*path, conflict[0]), *conflict[1:])
            return None
        return self._made(lambda: kind(**wanted), path)

    def _made(self, make: Callable[[], LinkLaw], path: Steps) -> LinkLaw | None:
        try:
            return make()
        except ValueError as error:
            self.note(path, str(error).removeprefix("link: "), "correct it")
            return None


def _on_columns(strike: Strike, law: Pounding, place: int, group: Group) -> Link:
    """The spring of a blow in series with the columns that it bends."""
    struck = group.buildings[place + strike.side]
    assert struck.columns is not None  # of these the share is known
    flexibility = 1.0 / law.stiffness + column_flexibility(struck, strike.storey, strike.at)
    in_series = replace(law, stiffness=1.0 / flexibility)
    ends = strike.left_at, strike.right_at
    return Link(place, strike.left_floor, strike.right_floor, in_series, *ends, struck.columns)
