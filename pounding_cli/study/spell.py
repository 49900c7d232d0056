"""From what people write to what the schema holds: `like:` carried out, the links of a case as one list."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from pounding_cli.laws import KELVIN_VOIGT, link_laws
from pounding_cli.study.file import Items, Map, Mark, Problems, nearest
from pounding_cli.study.laws import LOSSES, POUNDING, SHARED, keys_of, kind_of
from pounding_cli.study.models import BASE_SHEAR

CODE = frozenset({"code", "zone", "soil", "importance", "Rw", "K"})
"""Keys of a yield that speak of a code."""

Sides = tuple[frozenset[str], frozenset[str]]
ALTERNATIVES: dict[str, tuple[Sides, ...]] = {
    "building": (
        (frozenset({"stiffness"}), frozenset({"period", "taper"})),
        (frozenset({"yield_shear"}), frozenset({"yield"})),
        (frozenset({"rayleigh"}), frozenset({"damping"})),
    ),
    "yield": ((frozenset({"K"}), frozenset({"Rw"})), (BASE_SHEAR, CODE)),
}
"""Keys of which one mapping may give one side only; an inherited key is replaced by its alternative."""


def _alternatives(kind: str, stiffness: Any) -> tuple[Sides, ...]:
    """Those of a mapping; a `stiffness` that is itself made from a period takes the taper."""
    pairs = ALTERNATIVES.get(kind, ())
    if kind == "building" and isinstance(stiffness, Map):
        return ((frozenset({"stiffness"}), frozenset({"period"})), *pairs[1:])
    return pairs


def inherited(buildings: Any, problems: Problems) -> Any:
    """The buildings with every `like:` carried out; those that lead to unknown names or in circles are noted and left
    out."""
    if not isinstance(buildings, Map):
        return buildings
    own = dict(buildings)
    done: dict[str, Any] = {}
    for name in own:
        for each in reversed(_chain(name, own, done, problems)):
            like = like_of(own[each])
            if like is None:
                done[each] = own[each]
            elif like in done:
                done[each] = _merged(done[like], own[each], "building")
    return Map({name: done[name] for name in own if name in done}, buildings.mark, buildings.marks)


def like_of(building: Any) -> str | None:
    """The building that one is like, which a number may name too; None where it stands on its own."""
    like = building.get("like") if isinstance(building, Map) else None
    return str(like) if isinstance(like, str | int | float) and not isinstance(like, bool) else None


def _chain(name: str, own: dict[str, Any], done: dict[str, Any], problems: Problems) -> list[str]:
    """A building, the one it is like, and so on, up to one that stands on its own or is done."""
    chain: list[str] = []
    while name not in done:
        chain.append(name)
        like = like_of(own[name])
        if like is None:
            break
        mark = own[name].marks["like"][1]
        if like not in own:
            known = [other for other in own if other != name]
            problems.add(mark, f"like: no building '{like}' is defined", nearest(like, known))
            break
        if like in chain:
            shown = " -> ".join((*chain[-5:], like))
            problems.add(mark, f"like: is circular: {shown}", "let one of them stand on its own")
            break
        name = like
    return chain


def _merged(parent: Any, child: Any, kind: str = "") -> Any:
    """`child` over `parent`, mapping by mapping; lists and scalars are replaced whole."""
    if not (isinstance(parent, Map) and isinstance(child, Map)):
        return child
    gone = {"like"}
    for one, other in _alternatives(kind, child.get("stiffness") or parent.get("stiffness")):
        gone |= other if child.keys() & one else set()
        gone |= one if child.keys() & other else set()
    found = Map((), child.mark)
    for key in parent:
        if key not in gone:
            found.take(key, parent)
    for key in child:
        own = _merged(found[key], child[key], key) if key in found else child[key]
        found.take(key, child)
        found[key] = own
    return found


# Links


PLACES = ("link", "links", "floors", "pair", "at")
"""Keys of a link that say which it is and where it stands."""


def links_of(case: Any, impact: Any, laws: Any = None) -> Any:
    """A case with its links as one list of whole mappings: each with the keys of the case and of `impact` that its law
    takes. A word stands for `link: word`; laws : the study's own."""
    own = laws if isinstance(laws, Map) else ()
    if not isinstance(case, Map):
        return case
    mark, several = case.mark, isinstance(case.get("links"), Items)
    if "links" in case and not several:
        return Map({"links": case["links"]}, mark, {"links": case.marks["links"]})
    if not several:
        entries: list[tuple[Any, Mark]] = [(case, mark)]
    else:
        entries = list(zip(case["links"], case["links"].marks, strict=True))
    found = Items((), case.marks["links"][1] if several else mark)
    used = {"links"}
    for entry, at in entries:
        rule, spoken = _whole(_mapping(entry, at), case if several else None, impact, own)
        used |= spoken
        found.append(rule)
        found.marks.append(at)
    whole = Map({"links": found}, mark, {"links": case.marks.get("links", (mark, mark))})
    for key in case if several and found else ():
        if key not in used:
            whole.take(key, case)  # nobody's key: it is refused there
    return whole


