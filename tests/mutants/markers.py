"""Where a fault is put: places in the source that carry `# fault: NAME`, at the end of a line or alone above it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

MARKER = re.compile(r"\s*# fault: ([a-z0-9-]+)$")
SOURCE = "pounding_cli"


class Place(NamedTuple):
    """A marked line: the file from the project's root, and the line's number from 0."""

    file: str
    line: int


def markers(root: Path) -> Iterator[tuple[str, Place]]:
    """Every marker in the source with the line of code that it marks, by file and line."""
    for path in sorted((root / SOURCE).rglob("*.py")):
        lines = path.read_text(encoding="utf-8").splitlines()
        for number, line in enumerate(lines):
            if found := MARKER.search(line):
                alone = found.start() == 0
                yield found[1], Place(path.relative_to(root).as_posix(), number + alone)


def mutated(text: str, line: int, becomes: str | tuple[str, str]) -> str:
    """The text of a file with one line changed.

    `becomes` : what the line becomes, where `{line}` stands for what it was; or a piece of it that stands there once,
    and what this becomes

    Raises
    ------
    ValueError : the piece does not stand once in the line
    """
    lines = text.splitlines(keepends=True)
    code = MARKER.sub("", lines[line].rstrip("\n"))
    body = code.lstrip()
    if isinstance(becomes, str):
        changed = becomes.replace("{line}", body)
    else:
        if (count := body.count(becomes[0])) != 1:
            raise ValueError(f"'{becomes[0]}' stands {count} times in '{body}'")
        changed = body.replace(*becomes)
    lines[line] = code.removesuffix(body) + changed + "\n"
    return "".join(lines)
