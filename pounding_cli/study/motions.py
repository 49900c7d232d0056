"""From the records of the study file to motions: found, cut to their windows, scaled."""

from __future__ import annotations

import fnmatch
import glob
import os
import re
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from typing import Any

from pounding_cli import records
from pounding_cli.errors import InputError, Problem
from pounding_cli.numbers import listed
from pounding_cli.reading import LONGEST_PATH, shortened
from pounding_cli.records import Motion
from pounding_cli.study.file import Problems, Steps, nearest
from pounding_cli.study.models import Arias, Pga, Pgv, RecordFile, Records, Sa, Spectrum

_VERTICAL = re.compile(r"(?:[-_ .](?:up|dwn|down|vert?)|\.ud\d?|dwn)\Z", re.IGNORECASE)
# How the databases end the names of vertical components: -UP.AT2, DWN.AT2, .UD, .UD1.
_OTHER_FILES = re.compile(
    r"(?:\.(?:vt2|dt2|md|rst|html?|pdf|png|jpe?g|svg|zip|gz|ya?ml|json|h5|hdf5|xlsx?|py|toml)|~)\Z|\A(?:readme|licen[cs]e|[._])",
    re.IGNORECASE,
)
# What lies beside motions in a folder: PEER's velocities and displacements, its search results, pages, archives.

MOST_FILES = 50_000
"""Files and folders that are looked at for one pattern."""


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
            found = _matching(path)
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


def _matching(pattern: Path) -> list[Path]:
    """The files of a pattern such as `motions/**/*.AT2`, sorted; hidden names match where they are written.

    Raises
    ------
    InputError : more than MOST_FILES files and folders had to be looked at
    """
    parts, seen = pattern.parts, count(1)
    first = next(place for place, part in enumerate(parts) if glob.has_magic(part))

    def below(folder: Path, steps: Sequence[str]) -> Iterator[Path]:
        if not steps:
            yield folder
            return
        step, *rest = steps
        if step == "**":
            yield from below(folder, rest or ["*"])
        for each in _entries(folder):
            if next(seen) > MOST_FILES:
                hint = "begin the pattern nearer to the motions, e.g. `motions/**/*.AT2`"
                raise InputError(Problem(f"{shortened(pattern)}: more than {MOST_FILES} files and folders", hint))
            hidden = each.name.startswith(".") and not step.startswith(".")
            if step == "**" and not hidden and os.path.isdir(each) and not os.path.islink(each):
                yield from below(each, steps)
            elif step != "**" and not hidden and fnmatch.fnmatch(each.name, step):
                yield from below(each, rest)

    return sorted({found for found in below(Path(*parts[:first]), parts[first:]) if os.path.isfile(found)})


def _entries(folder: Path) -> list[Path]:
    try:
        return list(folder.iterdir())
    except (OSError, ValueError):  # no folder, or not ours to read
        return []


def _home(written: str) -> Path:
    try:
        return Path(written).expanduser()
    except RuntimeError:  # ~nobody
        return Path(written)


@dataclass(frozen=True)
class MotionUse:
    """A record as it is used: digest, peak [m/s2], Arias intensity [m/s] after window [s] and scale [-]."""

    name: str
    source: str
    digest: str
    scale: float
    window: float
    pga: float
    arias: float


@dataclass(frozen=True)
class Used:
    """A motion as it is used, what the tables say of it, and the target spectrum it was scaled to (None: to none)."""

    motion: Motion
    use: MotionUse
    target: records.TargetSpectrum | None = None


def motions_of(
    spec: Records, reader: MotionReader, root: Any, problems: Problems, warnings: Problems
) -> dict[str, Used]:
    """The motions of a study by name, as they are used; empty where something is wrong, which is noted."""
    return _Motions(spec, reader, root, problems, warnings).used()