def _mapping(value: Any, mark: Mark) -> Any:
    if isinstance(value, str):
        return Map({"link": value}, mark, {"link": (mark, mark)})
    return value


def _whole(entry: Any, case: Map | None, impact: Any, own: Iterable[str]) -> tuple[Any, set[str]]:
    """One link with every key that speaks of it, and the keys of the case that do."""
    if not isinstance(entry, Map):
        return entry, set()
    word = entry.get("link")
    word = str(word) if isinstance(word, int | float) and not isinstance(word, bool) else word
    contact = impact.get("law", KELVIN_VOIGT) if isinstance(impact, Map) else KELVIN_VOIGT
    full = f"{word} of {contact}" if word == POUNDING and contact != KELVIN_VOIGT else word
    law = link_laws().get(str(contact if full != word else word))
    takes = keys_of(law) if law else set() if word == "none" else {"gap"}
    rule = Map((), entry.mark)
    for key in entry:
        if word != "none" or key not in SHARED:  # what else a link says means nothing where there is none
            rule.take(key, entry)
    of_case = takes - {"stiffness", *PLACES}  # a stiffness beside several links does not say which it is of
    of_impact = takes - {"stiffness"} if law is not None and law.subtracts_gap else takes & {*LOSSES, "tension_cut"}
    layers: list[tuple[Any, set[str]]] = [(case, of_case), (impact, of_impact)]
    for layer, keys in layers:
        aside = LOSSES if any(one in rule for one in LOSSES) else ()
        for key in layer if isinstance(layer, Map) else ():
            if key in keys and key not in rule and key not in aside:
                rule.take(key, layer)
    spoken = {key for key in case or () if key in of_case}
    if word is not None:
        rule["link"] = full
        if isinstance(full, str) and kind_of(full) not in (*link_laws(), "none", *own):
            mark = entry.marks["link"]  # that nobody knows this law is told where links are built
            places = {key: entry[key] for key in ("floors", "pair", "at") if key in entry}
            marks = {key: entry.marks[key] for key in places}
            unknown = {"link": full, "gap": 0.0, **places}
            rule = Map(unknown, entry.mark, {"link": mark, "gap": mark, **marks})
    return rule, spoken


# Spellings of before links were one list


GONE = {
    "elsewhere": "links: [{link: pounding, floors: [3, 5]}, {link: infill, floors: rest}]",
    "by_floor": "links: [{link: pounding, floors: {except: [2]}}, {link: infill, floors: 2}]",
    "pairs": "links: [{link: pounding, pair: 1}, {link: infill, pair: 2}]",
    "at_columns": "links: [pounding, {link: pounding, at: columns}]",
}
"""Keys of a case that are no longer read, each with an example of what is written in its place."""

_LISTED = "links: [pounding, {link: infill, floors: [3, 5]}]"
_BRACKETED = "sweep: {impact.restitution: {values: [0.4, 0.5, 0.6], middle: 0.5}}"


def refuse_old(root: Map, problems: Problems) -> None:
    """Note what a study spells as it is no longer read, with how it is written now."""

    def refuse(holder: Map, key: str, what: str, example: str) -> None:
        hint = f"write it so: `{example}`, or let `python tools/rewrite_study.py FILE` rewrite the study"
        problems.add(holder.marks[key][0], what, hint)

    cases = root.get("cases")
    for case in cases.values() if isinstance(cases, Map) else ():
        if (key := old_key(case)) == "link":
            refuse(case, key, "a list of links stands under `links:`", _LISTED)
        elif key is not None:
            refuse(case, key, f"'{key}' is no longer read: it is an entry of `links:`", GONE[key])
    if root.get("bracket") is not None:
        refuse(root, "bracket", "'bracket' is no longer read: it is an option of a sweep", _BRACKETED)


def old_key(case: Any) -> str | None:
    """The first key of a case that is no longer read; None where there is none."""
    if not isinstance(case, Map) or "links" in case:
        return None
    return next((key for key in case if key in GONE or (key == "link" and isinstance(case[key], Items))), None)
