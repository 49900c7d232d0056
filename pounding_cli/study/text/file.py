"""A YAML file as plain dicts and lists that know where everything stands, and problems told at file:line:column."""

from __future__ import annotations

import difflib
import math
import re
import unicodedata
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import islice, pairwise, takewhile
from pathlib import Path
from typing import Any, cast

import yaml

from pounding_cli.errors import InputError, Issue, KeyPath
from pounding_cli.reading import has_signature, read_bytes, shorten_path
from pounding_cli.texts import CONTROL, escape_controls

Mark = tuple[Any, int]
"""Line and column; of Python data the dotted key and 0."""

MAX_BYTES = 4_000_000
"""Largest size of a file [bytes]."""

MAX_VALUES = 100_000
"""Largest number of values of a file, those that aliases repeat included."""

MAX_PROBLEMS = 100
"""Problems of a section that are told one by one."""

MAX_DEPTH = 30
"""Largest number of levels of a file."""

MAX_NEAR = 3
"""Names that a message suggests at most."""

MIN_BEGINNING = 4
"""Characters of a name that a longer word may begin with to be taken for it."""

MAX_SIMILAR = 10
"""Number of similar names from which the most similar one is chosen."""

MIN_SIMILARITY = 0.65
"""Similarity of a word and a name, by difflib, from which a message suggests the name."""

MISSING_BLANK = re.compile(r"([\w.-]{1,60}):([^\s:/\\]\S{0,60}.{0,60})\Z")
_LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
_INTEGER = re.compile(r"[-+]?[0-9]+\Z")
# YAML 1.1, as PyYAML reads it, takes 1e10 for text, `no` for false, 0:36 for 36. Here numbers look like it.
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?\Z")
_AFTER_COMMA = re.compile(r"[0-9]{1,15}(?:\s{0,9}[A-Za-z%][^,]{0,30})?\Z")
_WORDS: dict[str, Any] = {"": None, "~": None, "null": None, "true": True, "false": False}
_TAGS = {f"tag:yaml.org,2002:{kind}" for kind in ("str", "int", "float", "bool", "null", "map", "seq")} | {"!", None}


class Map(dict[str, Any]):
    """A mapping; `mark`: where it begins, `marks`: where each key and its value begin."""

    def __init__(
        self, values: Any = (), mark: Mark = (0, 0), marks: dict[str, tuple[Mark, Mark]] | None = None
    ) -> None:
        super().__init__(values)
        self.mark = mark
        self.marks = marks or {}

    def __str__(self) -> str:
        return f"{{{', '.join(f'{key}: {value}' for key, value in self.items())}}}"

    def take(self, key: str, source: Map, name: str = "") -> None:
        """Take over the value of a key of another mapping, with its place."""
        self[key] = source[name or key]
        self.marks[key] = source.marks[name or key]


class QuotedText(str):
    """A text that stands in quotes."""

    __slots__ = ()


class Real(float):
    """A number that is written as the file writes it."""

    text: str

    def __str__(self) -> str:
        return self.text


class Items(list[Any]):
    """A list; `mark`: where it begins, `marks`: where each item begins."""

    def __init__(self, values: Any = (), mark: Mark = (0, 0), marks: Sequence[Mark] = ()) -> None:
        super().__init__(values)
        self.mark = mark
        self.marks = list(marks)

    def __str__(self) -> str:
        return f"[{', '.join(map(str, self))}]"


def dump_yaml(value: Any, flow: bool = True) -> str:
    """Return a value as YAML: on one line, or in blocks."""
    width = 10**6 if flow else 100
    text: str = yaml.safe_dump(
        _to_yaml_types(value), default_flow_style=flow, sort_keys=False, allow_unicode=True, width=width
    )
    return text.removesuffix("\n").removesuffix("\n...")


