"""A YAML file as a tree of nodes; scalars are read by YAML 1.2 rules, and what is no study is refused at its place.

The tree is built from the parser's events: PyYAML's own composer calls itself for every level, in C without any bound.
"""

from __future__ import annotations

import math
import re
import unicodedata
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import yaml

from pounding_cli.errors import InputError, Problem
from pounding_cli.reading import read_bytes, shortened
from pounding_cli.study.source import Mark, Node
from pounding_cli.texts import CONTROL, plain

MOST_BYTES = 4_000_000
"""Size of a study file [bytes]."""

MOST_VALUES = 100_000
"""Values of a study file, those that aliases repeat included."""

MOST_TOLD = 200
"""Problems after which the rest is not read."""

DEEPEST = 30
"""Levels of a study file."""

MISSING_BLANK = re.compile(r"([\w.-]{1,60}):([^\s:/\\]\S{0,60}.{0,60})\Z")
"""`period:0.60 s`: what YAML takes for one word."""

_LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
_INTEGER = re.compile(r"[-+]?[0-9]+\Z")
# YAML 1.1, as PyYAML reads it, takes 1e10 for text, `no` for false, 0:36 for 36. Here numbers look like it.
_NUMBER = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?\Z")
_LIST = re.compile(r"(?P<key>[\w.-]{1,60}: +)?\[(?P<values>[^\[\]{}]{1,2000})\]\s*\Z")
_UNIT = re.compile(r"[A-Za-z%°µ][\w/^*².() -]{0,30}?(?=\s*(?:[,}\]#\n]|\Z))")
_WORDS: dict[str, Any] = {"": None, "~": None, "null": None, "true": True, "false": False}
_TAGS = {f"tag:yaml.org,2002:{kind}" for kind in ("str", "int", "float", "bool", "null", "map", "seq")} | {"!", None}
_AFTER_COMMA = re.compile(r"[0-9]{1,15}(?:\s{0,9}[A-Za-z%][^,]{0,30})?\Z")


def read_source(path: Path) -> tuple[str, Node]:
    """The text of a YAML file and its tree; raises `InputError` at its place for what is no YAML mapping."""
    text = _read_text(path)
    return text, parse(text, path)


def parse(text: str, path: Path) -> Node:
    """The tree of a YAML text; `path` is what errors call it, which are those of `read_source`."""
    reader = _Reader(path, text)
    try:
        root = reader.document()
    except yaml.MarkedYAMLError as error:
        raise InputError(_syntax(path, error, text)) from None
    except yaml.YAMLError as error:
        hint = "remove control characters; save the file as UTF-8 text"
        raise InputError(Problem(f"this is not YAML: {error}", hint, shortened(path), 1, 1)) from None
    if root is None:
        hint = "see configs/quickstart.yaml for the smallest useful study"
        raise InputError(Problem("the file is empty", hint, shortened(path), 1, 1))
    if not root.is_mapping:
        reader.refuse(root.mark, "a study is a mapping of keys to values", "begin with `title: ...`")
    if reader.problems:
        raise InputError(reader.problems)
    return root


def _read_text(path: Path) -> str:
    shown = shortened(path)
    try:
        return read_bytes(path, MOST_BYTES, "study file").decode("utf-8-sig")
    except FileNotFoundError:
        near = _nearby(path)
        hint = f"did you mean {near}?" if near else "`pound init NAME` writes one"
        raise InputError(Problem("no such file", hint, shown)) from None
    except IsADirectoryError:
        raise InputError(Problem(f"{shown} is a folder", "name the study file in it", shown)) from None
    except UnicodeDecodeError as error:
        line = error.object[: error.start].count(b"\n") + 1
        raise InputError(Problem("the file is not UTF-8 text", "save it as UTF-8", shown, line, 1)) from None
    except InputError:
        raise
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(Problem(f"cannot be read: {reason}", "check the path and its permissions", shown)) from None


def _nearby(path: Path) -> str:
    import difflib

    try:
        names = [p.name for p in path.parent.iterdir() if p.suffix in (".yaml", ".yml")]
    except OSError:
        return ""
    near = difflib.get_close_matches(path.name, names[:1000], 1)
    return shortened(path.parent / near[0]) if near else ""


