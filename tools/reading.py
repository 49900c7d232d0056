"""Report how code reads, by room of a package: `python tools/reading.py [FOLDER]`.  A report, not a gate.

FOLDER is `pounding_cli` unless given. The columns:

chars : characters a line of code, without indentation, comments, docstrings and blank lines
wide % : per cent of lines of code beyond 100 columns
tuples : assignments of several values to several names at once, per 1,000 lines of code; swaps are left out
docs : docstrings
what : docstrings that begin with What, Whether, How, Where or Of
bare : functions and classes that are named by a participle or filler word alone

With --names, functions and names that two or more modules define are listed with their places.
"""

from __future__ import annotations

import argparse
import ast
import io
import re
import sys
import tokenize
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field, fields
from pathlib import Path

MAX_COLUMNS = 100
"""Columns of a line that is not wide."""

ROOT_ROOM = "(root)"
"""Room of the modules that stand in the folder itself."""

OPENING = re.compile(r"(What|Whether|How|Where|Of)\b")
"""How a docstring begins that does not say what a function returns or does."""

FILLERS = frozenset({"what", "own", "mine", "same", "few", "at"})
IRREGULAR = frozenset(
    {"told", "said", "found", "shown", "kept", "known", "made", "given", "meant", "begun", "drawn", "written", "sought"}
)
ENDING = re.compile(r"[a-z]+ed")
NOT_PARTICIPLES = frozenset({"feed", "need", "seed", "speed", "shed", "embed", "exceed", "proceed", "succeed"})

Definition = ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef


@dataclass
class Counts:
    """Counts of one room, or of several together."""

    files: int = 0
    lines: int = 0
    code_lines: int = 0
    characters: int = 0
    wide_lines: int = 0
    tuple_assignments: int = 0
    docstrings: int = 0
    openings: int = 0
    bare_names: int = 0

    def add(self, other: Counts) -> None:
        """Add the counts of another room to these."""
        for each in fields(self):
            setattr(self, each.name, getattr(self, each.name) + getattr(other, each.name))


@dataclass
class Report:
    """The counts of every room, and the names that deserve a second look.

    bare_names : place and name of functions and classes named by a participle or filler word alone
    shared_names : modules that define a public name, of names that several define
    """

    rooms: dict[str, Counts] = field(default_factory=dict)
    bare_names: list[tuple[str, str]] = field(default_factory=list)
    shared_names: dict[str, list[str]] = field(default_factory=dict)


def measure_package(folder: Path) -> Report:
    """Return the report of all modules at or below a folder.

    Raises
    ------
    SyntaxError : a module is not Python
    """
    report, modules_of_name = Report(), defaultdict[str, list[str]](list)
    for path in sorted(folder.rglob("*.py")):
        module = path.relative_to(folder)
        text = path.read_text(encoding="utf-8")
        tree = ast.parse(text, str(path))
        room = module.parts[0] if len(module.parts) > 1 else ROOT_ROOM
        counts = report.rooms.setdefault(room, Counts())
        counts.add(count_module(text, tree))
        for node in iter_definitions(tree):
            if is_bare_name(node.name):
                report.bare_names.append((f"{module.as_posix()}:{node.lineno}", node.name))
        for name in find_public_names(tree):
            modules_of_name[name].append(module.as_posix())
    for name, modules in sorted(modules_of_name.items()):
        if len(modules) > 1:
            report.shared_names[name] = modules
    return report


def count_module(text: str, tree: ast.Module) -> Counts:
    """Return the counts of one module."""
    counts = Counts(files=1, lines=len(text.splitlines()))
    for line in iter_code_lines(text, tree):
        counts.code_lines += 1
        counts.characters += len(line.strip())
        counts.wide_lines += len(line) > MAX_COLUMNS
    counts.tuple_assignments = sum(is_tuple_assignment(node) for node in ast.walk(tree))
    for docstring in iter_docstrings(tree):
        counts.docstrings += 1
        counts.openings += bool(OPENING.match(docstring))
    counts.bare_names = sum(is_bare_name(node.name) for node in iter_definitions(tree))
    return counts


def iter_code_lines(text: str, tree: ast.Module) -> Iterator[str]:
    """Yield the lines that hold code, without the comments behind it."""
    lines = text.splitlines()
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT:
            row, column = token.start
            lines[row - 1] = lines[row - 1][:column]
    in_docstrings = find_docstring_lines(tree)
    for number, line in enumerate(lines, start=1):
        if line.strip() and number not in in_docstrings:
            yield line.rstrip()


