"""Rewrite studies of before links were one list: `python tools/rewrite_study.py FILE...`.

Cases with `elsewhere`, `by_floor`, `pairs`, `at_columns` or a list under `link` get `links:`; `bracket:` becomes an
option of the sweep. Everything else stays as it is written, comments too, but for those in a case that is rewritten.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import yaml

from pounding_cli.errors import InputError
from pounding_cli.study.file import Items, Map, canonical, dumped, parse
from pounding_cli.study.spell import GONE, old_key

_OLD_PLACES = ("link", "floors", *GONE)

LONGEST = 110
"""Characters of a case on one line."""


def rewritten(text: str) -> str:
    """The text of a study in the present spelling.  Raises InputError where it is no YAML mapping."""
    root, tree = parse(text, "study"), yaml.compose(text)
    changes: list[tuple[int, int, str]] = []
    cases = root.get("cases")
    for key, value in _pairs(_value(tree, "cases")) if isinstance(cases, Map) else ():
        case = cases[canonical(key.value)]
        if old_key(case) is not None:
            changes.append(_case(text, key, value, respelled(case)))
    if root.get("bracket") is not None:
        changes += _bracket(text, root, tree)
    for begin, end, new in sorted(changes, reverse=True):
        text = text[:begin] + new + text[end:]
    text = re.sub(r"(\bcases\.[^\s.:,{}]+)\.link\.(\d+)\.", r"\1.links.\2.", text)
    for found in re.finditer(rf"\bcases\.[^\s.:,{{}}]+\.(?:{'|'.join(GONE)})\.\S+", text):
        print(f"  {found[0]} has to be rewritten by hand: it is now a key of an entry of `links`", file=sys.stderr)
    return text


def _pairs(node: Any) -> list[tuple[Any, Any]]:
    return node.value if isinstance(node, yaml.MappingNode) else []


def _value(tree: Any, name: str) -> Any:
    return next((value for key, value in _pairs(tree) if key.value == name), None)


def _case(text: str, key: Any, value: Any, new: dict[str, Any]) -> tuple[int, int, str]:
    begin, end = text.index(":", key.end_mark.index) + 1, _end(value)
    line, column = f" {dumped(new)}", key.start_mark.column
    row_begin = text.rfind("\n", 0, key.start_mark.index) + 1
    if value.flow_style and (len(line) + begin - row_begin <= LONGEST or "{" in text[row_begin : key.start_mark.index]):
        blanks = len(text[begin : value.start_mark.index])
        return begin, end, " " * max(blanks, 1) + line[1:]
    inner = " " * (column + 2)
    rows = [f"{inner}{name}: {dumped(each)}" for name, each in new.items() if name != "links"]
    if "links" in new:
        rows += [f"{inner}links:", *(f"{inner}  - {dumped(link)}" for link in new["links"])]
    return begin, end, "\n" + "\n".join(rows)


def _bracket(text: str, root: Map, tree: Any) -> list[tuple[int, int, str]]:
    axes = bracket_axes(root["bracket"])
    key, value = next(pair for pair in _pairs(tree) if pair[0].value == "bracket")
    begin, end = key.start_mark.index, _end(value)
    sweep = _value(tree, "sweep")
    if sweep is None or (not _pairs(sweep) and not isinstance(root.get("sweep"), Items)):
        rows = "".join(f"\n  {name}: {dumped(axis)}" for name, axis in axes.items())
        return [(begin, end, f"sweep:{rows}")]
    end += text[end : end + 1] == "\n"
    if isinstance(sweep, yaml.SequenceNode):
        rows = "".join(f"\n{' ' * sweep.start_mark.column}- {dumped({name: axis})}" for name, axis in axes.items())
    elif sweep.flow_style:
        rows = "".join(f", {name}: {dumped(axis)}" for name, axis in axes.items())
        return [(begin, end, ""), (sweep.end_mark.index - 1, sweep.end_mark.index - 1, rows)]
    else:
        column = sweep.value[0][0].start_mark.column
        rows = "".join(f"\n{' ' * column}{name}: {dumped(axis)}" for name, axis in axes.items())
    return [(begin, end, ""), (_end(sweep), _end(sweep), rows)]


def _end(node: Any) -> int:
    """Where a value ends; of a block, where its last value does."""
    if isinstance(node, yaml.CollectionNode) and not node.flow_style and node.value:
        last = node.value[-1]
        return _end(last[1] if isinstance(last, tuple) else last)
    return int(node.end_mark.index)


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


def _as_list(value: Any) -> list[Any]:
    return list(value) if isinstance(value, list) else [value]


def _of_pair(whole: Mapping[str, Any], more: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """The links of one pair of neighbours.

    whole : the keys around them; more : those of the pair alone
    """
    floors, elsewhere, columns = whole.get("floors", "all"), whole.get("elsewhere"), whole.get("at_columns")
    listed = None if floors == "all" else _as_list(floors)
    single = {int(floor): each for floor, each in _keys_of_link(whole.get("by_floor")).items() if str(floor).isdigit()}
    for link, own in _links(whole, more, whole.get("link", "none")):
        chosen = listed if own in (None, "all") else _as_list(own)
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
    for one in _as_list(entry):
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


def main(names: list[str]) -> int:
    """Rewrite files in place; 2 where one cannot be read."""
    failed = 0
    for name in names:
        path = Path(name)
        try:
            text = path.read_bytes().decode("utf-8")
            new = rewritten(text)
        except (OSError, UnicodeDecodeError, InputError) as error:
            print(f"{name}: {error}", file=sys.stderr)
            failed = 2
            continue
        if new != text:
            path.write_bytes(new.encode("utf-8"))
            print(f"{name}: rewritten")
    return failed


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
