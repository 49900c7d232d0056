"""Spellings of links and brackets that studies had before `links:` was a list, and what to write in their place."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from pounding_cli.laws import link_laws
from pounding_cli.study.file import Items, Map, Problems, dumped
from pounding_cli.study.laws import LOSSES, keys_of

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
    """A case with its links as one list; flat where it comes to one link."""
    pairs, links = case.get("pairs"), list[dict[str, Any]]()
    for number, pair in enumerate(pairs if isinstance(pairs, list) else [{}], start=1):
        outer = dict(case)
        if not isinstance(pair, Mapping) or pair.get("link", case.get("link")) != case.get("link"):
            outer.pop("stiffness", None)  # that of another law
        whole = outer | _mapping(pair)
        links += [{**link, **({"pair": number} if isinstance(pairs, list) else {})} for link in _of_pair(whole)]
    links = [link for n, link in enumerate(links) if link not in links[:n]]
    return links[0] if len(links) == 1 else {"links": links or [{"link": "none"}]}


def _mapping(value: Any) -> dict[str, Any]:
    return dict(value) if isinstance(value, Mapping) else {"link": value}


def _list(value: Any) -> list[Any]:
    return list(value) if isinstance(value, list) else [value]


def _of_pair(whole: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """The links of one pair of neighbours."""
    floors, elsewhere, columns = whole.get("floors", "all"), whole.get("elsewhere"), whole.get("at_columns")
    listed = None if floors == "all" else _list(floors)
    single = {int(floor): each for floor, each in _mapping(whole.get("by_floor")).items() if str(floor).isdigit()}
    for link, own in _links(whole, whole.get("link", "none")):
        chosen = listed if own in (None, "all") else _list(own)
        if chosen is None:
            yield {**link, **({"floors": {"except": list(single)}} if single else {})}
        elif mine := [floor for floor in chosen if floor not in single and floor in (listed or chosen)]:
            yield {**link, "floors": mine}
    for floor, each in single.items():
        yield from ({**link, "floors": floor} for link, _ in _links(whole, each) if link["link"] != "none")
    if listed is not None and elsewhere not in (None, "none"):
        out = [*listed, *(floor for floor in single if floor not in listed)]
        rest = {"except": out} if "none" in single.values() else "rest"
        yield from ({**link, "floors": rest} for link, _ in _links(whole, elsewhere))
    if columns is not None:
        yield from ({**link, "at": "columns"} for link, _ in _links(whole, columns))


def _links(outer: Mapping[str, Any], entry: Any) -> Iterator[tuple[dict[str, Any], Any]]:
    """The links of an entry with all keys that their laws take, and the floors that each names itself.

    outer : the keys that stand around the entry; entry : a word, a mapping, or a list of these
    """
    for one in _list(entry):
        own = _mapping(one)
        if "link" not in own:
            # A stiffness beside several links does not say which it is of.
            aside = (*_PLACES, "stiffness") if isinstance(outer.get("link"), list) else _PLACES
            for link, _ in _links(outer, outer.get("link", "none")):
                yield {**link, **{key: value for key, value in own.items() if key not in aside}}, own.get("floors")
            continue
        word = own["link"]
        law, found = link_laws().get(str(word)), {"link": word}
        for layer in (own, outer) if word != "none" else ():
            for key, value in layer.items():
                is_loss = key in LOSSES and any(each in found for each in LOSSES)
                is_taken = law is None or key in keys_of(law)
                of_another = key == "stiffness" and layer is outer and outer.get("link") not in (word, one)
                if key not in _PLACES and key not in found and is_taken and not is_loss and not of_another:
                    found[key] = value
        yield found, own.get("floors")
