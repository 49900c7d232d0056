"""The motions of a study: found, read, cut to their windows and scaled."""

from __future__ import annotations

import functools
import glob
import os
import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path, PurePath
from typing import Any

from pounding_cli import records
from pounding_cli.errors import InputError, Issue, KeyPath
from pounding_cli.numbers import join_limited, pluralize
from pounding_cli.reading import MAX_PATH_LENGTH, shorten_path
from pounding_cli.records import Motion
from pounding_cli.study.schema.records import (
    AriasSpec,
    CodeTargetSpec,
    MotionSpec,
    PgaSpec,
    PgvSpec,
    RecordFileSpec,
    RecordsSpec,
    SaSpec,
    SineSpec,
    SpectrumSpec,
)
from pounding_cli.study.text.file import nearest
from pounding_cli.study.text.issues import Issues, to_issues

_VERTICAL = re.compile(r"(?:[-_ .](?:up|dwn|down|vert?)|\.ud\d?|dwn)\Z", re.IGNORECASE)
# How the databases end the names of vertical components: -UP.AT2, DWN.AT2, .UD, .UD1.
_OTHER_FILES = re.compile(
    r"(?:\.(?:vt2|dt2|md|rst|html?|pdf|png|jpe?g|svg|zip|gz|ya?ml|json|h5|hdf5|xlsx?|py|toml)|~)\Z|\A(?:readme|licen[cs]e|[._])",
    re.IGNORECASE,
)
# What lies beside motions in a folder: PEER's velocities and displacements, its search results, pages, archives.

MAX_FILES = 50_000
"""Files and folders that are looked at for one pattern."""


MIN_USUAL_ENERGY = 0.5
"""Part of the Arias intensity of a motion that a duration should leave [-]: with less, strong shaking is cut off."""

UNIT_FACTORS = {9.80665: "g in m/s2", 980.665: "g in cm/s2", 9806.65: "g in mm/s2", 386.0886: "g in in/s2"}
"""Factors between units of acceleration, and what they are."""

MAX_USED = 1000
"""Motions as they are used that are kept at a time: scenes that are solved together share them."""


@dataclass(frozen=True)
class MotionItem:
    """One motion of a study.

    name : what tables call it
    file, spec : its file and how that is read; None of a motion of the catalogue or of a set
    set_motion : the motion of a set; None of any other
    sine : a sinusoidal motion; None of any other
    """

    name: str
    file: Path | None = None
    spec: RecordFileSpec | None = None
    set_motion: records.SetMotion | None = None
    sine: records.Sine | None = None

    @property
    def is_of_catalogue(self) -> bool:
        """Return whether it is a motion of the catalogue, with a duration and a scale in Table 1."""
        return self.file is None and self.set_motion is None and self.sine is None


@dataclass(frozen=True)
class MotionUse:
    """A motion as it is used, without its samples (`MotionReader.used_motion` makes them again).

    source : label of where it comes from (`Motion.source`)
    digest : SHA-256 of the motion as used
    scale : factor on the motion as read [-]
    window : duration used [s]
    pga : peak as used [m/s2]
    arias : Arias intensity as used [m/s]
    """

    item: MotionItem
    source: str
    digest: str
    scale: float
    window: float
    pga: float
    arias: float

    @property
    def name(self) -> str:
        """The name of the motion in tables."""
        return self.item.name


@dataclass(frozen=True, eq=False)
class Suite:
    """The motions of a study at a point of its sweep.

    uses : by name
    target : spectrum that they are scaled to; None without one
    doubts : what is doubtful about them
    taken : of every plain file the lines that say what was taken of it
    """

    uses: Mapping[str, MotionUse]
    target: records.TargetSpectrum | None
    doubts: tuple[Issue, ...]
    taken: tuple[tuple[str, ...], ...] = ()


