"""Files that match a pattern such as `motions/**/*.AT2`, sought among so many entries and no more."""

from __future__ import annotations

import fnmatch
import glob
import os
from collections.abc import Iterator
from itertools import islice
from pathlib import Path

from pounding_cli.errors import InputError, Problem
from pounding_cli.reading import shortened

MOST_ENTRIES = 50_000
"""Files and folders that are looked at for one pattern."""


def matching_files(pattern: Path) -> list[Path]:
    """The files of a pattern, sorted; `**` stands for any folders below; hidden names match where they are written.

    Raises
    ------
    InputError : more than MOST_ENTRIES entries had to be looked at
    """
    search = _Search(pattern)
    first, *rest = pattern.parts
    start, rest = (Path(first), rest) if pattern.is_absolute() else (Path(), [first, *rest])
    return sorted({found for found in search.below(start, rest) if found.is_file()})


class _Search:
    """One search with its count of entries."""

    def __init__(self, pattern: Path) -> None:
        self.pattern, self.seen = pattern, 0

    def entries(self, folder: Path) -> list[os.DirEntry[str]]:
        found: list[os.DirEntry[str]] = []
        try:
            with os.scandir(folder) as entries:
                found.extend(islice(entries, MOST_ENTRIES - self.seen + 1))
        except (OSError, ValueError):
            return []  # no folder, or not ours to read
        self.seen += len(found)
        if self.seen > MOST_ENTRIES:
            hint = "begin the pattern nearer to the motions, e.g. `motions/**/*.AT2`"
            raise InputError(Problem(f"{shortened(self.pattern)}: more than {MOST_ENTRIES} files and folders", hint))
        return found

    def below(self, folder: Path, parts: list[str]) -> Iterator[Path]:
        """What matches the rest of the pattern below a folder."""
        while parts and not glob.has_magic(parts[0]):
            folder, parts = folder / parts[0], parts[1:]
        if not parts:
            if folder.exists():
                yield folder
            return
        step, rest = parts[0], parts[1:]
        if step == "**":
            yield from self.below(folder, rest or ["*"])
        for entry in self.entries(folder):
            hidden = entry.name.startswith(".") and not step.startswith(".")
            if step == "**":
                if not hidden and entry.is_dir(follow_symlinks=False):
                    yield from self.below(Path(entry.path), parts)
            elif not hidden and fnmatch.fnmatch(entry.name, step):
                yield from self.below(Path(entry.path), rest)
