"""Spellings of links and brackets that studies had before `links:` was a list, and what to write in their place."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import yaml
from pydantic_core import PydanticCustomError

from pounding_cli.laws import link_laws
from pounding_cli.study.file import Items, Map, Problems, get
from pounding_cli.study.laws import LOSSES, keys_of
from pounding_cli.study.quantity import LINK_STIFFNESS, Storey

GONE = ("elsewhere", "by_floor", "pairs", "at_columns")
"""Keys of a case, and `link` with a list."""

_PLACES = ("link", "floors", *GONE)
Layers = list[dict[str, Any]]


def refuse_old(root: Map, problems: Problems) -> set[str]:
    """Note what a study spells as it is no longer read, with the new text; returns the cases that do."""
    found = set()
    cases = root.get("cases")
    for name, case in cases.items() if isinstance(cases, Map) else ():
        if (key := old_key(case)) is not None:
            found.add(name)
            what = "a list of links stands under `links:`" if key == "link" else f"'{key}' is no longer read"
            problems.add(case.marks[key][0], what, f"write `{name}: {flow(respelled(case))}`")
    if root.get("bracket") is not None:
        hint = f"write `sweep: {flow(bracket_axes(root['bracket'], root))}`"
        problems.add(root.marks["bracket"][0], "'bracket' is no longer read: it is an option of a sweep", hint)
    return found


def old_key(case: Any) -> str | None:
    """The first key of a case that is no longer read; None where there is none."""
    if not isinstance(case, Map) or "links" in case:
        return None
    return next((key for key in case if key in GONE or (key == "link" and isinstance(case[key], Items))), None)


def flow(value: Any) -> str:
    """A value on one line, as a study writes it."""
    return (
        yaml.safe_dump(_plain(value), default_flow_style=True, sort_keys=False, width=10**6)
        .strip()
        .removesuffix("\n...")
    )


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return str.__str__(value) if isinstance(value, str) else float(value) if isinstance(value, float) else value


def bracket_axes(given: Any, root: Any = None) -> dict[str, Any]:
    """The axes of a sweep that brackets stand for; `impact.stiffness` alone is a quarter of, once and five times the
    study's own."""
    if not isinstance(given, Mapping):
        own = get(root, "impact", "stiffness")
        try:
            value = LINK_STIFFNESS.read("20 x stiffest storey" if own is None else own)
        except PydanticCustomError:
            value = 1e9
        low, high = (
            str(replace(value, factor=value.factor * share)) if isinstance(value, Storey) else value * share
            for share in (0.25, 5)
        )
        given = {"impact.stiffness": [low, str(value) if isinstance(value, Storey) else own or value, high]}
    return {
        key: {"values": values, "middle": values[len(values) // 2]} if isinstance(values, list) and values else values
        for key, values in given.items()
    }


def respelled(case: Mapping[str, Any]) -> dict[str, Any]:
    """A case with its links as one list; flat where it comes to one link."""
    links = [link for place, layers in _pairs(case) for link in _of_pair(layers, place)]
    links = [link for n, link in enumerate(links) if link not in links[:n]]
    common = {key: value for key, value in case.items() if key not in (*_PLACES, "stiffness")}
    common = {key: value for key, value in common.items() if any(_takes(link, key) for link in links)}
    for key in [key for key in common if all(key in link for link in links if _takes(link, key))]:
        del common[key]
    if len(links) == 1:
        return {**{"link": "none"}, **common, **links[0]}
    words = [next(iter(link.values())) if list(link) == ["link"] else link for link in links]
    return {**common, "links": words or ["none"]}


def _takes(link: Mapping[str, Any], key: str) -> bool:
    law = link_laws().get(str(link.get("link")))
    return key in keys_of(law) if law is not None else link.get("link") != "none"


def _pairs(case: Mapping[str, Any]) -> Iterator[tuple[dict[str, Any], Layers]]:
    pairs = case.get("pairs")
    if not isinstance(pairs, list):
        yield {}, [dict(case)]
        return
    for number, entry in enumerate(pairs, start=1):
        yield {"pair": number}, [_mapping(entry), dict(case)]


def _mapping(value: Any) -> dict[str, Any]:
    return dict(value) if isinstance(value, Mapping) else {"link": value}


def _says(layers: Layers, key: str, default: Any = None) -> Any:
    return next((layer[key] for layer in layers if key in layer), default)


def _of_pair(layers: Layers, place: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """The links of one pair of neighbours."""
    floors, elsewhere, columns = _says(layers, "floors", "all"), _says(layers, "elsewhere"), _says(layers, "at_columns")
    single = _says(layers, "by_floor") if isinstance(_says(layers, "by_floor"), Mapping) else {}
    apart = [int(floor) for floor in single if str(floor).isdigit()]
    listed = None if floors == "all" else floors if isinstance(floors, list) else [floors]
    inside = [floor for floor in listed or () if floor not in apart]
    for many in _listed(layers):
        own = many[0].get("floors") if many[0] not in layers else None
        if own is not None and own != "all":
            chosen = [
                f
                for f in (own if isinstance(own, list) else [own])
                if f not in apart and (listed is None or f in listed)
            ]
        elif listed is not None:
            chosen = inside
        else:
            yield _link(many, {**place, **({"floors": {"except": apart}} if apart else {})})
            continue
        if chosen:
            yield _link(many, {**place, "floors": chosen})
    for floor in apart:
        for many in _listed([_mapping(single.get(str(floor), single.get(floor))), *layers]):
            if (link := _link(many, {**place, "floors": floor}))["link"] != "none":
                yield link
    if listed is not None and elsewhere not in (None, "none"):
        out = list(dict.fromkeys([*listed, *apart]))
        rest: Any = (
            "rest"
            if not any(floor in apart and single.get(str(floor)) == "none" for floor in apart)
            else {"except": out}
        )
        for many in _listed([_mapping(elsewhere), *layers]):
            yield _link(many, {**place, "floors": rest})
    if columns is not None:
        for many in _listed([_mapping(columns), *layers]):
            yield _link(many, {**place, "at": "columns"})


def _listed(layers: Layers) -> list[Layers]:
    """The layers of every link where `link` is a list, the nearest first."""
    place = next((n for n, layer in enumerate(layers) if "link" in layer), None)
    if place is None or not isinstance(layers[place]["link"], list):
        return [layers]
    return [
        [_mapping(word), *layers[:place], {**layers[place], "link": None}, *layers[place + 1 :]]
        for word in layers[place]["link"]
    ]


def _link(layers: Layers, place: dict[str, Any]) -> dict[str, Any]:
    """One link with the keys of its own, those of the case only where they would not be taken from there."""
    word = next((layer["link"] for layer in layers if layer.get("link") is not None), "none")
    found = {"link": word, **place}
    if word == "none":
        return found
    law, last = link_laws().get(str(word)), len(layers) - 1
    for n, layer in enumerate(layers):
        named = next((one["link"] for one in layers[n:] if one.get("link") is not None), None)
        for key, value in layer.items():
            if key in _PLACES or key in found or (law is not None and key not in keys_of(law)):
                continue
            if key in LOSSES and any(one in found for one in LOSSES):
                continue
            if key == "stiffness" and named != word:
                continue
            if n < last or key == "stiffness":
                found[key] = value
    return found