class _Motions:
    """Motions on their way from the reader to the scenes.

    whole, cut : by name;  known : names with durations and scales of Table 1
    """

    def __init__(self, spec: Records, reader: MotionReader, root: Any, problems: Problems, warnings: Problems) -> None:
        self.spec, self.reader, self.root, self.problems, self.warnings = spec, reader, root, problems, warnings
        self.whole: dict[str, Motion] = {}
        self.cut: dict[str, Motion] = {}
        self.known: set[str] = set()
        self.faults = 0

    def refuse(self, path: Steps, message: str, hint: str) -> None:
        self.faults += 1
        self.problems.at(self.root, path, message, hint)

    def pass_on(self, refused: InputError, path: Steps) -> None:
        """Problems inside a record file keep their place; others are put at the study's line."""
        self.faults += 1
        for problem in refused.problems:
            if problem.line:
                self.problems.extend([problem])
            else:
                file = f"{problem.file}: " if problem.file else ""
                self.problems.at(self.root, path, f"{file}{problem.message}", problem.hint)

    def used(self) -> dict[str, Used]:
        """All of it."""
        for place, record in enumerate(self.spec.use):
            self._read(record, ("records", "use", place))
        if self.faults:
            return {}
        self._cut()
        target = None
        try:
            target = self._target() if isinstance(self.spec.scale, Spectrum) and not self.faults else None
            factors = self._factors(target) if not self.faults else {}
        except InputError as refused:
            self.pass_on(refused, ("records", "scale"))
        if self.faults:
            return {}
        found = {}
        for name, factor in factors.items():
            motion = self.cut[name].scaled(factor) if factor != 1.0 else self.cut[name]
            arias = float(records.arias(motion))
            use = MotionUse(name, motion.source, motion.digest, factor, motion.duration, motion.pga, arias)
            found[name] = Used(motion, use, target)
        return found

    def _read(self, record: Any, path: Steps) -> None:
        """The motions of one entry of `use`."""
        vertical: list[str] = []
        readings: list[records.Reading] = []
        try:
            items = self.reader.items(record)
        except InputError as refused:
            self.pass_on(refused, (*path, "file"))
            return
        for item in items:
            if item.name in self.whole:
                hint = "remove one, or give it another `name:`"
                self.refuse(path, f"the record '{item.name}' occurs twice", hint)
                continue
            vertical += [item.name] if item.vertical else []
            self.known |= {item.name} if item.known else set()
            try:
                self.whole[item.name] = self.reader.take(record, item)
            except InputError as refused:
                self.pass_on(refused, (*path, "file"))
                continue
            read = self.reader.reading(record, item)
            readings += [read] if isinstance(read, records.Reading) else []
        _tell_vertical(vertical, self.root, path, self.warnings)
        _tell_units(readings, self.root, path, self.warnings)

    def _cut(self) -> None:
        short, asked = dict[str, Motion](), self.spec.duration
        for name, motion in self.whole.items():
            seconds = self._seconds(asked, name, motion, ("records", "duration"))
            if isinstance(asked, float) and seconds > motion.duration + motion.dt:
                short[name] = motion
            self.cut[name] = motion.windowed(seconds)
        _tell_short(short, asked, self.root, self.warnings)

    def _seconds(self, wanted: float | str, name: str, motion: Motion, path: Steps) -> float:
        """The part of a motion that is used [s]; a name of Table 1 that the study does not use has its duration too."""
        has_one = name in self.known or (name not in self.whole and name in records.names())
        if wanted == "whole" or (wanted == "auto" and not has_one):
            return float(motion.duration)
        if wanted not in ("auto", "table1"):
            return float(wanted)
        if has_one:
            return float(records.entry(name).duration)
        if not self.faults:
            self.refuse(path, f"table1 has no duration for '{name}'", "write `whole` or a time, e.g. `duration: 10 s`")
        return float(motion.duration)

    def _other(self, name: str, path: Steps) -> Motion | None:
        """A motion that others are scaled to, whole: of the study or of the catalogue."""
        if name in self.whole:
            return self.whole[name]
        if name in records.names():
            return self.reader.named(name)
        self.refuse(path, f"no record '{name}'", nearest(name, dict.fromkeys((*self.whole, *records.names()))))
        return None

    def _target(self) -> records.TargetSpectrum | None:
        """The target as a spectrum over its range."""
        scale: Any = self.spec.scale
        name = scale.target
        ends = scale.low, scale.high, scale.damping
        if isinstance(name, dict):
            periods, values = zip(*sorted(name.items()), strict=True)
            return records.TargetSpectrum(periods, values, *ends)
        motion = self.cut.get(name)
        if motion is None and (reference := self._other(name, ("records", "scale", "target"))) is not None:
            seconds = self._seconds(self.spec.duration, name, reference, ("records", "duration"))
            motion = reference.windowed(seconds)
        return None if motion is None else records.TargetSpectrum.of(motion, *ends)

    def _factors(self, target: records.TargetSpectrum | None) -> dict[str, float]:
        cut = self.cut
        scale: Any = self.spec.scale
        match scale:
            case "table1":
                for name in [name for name in cut if name not in self.known][:1]:
                    hint = "write a factor, {arias: NAME}, {pga: 0.35 g}, {sa: 0.8 g, period: 0.5 s} or {spectrum: ...}"
                    self.refuse(("records", "scale"), f"table1 has no scale for '{name}'", hint)
                return {name: float(records.entry(name).scale) for name in cut if name in self.known}
            case Pga():
                return {name: records.pga_factor(motion, scale.pga) for name, motion in cut.items()}
            case Pgv():
                return {name: records.pgv_factor(motion, scale.pgv) for name, motion in cut.items()}
            case Sa():
                of = scale.sa, scale.period, scale.damping
                return {name: records.sa_factor(motion, *of) for name, motion in cut.items()}
            case Spectrum() if target is not None:
                return records.spectrum_factors(cut, target, scale.spectrum == "each", scale.at_least)
            case Arias():
                return self._arias_factors(scale)
        return dict.fromkeys(cut, float(scale))

    def _arias_factors(self, scale: Arias) -> dict[str, float]:
        reference = self._other(scale.arias, ("records", "scale", "arias"))
        if reference is None:
            return {}
        window = self.spec.duration if scale.window == "duration" else scale.window
        part = {
            name: motion.windowed(self._seconds(window, name, motion, ("records", "scale", "window")))
            for name, motion in {scale.arias: reference, **self.whole}.items()
        }
        if self.faults:
            return {}
        one = part[scale.arias]
        return {name: 1.0 if name == scale.arias else records.arias_factor(part[name], one) for name in self.whole}