class MotionReader:
    """Finds and reads every motion once, however many scenes it drives.

    folder : of the study, which paths are relative to

    Two caches by content stand here: of motions as read, since reading a file takes longer than a scene, and of the
    last motions as used, which the scenes of one batch share.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.find_items: Callable[[MotionSpec], tuple[MotionItem, ...]] = functools.cache(self._find_items)
        self.read: Callable[[MotionItem], records.Reading | Motion] = functools.cache(self._read)
        self.used_motion: Callable[[MotionUse], Motion] = functools.lru_cache(MAX_USED)(self._used_motion)

    def _used_motion(self, use: MotionUse) -> Motion:
        """Return a motion cut to its window and scaled."""
        motion = self.whole_motion(use.item).cut_to(use.window)
        return motion.scale_by(use.scale) if use.scale != 1.0 else motion

    def _read(self, item: MotionItem) -> records.Reading | Motion:
        """Return the whole motion, with how it was read where it is a file.  Raises InputError: it cannot be read."""
        if item.set_motion is not None:
            return records.read_set_motion(item.set_motion)
        if item.sine is not None:
            return item.sine.build_motion()
        if item.file is None or item.spec is None:
            return records.load_motion(item.name)
        return records.read_file(item.file, item.spec.declare(), name=item.name)

    def whole_motion(self, item: MotionItem) -> Motion:
        """Return the whole motion as read.  Raises InputError: it cannot be read."""
        reading = self.read(item)
        return reading.motion if isinstance(reading, records.Reading) else reading

    def _find_items(self, record: MotionSpec) -> tuple[MotionItem, ...]:
        """The motions an entry of `use` stands for.  Raises `InputError` where there is none."""
        if isinstance(record, SineSpec):
            return tuple(MotionItem(sine.name, sine=sine) for sine in record.list_sines())
        if isinstance(record, str):
            if record in records.list_names():
                return (MotionItem(record),)
            if records.find_set_name(record) is not None:
                return self._find_set_items(record)
            is_path = re.search(r"[/\\*?]", record) or Path(record).suffix or os.path.exists(self.folder / record)
            if not is_path:
                records.get_entry(record, records.MOTION_SETS)  # refuses the name, with the nearest one
            record = RecordFileSpec(file=record)
        if len(record.file) > MAX_PATH_LENGTH:
            raise InputError(f"a path of {len(record.file)} characters", "no path is that long")
        written = os.path.expanduser(record.file)
        files = self._find_files(written)
        if not files:
            message = f"there exists no motion {shorten_path(self.folder / written)}"
            hint = "paths are relative to the study file"
            if records.find_set_name(written) is not None:
                hint = f"write `{written}` without `file:` for the set of recorded motions; {hint}"
            raise InputError(message, hint)
        if record.name is not None and len(files) > 1:
            hint = "leave it out: each is called by its file's stem"
            raise InputError(f"'name:' is one for {len(files)} files", hint)
        stems = Counter(each.stem for each in files)
        # K-NET's files of one record differ by their endings only.
        names = [each.stem if stems[each.stem] == 1 else each.name.replace(".", "-") for each in files]
        return tuple(MotionItem(record.name or name, each, record) for each, name in zip(files, names, strict=True))

    def _find_set_items(self, record: str) -> tuple[MotionItem, ...]:
        """Return the motions of a set that an entry of `use` names.

        Raises
        ------
        InputError : a file or folder has the name of the set; the set has no such motion, or is not installed
        """
        name = records.find_set_name(record)
        if os.path.exists(self.folder / str(name)):
            message = f"'{name}' is a set of recorded motions, and {shorten_path(self.folder / str(name))} exists too"
            hint = f"write `./{record}` for the files; give the folder another name to use the set"
            raise InputError(message, hint)
        return tuple(MotionItem(motion.name, set_motion=motion) for motion in records.select_set_motions(record))

    def _find_files(self, written: str) -> list[Path]:
        """A file, the motions in a folder, or the files that a pattern matches."""
        path = self.folder / written
        if os.path.isdir(path):
            return [each for each in sorted(path.iterdir()) if each.is_file() and not _OTHER_FILES.search(each.name)]
        if os.path.exists(path) or "\0" in str(path):
            return [path] if os.path.exists(path) else []
        head, deep, tail = written.partition("**/")  # what lies below is visited file by file, so that it can be much
        visited = glob.iglob(f"{head}**" if deep else written, root_dir=self.folder, recursive=True)
        found = list(islice(visited, MAX_FILES + 1))
        if len(found) > MAX_FILES:
            hint = "begin the pattern nearer to the motions, e.g. `motions/**/*.AT2`"
            raise InputError(f"{shorten_path(path)}: more than {MAX_FILES} files and folders", hint)
        fits = (self.folder / name for name in found if not deep or PurePath(name).match(tail))
        return sorted(each for each in fits if os.path.isfile(each))


def read_suite(spec: RecordsSpec, reader: MotionReader) -> Suite:
    """Return the motions of a study as they are used.

    Raises
    ------
    InputError : a motion cannot be found, read or scaled
    """
    sources = _Sources(reader)
    issues = Issues()
    for place, record in enumerate(spec.use):
        path = ("records", "use", place)
        try:
            sources.take(record, path, issues)
        except InputError as refused:
            issues.add_written(to_issues(refused, (*path, "file")))
    issues.check()
    try:
        return _Scaler(spec, sources).build_suite()
    except InputError as refused:
        raise InputError(to_issues(refused, ("records", "scale"))) from None


class _Sources:
    """The motions that a study names, whole.

    items, motions : by name
    doubts : what is doubtful about their files
    taken : of every plain file the lines that say what was taken of it
    """

    def __init__(self, reader: MotionReader) -> None:
        self.reader = reader
        self.items: dict[str, MotionItem] = {}
        self.motions: dict[str, Motion] = {}
        self.doubts: list[Issue] = []
        self.taken: list[tuple[str, ...]] = []

    def take(self, record: MotionSpec, path: KeyPath, issues: Issues) -> None:
        """Take the motions of one entry of `use`.  Raises InputError where there is none."""
        items = self.reader.find_items(record)
        vertical: list[str] = []
        readings: list[records.Reading] = []
        refusals: list[InputError] = []
        for item in items:
            if item.name in self.items:
                hint = "remove one" if item.file is None else "remove one, or give it another `name:`"
                issues.add_written([Issue(path, f"the record '{item.name}' occurs twice", hint)])
                continue
            try:
                reading = self.reader.read(item)
            except InputError as refused:
                refusals.append(refused)
                continue
            self.items[item.name] = item
            self.motions[item.name] = self.reader.whole_motion(item)
            if isinstance(reading, records.Reading):
                readings.append(reading)
                if reading.format == records.PLAIN:
                    self.taken.append(reading.lines)
            if item.file is not None and len(items) > 1 and _is_named_vertical(item.file):
                vertical.append(item.name)
        written = record.file if isinstance(record, RecordFileSpec) else str(record)
        for merged in _merge_refusals(refusals, written):
            issues.add_written(to_issues(merged, (*path, "file")))
        self.doubts += [replace(issue, path=path) for issue in _iter_doubts(vertical, readings)]

    def has_table1(self, name: str) -> bool:
        """Return whether Table 1 has duration and scale of a motion; a file of that name is not the motion of it."""
        item = self.items.get(name)
        return name in records.list_names() if item is None else item.is_of_catalogue

    def find_other(self, name: str, key: str) -> Motion:
        """Return a motion that others are scaled to, whole: of the study or of the catalogue."""
        if name in self.motions:
            return self.motions[name]
        if name in records.list_names():
            return self.reader.whole_motion(MotionItem(name))
        names = dict.fromkeys((*self.motions, *records.list_names()))
        raise InputError([Issue(("records", "scale", key), f"no record '{name}'", nearest(name, names))])


def _merge_refusals(refusals: Sequence[InputError], written: str) -> Iterator[InputError]:
    """Yield refusals of the files that an entry of `use` stands for, those alike as one, with the entry as written in
    the line to paste."""
    alike: dict[tuple[str, str], list[Issue]] = {}
    for problem in (each for refused in refusals for each in refused.issues):
        hint = problem.hint.replace(records.write_file(problem.file), records.write_file(written))
        alike.setdefault((problem.message, hint), []).append(problem)
    for (message, hint), problems in alike.items():
        more = len(problems) - 1
        others = f" (and so it is with {pluralize(more, 'more file')})" if more else ""
        yield InputError(replace(problems[0], message=f"{message}{others}", hint=hint))


def _is_named_vertical(file: Path) -> bool:
    """Return whether a file is named like a vertical component."""
    return any(_VERTICAL.search(name) for name in (file.stem, file.name))


class _Scaler:
    """Cuts the motions of a study to their windows and scales them."""

    def __init__(self, spec: RecordsSpec, sources: _Sources) -> None:
        self.spec = spec
        self.sources = sources

    def build_suite(self) -> Suite:
        """Return the motions as they are used.  Raises InputError, and InputError where they cannot be scaled."""
        cut: dict[str, Motion] = {}
        short: list[str] = []
        begun: list[str] = []
        duration = self.spec.duration
        for name, motion in self.sources.motions.items():
            seconds = self.find_seconds(duration, name, motion, "duration")
            if isinstance(duration, float) and seconds > motion.duration + motion.dt:
                short.append(f"{name} ({motion.duration:g} s)")
            cut[name] = motion.cut_to(seconds)
            item = self.sources.items[name]
            is_chosen = isinstance(duration, float) and not item.is_of_catalogue and item.sine is None
            if is_chosen and records.arias(cut[name]) < MIN_USUAL_ENERGY * records.arias(motion):
                begun.append(name)
        doubts = [*self.sources.doubts]
        if short:
            message = f"shorter than the {duration:g} s asked for: {join_limited(short)}"
            hint = "the whole length is used; `tail:` adds free vibration"
            doubts.append(Issue(("records", "duration"), message, hint, code="duration"))
        if begun:
            message = f"the first {duration:g} s have less than half of the Arias intensity of: {join_limited(begun)}"
            hint = "write `duration: whole` to use all of it"
            doubts.append(Issue(("records", "duration"), message, hint, code="duration"))
        doubts.extend(self._iter_scale_doubts())
        target = self._find_target(cut) if isinstance(self.spec.scale, SpectrumSpec) else None
        factors = self._find_factors(cut, target)
        uses = {name: self._build_use(name, cut[name], factor) for name, factor in factors.items()}
        return Suite(uses, target, tuple(doubts), tuple(self.sources.taken))

    def _iter_scale_doubts(self) -> Iterator[Issue]:
        """Yield the doubt about a factor on files that is one unit of acceleration in another."""
        scale = self.spec.scale
        if not isinstance(scale, int | float) or all(item.file is None for item in self.sources.items.values()):
            return
        for factor, words in UNIT_FACTORS.items():
            if any(abs(scale / each - 1) < 0.003 for each in (factor, 1 / factor)):
                message = f"the factor {scale:g} on motions from files is {words}: a unit in disguise"
                hint = "write the unit of the file, `unit:` beside `file:`, and leave the factor out"
                yield Issue(("records", "scale"), message, hint, code="factor")
                return

    def _build_use(self, name: str, cut: Motion, factor: float) -> MotionUse:
        motion = cut.scale_by(factor) if factor != 1.0 else cut
        arias = float(records.arias(motion))
        item = self.sources.items[name]
        return MotionUse(item, motion.source, motion.digest, factor, motion.duration, motion.pga, arias)

    def find_seconds(self, window: float | str, name: str, motion: Motion, key: str) -> float:
        """Return the part of a motion that is used [s].

        window : seconds, or `whole`, `auto`, `table1`; a name of Table 1 that the study does not use has its duration
        """
        has_table1 = self.sources.has_table1(name)
        if window == "whole" or (window == "auto" and not has_table1):
            return float(motion.duration)
        if window not in ("auto", "table1"):
            return float(window)
        if has_table1:
            return float(records.get_entry(name).duration)
        path = ("records", key) if key == "duration" else ("records", "scale", key)
        hint = "write `whole` or a time, e.g. `duration: 10 s`"
        raise InputError([Issue(path, f"table1 has no duration for '{name}'", hint)])

    def _find_target(self, cut: Mapping[str, Motion]) -> records.TargetSpectrum:
        """Return the target as a spectrum over its range."""
        scale: Any = self.spec.scale
        ends = (scale.low, scale.high, scale.damping)
        if isinstance(scale.target, CodeTargetSpec):
            code = scale.target.build(scale.damping)
            return records.TargetSpectrum(code.periods, code.values, *ends, code.straight_in_period, code.name)
        if isinstance(scale.target, dict):
            periods, ordinates = zip(*sorted(scale.target.items()), strict=True)
            return records.TargetSpectrum(periods, ordinates, *ends)
        name = scale.target
        motion = cut.get(name)
        if motion is None:
            whole = self.sources.find_other(name, "target")
            motion = whole.cut_to(self.find_seconds(self.spec.duration, name, whole, "duration"))
        return records.TargetSpectrum.of(motion, *ends)

    def _find_factors(self, cut: Mapping[str, Motion], target: records.TargetSpectrum | None) -> dict[str, float]:
        """Return the scale factor of every motion [-].

        cut : the motions cut to their windows
        """
        scale: Any = self.spec.scale
        match scale:
            case "table1":
                return self._find_table1_scales(cut)
            case PgaSpec():
                return {name: records.scale_factor(each, each.pga, scale.pga) for name, each in cut.items()}
            case PgvSpec():
                return {name: records.scale_factor(each, records.pgv(each), scale.pgv) for name, each in cut.items()}
            case SaSpec():
                ordinates = {
                    name: records.spectrum(each, (scale.period,), scale.damping)[0] for name, each in cut.items()
                }
                return {name: records.scale_factor(cut[name], sa, scale.sa) for name, sa in ordinates.items()}
            case SpectrumSpec() if target is not None:
                return records.spectrum_factors(cut, target, scale.spectrum == "each", scale.at_least)
            case AriasSpec():
                return self._find_arias_factors(scale)
        return dict.fromkeys(cut, float(scale))

    def _find_table1_scales(self, cut: Mapping[str, Motion]) -> dict[str, float]:
        for name in cut:
            if not self.sources.has_table1(name):
                hint = "write a factor, {arias: NAME}, {pga: 0.35 g}, {sa: 0.8 g, period: 0.5 s} or {spectrum: ...}"
                raise InputError([Issue(("records", "scale"), f"table1 has no scale for '{name}'", hint)])
        return {name: float(records.get_entry(name).scale) for name in cut}

    def _find_arias_factors(self, scale: AriasSpec) -> dict[str, float]:
        """Return the factors that give every motion the Arias intensity of one of them, over their windows."""
        reference = self.sources.find_other(scale.arias, "arias")
        window = self.spec.duration if scale.window == "duration" else scale.window
        measured = {
            name: motion.cut_to(self.find_seconds(window, name, motion, "window"))
            for name, motion in {scale.arias: reference, **self.sources.motions}.items()
        }
        target = measured[scale.arias]
        return {
            name: 1.0 if name == scale.arias else records.arias_factor(measured[name], target)
            for name in self.sources.motions
        }


def _iter_doubts(vertical: Sequence[str], readings: Sequence[records.Reading]) -> Iterator[Issue]:
    """Yield what is doubtful about files: names of vertical components, and what the reader of files warns of
    (`records.checks`)."""
    if vertical:
        message = f"named like vertical components, will shake the buildings sideways: {join_limited(vertical)}"
        hint = "name the horizontal ones, e.g. `{file: motions/*.NS}`"
        yield Issue((), message, hint, code="vertical")
    doubts: dict[Issue, list[str]] = {}
    for each in readings:
        for doubt in each.doubts:
            doubts.setdefault(doubt, []).append(each.motion.name)
    for doubt, names in doubts.items():
        yield replace(doubt, message=f"{join_limited(names)}: {doubt.message}")
