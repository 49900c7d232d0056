"""From what `records.use` says to motions: catalogue names, files, folders, patterns."""

from __future__ import annotations

import glob
import re
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from pounding_cli import records
from pounding_cli.errors import InputError, Problem
from pounding_cli.reading import LONGEST_PATH, shortened
from pounding_cli.records import Motion
from pounding_cli.study.models import RecordFile
from pounding_cli.study.patterns import matching_files

_VERTICAL = re.compile(r"(?:[-_ .](?:up|dwn|down|vert?)|\.ud\d?|dwn)\Z", re.IGNORECASE)
# How the databases end the names of vertical components: -UP.AT2, DWN.AT2, .UD, .UD1.
_OTHER_FILES = re.compile(
    r"(?:\.(?:vt2|dt2|md|rst|html?|pdf|png|jpe?g|svg|zip|gz|ya?ml|json|h5|hdf5|xlsx?|py|toml)|~)\Z|\A(?:readme|licen[cs]e|[._])",
    re.IGNORECASE,
)
# What lies beside motions in a folder: PEER's velocities and displacements, its search results, pages, archives.


@dataclass(frozen=True)
class Item:
    """One motion of a study.

    name : what tables call it; known : whether it is in the catalogue, with durations and scales of Table 1
    read : reads it whole, and says how where it is a file of one's own
    vertical : whether a file taken with others looks like a vertical component
    """

    name: str
    known: bool
    read: Callable[[], Motion | records.Reading]
    vertical: bool = False


class MotionReader:
    """Finds and reads every motion once, however many scenes it drives."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._items: dict[str | RecordFile, list[Item] | InputError] = {}
        self._read: dict[tuple[str | RecordFile, str], Motion | records.Reading | InputError] = {}

    def items(self, record: str | RecordFile) -> list[Item]:
        """The motions an entry of `use` stands for; raises `InputError` where there is none."""
        if record not in self._items:
            try:
                self._items[record] = self._found(record)
            except InputError as refused:
                self._items[record] = refused
        found = self._items[record]
        if isinstance(found, InputError):
            raise found
        return found

    def take(self, record: str | RecordFile, item: Item) -> Motion:
        """The whole motion; raises `InputError` where it cannot be read."""
        found = self.reading(record, item)
        return found.motion if isinstance(found, records.Reading) else found

    def reading(self, record: str | RecordFile, item: Item) -> Motion | records.Reading:
        """The whole motion, with how it was read where it is a file of one's own; raises as `take`."""
        key = (record, item.name)
        if key not in self._read:
            try:
                self._read[key] = item.read()
            except InputError as refused:
                self._read[key] = refused
        found = self._read[key]
        if isinstance(found, InputError):
            raise found
        return found

    @property
    def digests(self) -> list[str]:
        """Of all motions that were read so far."""
        read = [found.motion if isinstance(found, records.Reading) else found for found in self._read.values()]
        return [found.digest for found in read if isinstance(found, Motion)]

    def named(self, name: str) -> Motion:
        """The whole catalogue motion `name`."""
        return self.take(name, self.items(name)[0])

    def _found(self, record: str | RecordFile) -> list[Item]:
        if isinstance(record, RecordFile):
            return self._files(record)
        if record in records.names():
            return [Item(record, True, lambda: records.find(record))]
        if self._is_path(record):
            return self._files(RecordFile(file=record))
        records.entry(record)  # refuses the name, with the nearest one
        raise AssertionError(record)

    def _is_path(self, word: str) -> bool:
        return bool(re.search(r"[/\\*?]", word) or Path(word).suffix or _exists(self.folder / word))

    def _files(self, record: RecordFile) -> list[Item]:
        if len(record.file) > LONGEST_PATH:
            raise InputError(Problem(f"a path of {len(record.file)} characters", "no path is that long"))
        path = self.folder / _home(record.file)
        if _exists(path) and not _is_folder(path):
            return [_item(record, path, record.name or path.stem)]
        if _is_folder(path):
            found = [each for each in sorted(path.iterdir()) if each.is_file() and not _OTHER_FILES.search(each.name)]
            nothing = f"no motion files in the folder {path}"
        elif glob.has_magic(record.file):
            found = matching_files(path)
            nothing = f"no file matches {path}"
        else:
            raise InputError(
                Problem(f"the record file {shortened(path)} does not exist", "paths are relative to the study file")
            )
        if not found:
            raise InputError(Problem(nothing, "paths are relative to the study file"))
        if record.name is not None and len(found) > 1:
            raise InputError(
                Problem(f"'name:' is one for {len(found)} files", "leave it out: each is called by its file's stem")
            )
        stems = Counter(each.stem for each in found)
        # K-NET's files of one record differ by their endings only.
        names = [each.stem if stems[each.stem] == 1 else each.name.replace(".", "-") for each in found]
        return [
            _item(record, each, record.name or name, bool(_VERTICAL.search(each.stem) or _VERTICAL.search(each.name)))
            for each, name in zip(found, names, strict=True)
        ]


def _item(record: RecordFile, path: Path, name: str, vertical: bool = False) -> Item:
    def read() -> records.Reading:
        return records.read_file(
            path,
            name=name,
            unit=record.unit,
            dt=record.dt,
            format=record.format,
            channel=record.channel,
            column=record.column,
        )

    return Item(name, False, read, vertical)


def _exists(path: Path) -> bool:
    try:
        return path.exists()
    except (OSError, ValueError):  # too long a name, a NUL in it
        return False


def _is_folder(path: Path) -> bool:
    try:
        return path.is_dir()
    except (OSError, ValueError):
        return False


def _home(written: str) -> Path:
    try:
        return Path(written).expanduser()
    except RuntimeError:  # ~nobody
        return Path(written)