def _tell_vertical(names: list[str], root: Any, path: Steps, warnings: Problems) -> None:
    """Warn of files that are named like vertical components."""
    if not names:
        return
    what = f"'{names[0]}' looks like a vertical component; it will"
    if len(names) > 1:
        what = f"{len(names)} motions look like vertical components and will"
    whole = f": {listed(names)}" if len(names) > 1 else ""
    hint = "name the horizontal ones, e.g. `{file: motions/*.NS}`"
    warnings.at(root, path, f"{what} shake the buildings sideways{whole}", hint)


def _tell_units(readings: list[records.Reading], root: Any, path: Steps, warnings: Problems) -> None:
    """Warn of headings from which no unit can be read, and of those that state another one than the study."""
    unclear: dict[str, list[str]] = {}
    against: dict[tuple[str, str], list[str]] = {}
    for each in readings:
        if each.heading:
            unclear.setdefault(each.heading, []).append(each.motion.name)
        if each.stated:
            against.setdefault((each.unit, each.stated), []).append(each.motion.name)
    for heading, names in unclear.items():
        message = f"{listed(names)}: '{heading}' in the file is no unit of acceleration, so g is assumed"
        warnings.at(root, path, message, "write the unit in the study, e.g. `{file: motions/a.csv, unit: m/s2}`")
    for (unit, stated), names in against.items():
        message = f"{listed(names)}: read in {unit}, as the study says, although the file says {stated}"
        warnings.at(root, path, message, "remove `unit:` if the file is right")


def _tell_short(motions: dict[str, Motion], seconds: float | str, root: Any, warnings: Problems) -> None:
    """Warn of motions shorter than the duration asked for [s]."""
    if not motions:
        return
    asked = f"shorter than the {seconds:g} s asked for"
    hint = "its whole length is used; `tail:` adds free vibration"
    if len(motions) == 1:
        ((name, motion),) = motions.items()
        message = f"'{name}' lasts {motion.duration:g} s, {asked}"
    else:
        hint = hint.replace("its", "their")
        all_of = listed(f"{name} ({motion.duration:g} s)" for name, motion in motions.items())
        message = f"{len(motions)} motions are {asked}: {all_of}"
    warnings.at(root, ("records", "duration"), message, hint)