def _to_yaml_types(value: Any) -> Any:
    """Return a value in the types of YAML."""
    if isinstance(value, dict):
        return {str(key): _to_yaml_types(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_to_yaml_types(item) for item in value]
    if isinstance(value, str):
        return str.__str__(value)
    if isinstance(value, float):
        return float(value)
    return value


def get(node: Any, *path: str | int) -> Any:
    """Return the value at a path, or None; of a function, in what it makes."""
    node = node() if callable(node) else node
    for step in path:
        if isinstance(node, dict) and str(step) in node:
            node = node[str(step)]
        elif isinstance(node, list) and str(step).isdigit() and int(step) < len(node):
            node = node[int(step)]
        else:
            return None
    return node


def with_value(node: Any, path: Sequence[str], value: Any, mark: Mark) -> Any:
    """Return the same tree with `value` at `path`; mappings are made where they are missing.

    Raises KeyError off the tree.
    """
    if not path:
        return value
    step, *rest = path
    if isinstance(node, Map) or node is None:
        known: Map = Map({}, mark) if node is None else node
        key, old = known.marks.get(step, (mark, mark))
        found = Map(known, known.mark, {**known.marks, step: (key, old if rest else mark)})
        found[step] = with_value(known.get(step), rest, value, mark)
        return found
    if isinstance(node, Items) and step.isdigit() and int(step) < len(node):
        items = Items(node, node.mark, node.marks)
        items[int(step)] = with_value(node[int(step)], rest, value, mark)
        if not rest:
            items.marks[int(step)] = mark
        return items
    raise KeyError(step)


def without_value(node: Any, path: Sequence[str]) -> Any:
    """Return the same tree without the key at a path, which stands in mappings.  Raises KeyError: it is not there."""
    step, *rest = path
    if isinstance(node, Map) and step in node:
        below = {step: without_value(node[step], rest)} if rest else {}
        kept = {key: value for key, value in node.items() if key != step or rest}
        return Map({**kept, **below}, node.mark, node.marks)
    if isinstance(node, Items) and rest and step.isdigit() and int(step) < len(node):
        items = Items(node, node.mark, node.marks)
        items[int(step)] = without_value(node[int(step)], rest)
        return items
    raise KeyError(step)


def locate(root: Any, path: Iterable[str | int], key: bool = False) -> Mark:
    """Return the place where the value (or its key) at `path` begins.

    Steps that the file lacks, as tags of unions, are passed over: a key that a building takes by `like:` gives the
    place of the building, unless `resolve_all_likes` was applied.
    """
    node = root() if callable(root) else root
    mark = own = getattr(node, "mark", (1, 1))
    for step in path:
        if isinstance(node, Map) and str(step) in node:
            own, mark = node.marks[str(step)]
            node = node[str(step)]
        elif isinstance(node, Items) and isinstance(step, int) and step < len(node):
            own = mark = node.marks[step]
            node = node[step]
    return own if key else mark


def read_study(path: Path) -> tuple[str, Map]:
    """The text of a file and its tree.  Raises `InputError` at its place for what is no YAML mapping."""
    shown = shorten_path(path)
    if has_signature(path, b"\x89HDF"):
        hint = "name the study that it was made from; `pound show` prints results"
        raise InputError(Issue((), "this is a results file, not a study", hint, file=shown))
    raw = read_bytes(path, MAX_BYTES, "study file")
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = error.object[: error.start].count(b"\n") + 1
        raise InputError(
            Issue((), "the file is not UTF-8 text", "save it as UTF-8", file=shown, line=line, column=1)
        ) from None
    return text, parse(text, shown)


def parse(text: str, file: str) -> Map:
    """The tree of a text."""
    reader = _Reader(text, file)
    try:
        root, mark = reader.document()
    except yaml.MarkedYAMLError as error:
        raise InputError(_syntax(file, error, text)) from None
    except yaml.YAMLError as error:
        hint = "remove control characters; save the file as UTF-8 text"
        raise InputError(Issue((), f"this is not YAML: {error}", hint, file=file, line=1, column=1)) from None
    if root is None:
        reader.refuse((1, 1), "the file is empty", "begin with a commented study: pound init my-study")
    elif not isinstance(root, Map):
        reader.refuse(mark, "a study is a mapping of keys to values", "begin with `title: ...`")
    reader.problems.check()
    return cast(Map, root)


def parse_value(text: str, source: str) -> Any:
    """Return the tree of a value that stands outside a file.

    source : where it stands, in errors

    Raises
    ------
    InputError : it is not YAML
    """
    reader = _Reader(text, source)
    try:
        value, _ = reader.document()
        reader.problems.check()
    except yaml.YAMLError as error:
        message = error.problem if isinstance(error, yaml.MarkedYAMLError) and error.problem else "unreadable"
        hint = "check its brackets, quotes and commas; put quotes of YAML around a text with signs"
        raise InputError(Issue((), f"the value is not YAML: {message}", hint, file=source)) from None
    except InputError as refused:
        raise InputError([replace(each, line=0, column=0) for each in refused.issues]) from None
    return value


class _Reader:
    """Turns the events of a parser into Maps, Items and scalars of YAML 1.2; notes what is wrong on the way."""

    def __init__(self, text: str, file: str) -> None:
        self.text = text
        self.file = file
        self.count = 0  # of values, with those that aliases repeat
        self.problems = Problems(file)
        self.anchors: dict[str, tuple[Any, Mark, int, int]] = {}
        self.events: Iterator[Any] = yaml.parse(text, Loader=_LOADER)

    def refuse(self, mark: Mark, message: str, hint: str, last: bool = False) -> None:
        """Note a problem.  Raises InputError where it is the last one, or there are too many."""
        self.problems.add(mark, message, hint)
        if last or len(self.problems.found) > 2 * MAX_PROBLEMS:
            self.problems.check()

    def document(self) -> tuple[Any, Mark]:
        """Return the tree of the text and where it begins."""
        root: tuple[Any, Mark] = (None, (1, 1))
        for event in self.events:
            if isinstance(event, yaml.DocumentStartEvent):
                if root[0] is not None:
                    hint = "one file holds one study: remove the line `---`"
                    self.refuse(_mark(event), "this is not YAML: expected a single document", hint, last=True)
                root = self.node(next(self.events), 0)
        return root

    def node(self, event: Any, depth: int) -> tuple[Any, Mark]:
        """Return the value that begins with an event, and where it stands."""
        mark = _mark(event)
        if isinstance(event, yaml.AliasEvent):
            if event.anchor not in self.anchors:
                hint = "put quotes around a value that begins with * or &"
                self.refuse(mark, f"this is not YAML: found undefined alias '{event.anchor}'", hint, last=True)
            value, mark, size, height = self.anchors[str(event.anchor)]
            self.count_values(size, mark, depth + height)
            return value, mark
        self.count_values(1, mark, depth)
        before = self.count
        if event.tag not in _TAGS:
            self.refuse(mark, f"the tag {event.tag} is not used here", "write the plain value")
        if isinstance(event, yaml.ScalarEvent):
            value = self.scalar(event, mark)
        elif isinstance(event, yaml.SequenceStartEvent):
            value = Items((), mark)
            events = []
            while not isinstance(below := next(self.events), yaml.SequenceEndEvent):
                item, at = self.node(below, depth + 1)
                value.append(item)
                value.marks.append(at)
                events.append(below)
            self.refuse_decimal_commas(events)
        else:
            value = self.mapping(mark, depth)
        if event.anchor is not None:
            self.anchors[event.anchor] = value, mark, self.count - before + 1, _height(value)
        return value, mark

    def count_values(self, values: int, mark: Mark, depth: int) -> None:
        """Count values; refuse too many of them, and too many levels."""
        self.count += values
        if self.count > MAX_VALUES:
            hint = "write fewer aliases (*name)" if self.anchors else "a study is far shorter: motions stand in files"
            self.refuse(mark, f"more than {MAX_VALUES} keys and values", hint, True)
        if depth > MAX_DEPTH:
            self.refuse(mark, "the file is nested too deeply", f"a study needs at most {MAX_DEPTH} levels", True)

    def mapping(self, mark: Mark, depth: int) -> Map:
        """Return the mapping whose events come next."""
        found = Map((), mark)
        last: Any = None
        while not isinstance(event := next(self.events), yaml.MappingEndEvent):
            at = _mark(event)
            word = event.value if isinstance(event, yaml.ScalarEvent) else None
            if word is None:
                self.node(event, depth + 1)
                self.refuse(at, "a key must be a word", "write `key: value`")
            key = canonical(word or "")
            first = next(self.events)
            value, there = self.node(first, depth + 1)
            if word is None:
                pass
            elif value is None and self.is_decimal(last, event):
                self.refuse_decimal(last, event)
            elif value is None and _is_plain(event) and (slip := MISSING_BLANK.match(word)):
                self.refuse(at, f"'{word}' needs a space after its colon", f"write `{slip[1]}: {slip[2]}`")
            elif word == "<<" and _is_plain(event):
                self.refuse(at, "merge keys (<<) are not used here", "write `like: NAME` to build on another building")
            elif key in found:
                line, column = found.marks[key][0]
                self.refuse(at, f"'{key}' occurs twice; first at {line}:{column}", "remove one of the two")
            else:
                found[key] = value
                found.marks[key] = (at, there)
            last = first
        return found

    def is_decimal(self, before: Any, after: Any) -> bool:
        """Return whether two scalars are the halves of a number with a decimal comma, `0,36 s`, in brackets."""
        if not (isinstance(before, yaml.ScalarEvent) and isinstance(after, yaml.ScalarEvent)):
            return False
        between = self.text[_index(before.end_mark) : _index(after.start_mark)]
        are_plain = _is_plain(before) and _is_plain(after)
        is_number = _INTEGER.match(before.value) and _AFTER_COMMA.match(after.value)
        return are_plain and bool(is_number) and between == ","

    def refuse_decimal(self, before: Any, after: Any) -> None:
        """Refuse a number with a decimal comma."""
        message = f"'{before.value},{after.value}' has a decimal comma: inside brackets a comma ends the value"
        hint = f"write `{before.value}.{after.value}`, or a blank after the comma of two values"
        self.refuse(_mark(before), message, hint)

    def refuse_decimal_commas(self, events: list[Any]) -> None:
        """Refuse the numbers of a list that have decimal commas: a number without a unit before one that has it, or
        pairs of numbers that are nearer to each other than to the next pair."""
        pairs = list(pairwise(events))
        tight = [self.is_decimal(*pair) for pair in pairs]
        are_in_pairs = len(events) >= 4 and len(events) % 2 == 0 and tight == [n % 2 == 0 for n in range(len(pairs))]
        for (before, after), is_tight in zip(pairs, tight, strict=True):
            has_unit = is_tight and not _INTEGER.match(after.value)
            if has_unit or (is_tight and are_in_pairs):
                self.refuse_decimal(before, after)

    def scalar(self, event: Any, mark: Mark) -> Any:
        """Return the value of a scalar, by the rules of YAML 1.2."""
        word = event.value
        if CONTROL.search(word):
            self.refuse(
                mark, f"'{escape_controls(word)[:60]}' holds a control character", "write letters, digits and signs"
            )
        if not _is_plain(event):
            return QuotedText(word) if event.style in ("'", '"') else word
        if word.lower() in _WORDS:
            return _WORDS[word.lower()]
        if _INTEGER.match(word) and len(word) < 19:
            return int(word)
        if _FLOAT.match(word):
            if math.isinf(float(word)):
                self.refuse(mark, f"{word[:60]} is too large a number", "write a number below 1e308")
            number = Real(word)
            number.text = word
            return number
        return word


def canonical(key: str) -> str:
    """Return a key as it is read: `" gap "` is `gap`, `01` is `1`, and accents are one character each."""
    key = " ".join(unicodedata.normalize("NFC", key).split())
    return key.lstrip("0") or "0" if key.isascii() and key.isdigit() else key


def _is_plain(scalar: Any) -> bool:
    return scalar.style not in ('"', "'", "|", ">")


def _index(mark: Any) -> int:
    """Return the place of a mark in the text, in characters."""
    return int(mark.index)


def _mark(event: Any) -> Mark:
    return event.start_mark.line + 1, event.start_mark.column + 1


def _height(node: Any) -> int:
    """Return the number of levels below a value."""
    below: Iterable[Any] = ()
    if isinstance(node, dict):
        below = node.values()
    elif isinstance(node, list):
        below = node
    return max((1 + _height(child) for child in below), default=0)


def _syntax(file: str, error: yaml.MarkedYAMLError, text: str) -> Issue:
    """Return the problem of a text that is no YAML, with the slip that it comes from where that is known."""
    mark = error.problem_mark or error.context_mark
    line, column = (mark.line + 1, mark.column + 1) if mark else (1, 1)
    message = error.problem or "unreadable"
    lines = text.split("\n")
    if error.context and error.context_mark and error.context_mark.line + 1 != line:
        message += f" ({error.context} that begins in line {error.context_mark.line + 1})"
    for number in () if "flow" in str(error.context) else (line, line - 1):
        row = "".join(lines[number - 1 : number])[:200] if number > 0 else ""
        if slip := MISSING_BLANK.match(row.strip().removeprefix("- ")):
            message = f"'{slip[0]}' needs a space after its colon"
            indent = len(row) - len(row.lstrip())
            return Issue((), message, f"write `{slip[1]}: {slip[2]}`", file=file, line=number, column=indent + 1)
    hint = "check brackets, quotes, commas, indentation and # around this place; a # hides the rest of its line"
    if "\t" in message or "".join(lines[line - 1 : line]).lstrip(" ").startswith("\t"):
        hint = "indent with spaces: YAML does not allow tabs"
    elif "mapping values are not allowed" in message:
        hint = "put quotes around a value that holds ': '"
    return Issue((), f"this is not YAML: {message}", hint, file=file, line=line, column=column)


def place_issue(tree: Any, file: str, issue: Issue) -> Issue:
    """Return an issue at the line and column that a file has it at; one of another file stands where it does."""
    if issue.is_placed:
        return issue
    line, column = locate(tree, issue.path, issue.at_key)
    return _put_at(issue, (line, column + issue.offset), file)


def _put_at(issue: Issue, mark: Mark, file: str) -> Issue:
    """Return an issue at a line and column of a file, or at a key of Python data."""
    line, column = mark
    message = issue.message
    if isinstance(line, str):  # which names the key that the message begins with
        message = message.removeprefix(f"{line.split('.')[-1]}: ")
        return Issue((), message, issue.hint, file=line, code=issue.code)
    return Issue((), message, issue.hint, file=file, line=line, column=column, code=issue.code)


class Problems:
    """Collects problems of one file; two at one place with one message count once."""

    def __init__(self, file: str) -> None:
        self.file = file
        self.found: dict[Issue, Any] = {}

    def add(self, mark: Mark, message: str, hint: str = "") -> None:
        """Note a problem at a line and column, or at a key of Python data."""
        self.extend([_put_at(Issue((), message, hint), mark, self.file)])

    def add_at(self, root: Any, path: KeyPath, message: str, hint: str = "", key: bool = False) -> None:
        """Note a problem with the value (or the key) at `path`."""
        self.add(locate(root, path, key), message, hint)

    def extend(self, problems: Iterable[Issue]) -> None:
        """Note problems found elsewhere."""
        self.found |= dict.fromkeys(problems)

    def add_issue(self, tree: Any, issue: Issue) -> None:
        """Note an issue at the line and column that the file has it at."""
        self.extend([place_issue(tree, self.file, issue)])

    def check(self) -> None:
        """Raise `InputError` with everything noted, in the file's order, if anything was."""
        if self.found:
            ordered = sorted(self.found, key=lambda p: (p.file, p.line, p.column))
            if (more := len(ordered) - 2 * MAX_PROBLEMS) > 0:
                ordered[2 * MAX_PROBLEMS :] = [
                    Issue((), f"and {more} more problems", "correct these first", file=self.file)
                ]
            raise InputError(ordered)


def nearest(word: Any, names: Iterable[str]) -> str:
    """Return a hint with the names nearest to a word, and all of them."""
    known = [str(name)[:60] for name in islice(names, 1000)]
    listed = ", ".join(known[:40]) + (", ..." if len(known) > 40 else "")
    near = _find_near(str(word)[:60], known)
    quoted = [f"'{name}'" for name in near]
    *most, last = quoted or [""]
    question = f"did you mean {', '.join(most)} or {last}? " if most else f"did you mean {last}? "
    return (question if near else "") + (f"known: {listed}" if known else "none is defined")


def _find_near(word: str, known: Sequence[str]) -> list[str]:
    """Return the names nearest to a word, three at most: those that begin with it, those that it begins with, or the
    most similar one; among equally similar names the one with the longest common beginning."""
    begin = word.lower()
    if len(begin) > 1:
        longer = [name for name in known if name.lower().startswith(begin)]
        if 0 < len(longer) <= MAX_NEAR:
            return longer
    shorter = [name for name in known if len(name) >= MIN_BEGINNING and begin.startswith(name.lower())]
    if shorter:
        return [max(shorter, key=len)]
    similar = difflib.get_close_matches(word, known, MAX_SIMILAR, MIN_SIMILARITY)

    def rank(name: str) -> tuple[float, int]:
        """Return the similarity of a name, and the length of its common beginning with the word."""
        common = takewhile(lambda pair: pair[0] == pair[1], zip(name, word, strict=False))
        return difflib.SequenceMatcher(None, name, word).ratio(), len(list(common))

    return [max(similar, key=rank)] if similar else []


_MARKS = {
    "run": ("records", "buildings", "group", "cases"),
    "connector": ("first", "second", "connector", "frequencies"),
    "wall": ("wall", "frame", "striker", "concrete", "mesh"),
}
"""Top-level keys that only the studies of these commands have."""


def kind_of(root: Any, unclear: str = "run") -> str:
    """The command that takes a study, such as "run" or "wall"; `unclear` where the keys do not tell."""
    keys = set(root)
    return next((name for name, own in _MARKS.items() if not keys.isdisjoint(own)), unclear)


def kind_of_file(path: Path) -> str:
    """As `kind_of`, for a file.  Raises `InputError` where it cannot be read."""
    return kind_of(read_study(path)[1])


def refuse_other_kinds(root: Any, file: str, own: str = "run") -> None:
    """Raise `InputError` with the right command where a study is not one of `pound {own}`."""
    if (command := kind_of(root, own)) != own:
        raise InputError(Issue((), f"is a study of `pound {command}`", f"write `pound {command} {file}`", file=file))