def _syntax(path: Path, error: yaml.MarkedYAMLError, text: str) -> Problem:
    mark = error.problem_mark or error.context_mark
    line, column = (mark.line + 1, mark.column + 1) if mark else (1, 1)
    what = error.problem or "unreadable"
    begin = error.context_mark.line + 1 if error.context and error.context_mark else line
    if begin != line:
        what += f" ({error.context} that begins in line {begin})"
    lines = text.split("\n")
    if (unit := _unit_behind_list(lines, line, column)) is not None:
        return Problem(*unit, shortened(path), line, column)
    slip = _slip(lines, begin, line, "flow" in str(error.context))
    if slip is not None:
        message, hint, line, column = slip
        return Problem(message, hint, shortened(path), line, column)
    shown = "".join(lines[line - 1 : line])
    indent = shown[: len(shown) - len(shown.lstrip())]
    if "\t" in indent or "\\t" in what:
        hint = "indent with spaces: YAML does not allow tabs"
    elif "mapping values are not allowed" in what:
        hint = "put quotes around a value that holds ': '"
    else:
        hint = "check brackets, quotes, commas and the indentation around this place"
    return Problem(f"this is not YAML: {what}", hint, shortened(path), line, column)


def _unit_behind_list(lines: list[str], line: int, column: int) -> tuple[str, str] | None:
    """Message and hint for `[1, 2] kN/m`, where the reading ended at the unit; None for anything else."""
    before = "\n".join([*lines[max(0, line - 50) : line - 1], "".join(lines[line - 1 : line])[: column - 1]])[-4000:]
    unit = _UNIT.match("".join(lines[line - 1 : line])[column - 1 :])
    found = _LIST.search(before)
    if unit is None or found is None:
        return None
    values = [value.strip() for value in found["values"].split(",")]
    if not all(_NUMBER.match(value.split(" ")[0]) for value in values):
        return None
    whole = ", ".join(f"{value} {unit[0].strip()}" if _NUMBER.match(value) else value for value in values)
    message = f"YAML ends the list at its bracket: '{unit[0].strip()}' behind it belongs to no value"
    return message, f"write the unit at each value: `{found['key'] or ''}[{whole}]`"


def _slip(lines: list[str], begin: int, line: int, in_brackets: bool) -> tuple[str, str, int, int] | None:
    """What was probably done wrong in the lines from `begin` to `line`: message, hint, line and column."""
    for number in range(begin, min(line, begin + 50) + 1):
        text = "".join(lines[number - 1 : number])[:2000]
        place = text.find(" #")
        if in_brackets and place >= 0 and ("}" in text[place:] or "]" in text[place:]):
            message = "a # inside brackets hides the rest of its line, the closing bracket too"
            return message, "move the comment behind the closing bracket", number, place + 2
    for number in (line, line - 1):
        text = "".join(lines[number - 1 : number])[:200]
        found = MISSING_BLANK.match(text.strip().removeprefix("- "))
        if number > 0 and found and not in_brackets:
            column = len(text) - len(text.lstrip()) + 1
            return f"'{found[0]}' lacks a blank after its colon", f"write `{found[1]}: {found[2]}`", number, column
    return None


