"""From what people write to what the schema holds: `like:` carried out, the links of a case as one list."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from pounding_cli.laws import KELVIN_VOIGT, link_laws
from pounding_cli.study.file import Items, Map, Mark, Problems, dumped, nearest
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
            rule = Map({"link": full, "gap": 0.0}, entry.mark, {"link": mark, "gap": mark})
    return rule, spoken


# Spellings of before links were one list, and what to write in their place


GONE = ("elsewhere", "by_floor", "pairs", "at_columns")
"""Keys of a case, and `link` with a list."""

_OLD_PLACES = ("link", "floors", *GONE)


def refuse_old(root: Map, problems: Problems) -> None:
    """Note what a study spells as it is no longer read, with the new text."""
    cases = root.get("cases")
    for name, case in cases.items() if isinstance(cases, Map) else ():
        if (key := old_key(case)) is not None:
            what = "a list of links stands under `links:`" if key == "link" else f"'{key}' is no longer read"
            problems.add(case.marks[key][0], what, f"write `{name}: {dumped(respelled(case))}`")
    if root.get("bracket") is not None:
        hint = f"write `sweep: {dumped(bracket_axes(root['bracket']))}`"
        problems.add(root.marks["bracket"][0], "'bracket' is no longer read: it is an option of a sweep", hint)


def old_key(case: Any) -> str | None:
    """The first key of a case that is no longer read; None where there is none."""
    if not isinstance(case, Map) or "links" in case:
        return None
    return next((key for key in case if key in GONE or (key == "link" and isinstance(case[key], Items))), None)


def bracket_axes(given: Any) -> dict[str, Any]:
    """The axes of a sweep that brackets stand for; `impact.stiffness` alone is a quarter of, once and five times the
    default."""
    if not isinstance(given, Mapping):
        given = {"impact.stiffness": [f"{factor} x stiffest storey" for factor in (5, 20, 100)]}
    return {
        key: {"values": values, "middle": values[len(values) // 2]} if isinstance(values, list) and values else values
        for key, values in given.items()
    }


def respelled(case: Mapping[str, Any]) -> dict[str, Any]:
    """A case with its links as one list, which take the other keys of the case; flat where it comes to one link."""
    pairs, links = case.get("pairs"), list[dict[str, Any]]()
    for number, pair in enumerate(pairs if isinstance(pairs, list) else [{}], start=1):
        own, place = _keys_of_link(pair), {"pair": number} if isinstance(pairs, list) else {}
        whole = {**case, **own}
        if own.get("link", case.get("link")) != case.get("link") and "stiffness" not in own:
            whole.pop("stiffness", None)  # that of another law
        more = {key: value for key, value in own.items() if key not in (*_OLD_PLACES, "stiffness")}
        links += [{**link, **place} for link in _of_pair(whole, more)]
    links = [link for n, link in enumerate(links) if link not in links[:n]]
    shared = {key: value for key, value in case.items() if key not in (*_OLD_PLACES, "stiffness")}
    if len(links) < 2:
        return {**links[0], **shared, **links[0]} if links else {"links": ["none"]}
    return {**shared, "links": [link["link"] if list(link) == ["link"] else link for link in links]}


def _keys_of_link(value: Any) -> dict[str, Any]:
    return dict(value) if isinstance(value, Mapping) else {"link": value}


def _list(value: Any) -> list[Any]:
    return list(value) if isinstance(value, list) else [value]


def _of_pair(whole: Mapping[str, Any], more: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """The links of one pair of neighbours.

    whole : the keys around them; more : those of the pair alone
    """
    floors, elsewhere, columns = whole.get("floors", "all"), whole.get("elsewhere"), whole.get("at_columns")
    listed = None if floors == "all" else _list(floors)
    single = {int(floor): each for floor, each in _keys_of_link(whole.get("by_floor")).items() if str(floor).isdigit()}
    for link, own in _links(whole, more, whole.get("link", "none")):
        chosen = listed if own in (None, "all") else _list(own)
        if chosen is None:
            yield {**link, **({"floors": {"except": list(single)}} if single else {})}
        elif mine := [floor for floor in chosen if floor not in single and floor in (listed or chosen)]:
            yield {**link, "floors": mine}
    for floor, each in single.items():
        yield from ({**link, "floors": floor} for link, _ in _links(whole, more, each) if link["link"] != "none")
    if listed is not None and elsewhere not in (None, "none"):
        out = [*listed, *(floor for floor in single if floor not in listed)]
        rest = {"except": out} if "none" in single.values() else "rest"
        yield from ({**link, "floors": rest} for link, _ in _links(whole, more, elsewhere))
    if columns is not None:
        yield from ({**link, "at": "columns"} for link, _ in _links(whole, more, columns))


def _links(whole: Mapping[str, Any], more: Mapping[str, Any], entry: Any) -> Iterator[tuple[dict[str, Any], Any]]:
    """The links of an entry, a word, a mapping, or a list of these, and the floors that each names itself."""
    for one in _list(entry):
        own = _keys_of_link(one)
        keys = {key: value for key, value in own.items() if key not in _OLD_PLACES}
        if "link" not in own:
            if isinstance(whole.get("link"), list):
                keys.pop("stiffness", None)  # beside several links it does not say which it is of
            for link, _ in _links(whole, more, whole.get("link", "none")):
                yield {**link, **keys}, own.get("floors")
        elif own["link"] == "none":
            yield {"link": "none"}, own.get("floors")
        else:
            keys = {**more, **keys}
            if whole.get("link") == own["link"] and "stiffness" in whole:
                keys.setdefault("stiffness", whole["stiffness"])
            yield {"link": own["link"], **keys}, own.get("floors")
