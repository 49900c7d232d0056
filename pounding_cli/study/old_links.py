"""Spellings of links and brackets that studies had before `links:` was a list, and what to write in their place."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from pounding_cli.study.file import Items, Map, Problems, dumped

GONE = ("elsewhere", "by_floor", "pairs", "at_columns")
"""Keys of a case, and `link` with a list."""

_PLACES = ("link", "floors", *GONE)


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
        own, place = _mapping(pair), {"pair": number} if isinstance(pairs, list) else {}
        whole = {**case, **own}
        if own.get("link", case.get("link")) != case.get("link") and "stiffness" not in own:
            whole.pop("stiffness", None)  # that of another law
        more = {key: value for key, value in own.items() if key not in _PLACES}
        links += [{**link, **place} for link in _of_pair(whole, more)]
    links = [link for n, link in enumerate(links) if link not in links[:n]]
    shared = {key: value for key, value in case.items() if key not in (*_PLACES, "stiffness")}
    if len(links) < 2:
        return {**links[0], **shared, **links[0]} if links else {"links": ["none"]}
    return {**shared, "links": [link["link"] if list(link) == ["link"] else link for link in links]}


def _mapping(value: Any) -> dict[str, Any]:
    return dict(value) if isinstance(value, Mapping) else {"link": value}


def _list(value: Any) -> list[Any]:
    return list(value) if isinstance(value, list) else [value]


def _of_pair(whole: Mapping[str, Any], more: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """The links of one pair of neighbours.

    whole : the keys around them; more : those of the pair alone
    """
    floors, elsewhere, columns = whole.get("floors", "all"), whole.get("elsewhere"), whole.get("at_columns")
    listed = None if floors == "all" else _list(floors)
    single = {int(floor): each for floor, each in _mapping(whole.get("by_floor")).items() if str(floor).isdigit()}
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
        own = _mapping(one)
        keys = {key: value for key, value in own.items() if key not in _PLACES}
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