class _Reader:
    """Turns the events of a parser into `Node`s and collects what is wrong on the way."""

    def __init__(self, path: Path, text: str) -> None:
        self.path, self.text, self.count = path, text, 0
        self.problems: list[Problem] = []
        self.anchors: dict[str, tuple[Node, int, int]] = {}
        self.events: Iterator[Any] = iter(())

    def refuse(self, mark: Mark, message: str, hint: str) -> None:
        self.problems.append(Problem(message, hint, shortened(self.path), *mark))
        if len(self.problems) >= MOST_TOLD:
            raise InputError(self.problems)

    def stop(self, mark: Mark, message: str, hint: str) -> InputError:
        """The problem that ends the reading."""
        return InputError(Problem(message, hint, shortened(self.path), *mark))

    def document(self) -> Node | None:
        """The one document of the text; None where it is empty."""
        self.events = yaml.parse(self.text, Loader=_LOADER)
        root = None
        for event in self.events:
            if isinstance(event, yaml.DocumentStartEvent):
                if root is not None:
                    message = "this is not YAML: expected a single document"
                    raise self.stop(_mark(event), message, "one file holds one study: remove the line `---`")
                root = self.node(next(self.events), 0)
        return root

    def node(self, event: Any, depth: int) -> Node:
        """The node that begins with `event`."""
        mark = _mark(event)
        if isinstance(event, yaml.AliasEvent):
            return self.alias(event, mark, depth)
        self.counted(1, mark)
        if depth > DEEPEST:
            raise self.stop(mark, "the file is nested too deeply", f"a study needs at most {DEEPEST} levels")
        before = self.count
        if event.tag not in _TAGS:
            self.refuse(mark, f"the tag {event.tag} is not used here", "write the plain value")
        if isinstance(event, yaml.ScalarEvent):
            node = Node(self.scalar(event, mark), mark, event.value, quoted=event.style in ("'", '"'))
        elif isinstance(event, yaml.SequenceStartEvent):
            items = []
            while not isinstance(below := next(self.events), yaml.SequenceEndEvent):
                items.append(self.node(below, depth + 1))
            node = Node(items, mark, self.shown(event, below))
        else:
            node = self.mapping(event, mark, depth)
        if event.anchor is not None:
            self.anchors[event.anchor] = (node, self.count - before + 1, _height(node))
        return node

    def alias(self, event: Any, mark: Mark, depth: int) -> Node:
        if event.anchor not in self.anchors:
            message = f"this is not YAML: found undefined alias '{event.anchor}'"
            raise self.stop(mark, message, "put quotes around a value that begins with * or &")
        node, size, height = self.anchors[event.anchor]
        self.counted(size, mark)
        if depth + height > DEEPEST:
            raise self.stop(mark, "the file is nested too deeply", f"a study needs at most {DEEPEST} levels")
        return node

    def counted(self, values: int, mark: Mark) -> None:
        """Count values: aliases can unfold a small file into billions of them."""
        self.count += values
        if self.count > MOST_VALUES:
            hint = "write fewer aliases (*name)" if self.anchors else "a study is far shorter: motions stand in files"
            raise self.stop(mark, f"more than {MOST_VALUES} keys and values", hint)

    def mapping(self, start: Any, mark: Mark, depth: int) -> Node:
        children: dict[str, Node] = {}
        keys: dict[str, Mark] = {}
        last: Any = None
        while not isinstance(event := next(self.events), yaml.MappingEndEvent):
            at = _mark(event)
            word = event.value if isinstance(event, yaml.ScalarEvent) else None
            if word is None:
                self.node(event, depth + 1)
                self.refuse(at, "a key must be a word", "write `key: value`")
            key = canonical(word or "")
            first = next(self.events)
            value = self.node(first, depth + 1)
            if word is None or (value.value is None and _is_plain(event) and self.is_slip(word, event, last)):
                pass
            elif word == "<<" and _is_plain(event):
                self.refuse(at, "merge keys (<<) are not used here", "write `like: NAME` to build on another building")
            elif key in children:
                line, column = keys[key]
                there = f"in line {line}" + (f", column {column}" if line == at[0] else "")
                self.refuse(at, f"'{key}' occurs twice; first {there}", "remove one of the two")
            else:
                children[key], keys[key] = value, at
            last = first
        return Node(children, mark, self.shown(start, event), keys)

    def is_slip(self, word: str, event: Any, last: Any) -> bool:
        """Refuse a key without value that is none: `period:0.6 s`, or the second half of `0,6 s` in {...}."""
        if found := MISSING_BLANK.match(word):
            self.refuse(_mark(event), f"'{word}' lacks a blank after its colon", f"write `{found[1]}: {found[2]}`")
            return True
        if isinstance(last, yaml.ScalarEvent) and _is_plain(last) and _INTEGER.match(last.value):
            begin: Any = last.end_mark
            between = self.text[begin.index : event.start_mark.index]
            if between == "," and _AFTER_COMMA.match(word):
                message = f"'{last.value},{word}' has a decimal comma: inside brackets a comma ends the value"
                self.refuse(_mark(last), message, f"write `{last.value}.{word}`")
                return True
        return False

    def shown(self, start: Any, end: Any) -> str:
        begin, stop = start.start_mark, end.end_mark
        # libyaml counts characters as we do; the pure Python loader too.
        return self.text[begin.index : stop.index] if begin.line == stop.line and stop.index - begin.index < 200 else ""

    def scalar(self, event: Any, mark: Mark) -> Any:
        word = event.value
        if CONTROL.search(word):  # as "\0" or "\e" in quotes
            self.refuse(mark, f"'{plain(word)[:60]}' holds a control character", "write letters, digits and signs")
        if not _is_plain(event):
            return word
        if word.lower() in _WORDS:
            return _WORDS[word.lower()]
        if _INTEGER.match(word) and len(word) < 19:
            return int(word)
        if _NUMBER.match(word):
            number = float(word)
            if math.isinf(number):
                self.refuse(mark, f"{word[:60]} is too large a number", "write a number below 1e308")
            return number
        return word


def canonical(key: str) -> str:
    """A key as it is read: `" gap "` is `gap`, `01` is `1`, and accents are one character each."""
    key = " ".join(unicodedata.normalize("NFC", key).split())
    return key.lstrip("0") or "0" if key.isascii() and key.isdigit() else key


def _is_plain(scalar: Any) -> bool:
    return scalar.style not in ('"', "'", "|", ">")


def _mark(event: Any) -> Mark:
    return event.start_mark.line + 1, event.start_mark.column + 1


def _height(node: Node) -> int:
    """Levels below a node."""
    below = node.value.values() if node.is_mapping else node.value if node.is_list else ()
    return max((1 + _height(child) for child in below), default=0)