def find_docstring_lines(tree: ast.Module) -> set[int]:
    """Return the numbers of the lines of docstrings, those below attributes and constants too."""
    found = set[int]()
    for node in ast.walk(tree):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
            found.update(range(node.lineno, (node.end_lineno or node.lineno) + 1))
    return found


def iter_docstrings(tree: ast.Module) -> Iterator[str]:
    """Yield the docstrings of a module, its functions and its classes."""
    for node in (tree, *iter_definitions(tree)):
        docstring = ast.get_docstring(node)
        if docstring:
            yield docstring


def iter_definitions(tree: ast.Module) -> Iterator[Definition]:
    """Yield the functions, methods and classes of a module."""
    for node in ast.walk(tree):
        if isinstance(node, Definition):
            yield node


def is_tuple_assignment(node: ast.AST) -> bool:
    """Return whether a statement assigns several values to several names at once.

    A swap is none: what it assigns are the names that it assigns to.
    """
    if not (isinstance(node, ast.Assign) and isinstance(node.value, ast.Tuple)):
        return False
    targets = [target for target in node.targets if isinstance(target, ast.Tuple)]
    values = sorted(map(ast.unparse, node.value.elts))
    return any(sorted(map(ast.unparse, target.elts)) != values for target in targets)


def is_bare_name(name: str) -> bool:
    """Return whether a name is a participle or a filler word alone."""
    word = name.strip("_").lower()
    if word in FILLERS or word in IRREGULAR:
        return True
    return bool(ENDING.fullmatch(word)) and word not in NOT_PARTICIPLES


def find_public_names(tree: ast.Module) -> set[str]:
    """Return the public names that a module defines at its top level; what it imports is not among them."""
    names = set[str]()
    for node in tree.body:
        if isinstance(node, Definition):
            names.add(node.name)
        elif isinstance(node, ast.Assign | ast.AnnAssign):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            for target in targets:
                names.update(each.id for each in ast.walk(target) if isinstance(each, ast.Name))
    return {name for name in names if not name.startswith("_")}


def format_table(report: Report) -> str:
    """Return the counts as a table of 80 columns, a line a room and one for all together."""
    total = Counts()
    for counts in report.rooms.values():
        total.add(counts)
    head = f"{'room':<18}{'files':>6}{'lines':>8}{'chars':>7}{'wide %':>8}{'tuples':>8}"
    head += f"{'docs':>7}{'what':>7}{'bare':>7}"
    rows = [format_counts(room, counts) for room, counts in sorted(report.rooms.items())]
    return "\n".join([head, *rows, format_counts("all", total)])


def format_counts(room: str, counts: Counts) -> str:
    """Return the line of a room."""
    code_lines = max(counts.code_lines, 1)
    chars = counts.characters / code_lines
    wide = 100 * counts.wide_lines / code_lines
    tuples = 1000 * counts.tuple_assignments / code_lines
    return (
        f"{room:<18.18}{counts.files:>6}{counts.lines:>8}{chars:>7.1f}{wide:>8.1f}{tuples:>8.1f}"
        f"{counts.docstrings:>7}{counts.openings:>7}{counts.bare_names:>7}"
    )


def format_names(report: Report) -> str:
    """Return the names that deserve a second look, with their places."""
    lines = ["", "Participle or filler word alone"]
    lines += [f"  {name}: {place}" for place, name in report.bare_names]
    lines += ["", "Defined in more than one module"]
    for name, modules in report.shared_names.items():
        lines += [f"  {name}", *(f"    {module}" for module in modules)]
    return "\n".join(lines)


def main(arguments: list[str]) -> int:
    """Print the report of a folder; return 2 where there is none."""
    parser = argparse.ArgumentParser(description="Report how code reads, by room of a package.")
    parser.add_argument("folder", nargs="?", type=Path, default=Path("pounding_cli"), help="default: pounding_cli")
    parser.add_argument("--names", action="store_true", help="list the names behind the counts")
    options = parser.parse_args(arguments)
    if not options.folder.is_dir():
        print(f"error: there is no folder {options.folder}", file=sys.stderr)
        return 2
    report = measure_package(options.folder)
    print(format_table(report))
    print(f"public names defined in more than one module: {len(report.shared_names)}")
    if options.names:
        print(format_names(report))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
