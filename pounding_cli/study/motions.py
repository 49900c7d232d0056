"""The section `records` of a study file, and its motions: found, cut to their windows, scaled."""

from __future__ import annotations

import functools
import glob
import os
import re
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path, PurePath
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field, WrapValidator

from pounding_cli import records
from pounding_cli.errors import InputError, Problem
from pounding_cli.numbers import listed
from pounding_cli.reading import LONGEST_PATH, shortened
from pounding_cli.records import Motion
from pounding_cli.records.units import UNITS, acceleration_unit
from pounding_cli.study.base import Model, Name, SpecIssue, spec_field, tagged_union, word_or
from pounding_cli.study.file import Problems, Steps, nearest
from pounding_cli.study.laws import RATIO
from pounding_cli.study.quantity import ACCELERATION, PLAUSIBLE_RANGES, TIME, Quantity, WholeNumber, refuse

# Models of the section `records`


def _unit(text: str) -> str:
    if acceleration_unit(text) is None:
        hint = f"write one of {', '.join(UNITS)}, or a multiple: 0.01 g"
        raise refuse(f"'{text}' is not a unit of acceleration", hint)
    return text


PERIOD = TIME.replace(name="period", example="0.5 s", low=0.01, open_low=False, high=60)
Period = Annotated[float, PERIOD]
Acceleration = Annotated[float, ACCELERATION]
PEAK_VELOCITY = PLAUSIBLE_RANGES["peak velocity asked for"]
Velocity = Annotated[float, Quantity("velocity", "m/s", "40 cm/s", 0.0, open_low=True, usual=PEAK_VELOCITY)]
Number = Annotated[int, WholeNumber(1, 1000)]
TimeStep = Annotated[float, TIME.replace(name="time step", example="0.01 s")]
Window = Annotated[float | str, TIME.replace(name="window", example="10 s", words=("duration", "table1", "whole"))]
Duration = Annotated[float | str, TIME.replace(name="duration", example="10 s", words=("auto", "table1", "whole"))]
Ratio = Annotated[float, RATIO]
Part = Annotated[float, Quantity("part of the target", "", "90 %", 0.0, 10.0, open_low=True)]


_Format = Literal["at2", "cosmos", "csmip", "smc", "knet", "esm", "geonet", "asa", "two-column", "column", "table"]


class RecordFile(Model):
    """A motion in a file of one's own, or several in a folder."""

    file: str = spec_field(
        ..., "a file, a folder, or a pattern motions/*.AT2, relative to the study file", "motions/x.AT2"
    )
    name: Name | None = spec_field(None, "name of the motion in tables; default: the file's stem")
    unit: Annotated[str, AfterValidator(_unit)] | None = spec_field(
        None, "unit of the acceleration, any spelling; needed where the file does not state it"
    )
    dt: TimeStep | None = spec_field(None, "time step [s]; needed where the file does not state it")
    format: _Format | None = spec_field(None, "default: detected")
    channel: Number | None = spec_field(None, "channel of a file with several channels, from 1")
    column: Number | None = spec_field(None, "column of a table with the acceleration, from 1")


class Arias(Model):
    """Every record is scaled to the Arias intensity of one of them."""

    arias: str = spec_field(..., "record with the reference Arias intensity", "elcentro")
    window: Window = spec_field("duration", "part of each record that is measured [s]; `duration`: the analysed part")


class Pga(Model):
    """Every record is scaled to one peak ground acceleration."""

    pga: Acceleration = spec_field(..., "peak ground acceleration [m/s2]", "0.35 g")


class Pgv(Model):
    """Every record is scaled to one peak ground velocity."""

    pgv: Velocity = spec_field(..., "peak ground velocity [m/s], without baseline correction", "40 cm/s")


class Sa(Model):
    """Every record is scaled to one ordinate of its response spectrum."""

    sa: Acceleration = spec_field(..., "pseudo-acceleration [m/s2]", "0.8 g")
    period: Period = spec_field(..., "at this period [s]", "0.5 s")
    damping: Ratio = spec_field(0.05, "and this damping ratio [-]")


def _once_each(points: Any, read: Any) -> Any:
    found = read(points)
    if len(found) < len(points):
        raise refuse("two of the periods are one", "remove one of the two")
    return found


class Spectrum(Model):
    """The suite is scaled to a target spectrum over a range of periods."""

    spectrum: Literal["mean", "each"] = spec_field(
        ..., "`mean`: one factor for all, their mean spectrum meets the target; `each`: one for every record", "mean"
    )
    target: word_or(str, Annotated[dict[Period, Acceleration], WrapValidator(_once_each)]) = spec_field(  # type: ignore[valid-type]
        ...,
        "{period: pseudo-acceleration, ...}, or the record whose spectrum is taken",
        {"0.1 s": "0.8 g", "2 s": "0.2 g"},
    )
    low: Period = spec_field(..., "shortest period of the range [s]", "0.2 s", alias="from")
    high: Period = spec_field(..., "longest period of the range [s]", "1.2 s", alias="to")
    damping: Ratio = spec_field(0.05, "damping ratio of the spectra [-]")
    at_least: Part | None = spec_field(
        None, "another factor for all, so that the mean spectrum is nowhere below this part of the target"
    )

    def issues(self) -> Iterator[SpecIssue]:
        ends = f"from {self.low:g} s to {self.high:g} s"
        if not self.low < self.high:
            hint = "write `to:` above `from:`, e.g. `from: 0.2 s, to: 1.2 s`"
            yield ("to",), f"the range of periods runs {ends}", hint
        elif isinstance(self.target, dict):
            first, last = min(self.target, default=0.0), max(self.target, default=0.0)
            if not first < last or not first <= self.low or not self.high <= last:
                what = f"the target is given from {first:g} to {last:g} s, not over the whole range"
                yield ("target",), what, f"give two points at least, {ends} and beyond"


_SCALES: dict[str, Any] = {"arias": Arias, "pga": Pga, "pgv": Pgv, "sa": Sa, "spectrum": Spectrum}


def _scale(value: Any) -> str:
    if isinstance(value, dict):
        return next((name for name in _SCALES if name in value), "arias")
    return next((name for name, model in _SCALES.items() if isinstance(value, model)), "factor")


FACTOR = Quantity("scale factor", "", "1.5", 0.0, 1e6, open_low=True, words=("table1",))
Scale: Any = tagged_union(_scale, factor=Annotated[float | str, FACTOR], **_SCALES)


class Records(Model):
    """The ground motions, the part of each that is used, and its scale."""

    use: Annotated[tuple[word_or(str, RecordFile), ...], Field(min_length=1, max_length=5000)] = spec_field(  # type: ignore[valid-type]
        ..., "catalogue names, files, folders, patterns, {file: PATH, ...}", ["elcentro", {"file": "motions/x.AT2"}]
    )
    duration: Duration = spec_field(
        "auto",
        "how much of each record is used [s]; `table1`: the paper's durations; `auto`: those, and `whole` for motions "
        "that Table 1 does not hold",
    )
    scale: Scale = spec_field(
        1.0, "a factor, `table1`, {arias: RECORD}, {pga: 0.35 g}, {pgv: ...}, {sa: ...} or {spectrum: ...}"
    )


# From the file to motions


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

    name : what tables call it
    file, how : its file and how that is read; None of a motion of the catalogue, with durations and scales of Table 1
    """

    name: str
    file: Path | None = None
    how: RecordFile | None = None


class MotionReader:
    """Finds and reads every motion once, however many scenes it drives.

    folder : of the study, which paths are relative to
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.items: Callable[[str | RecordFile], tuple[Item, ...]] = functools.cache(self._items)
        self.reading: Callable[[Item], records.Reading | Motion] = functools.cache(self._reading)

    def _reading(self, item: Item) -> records.Reading | Motion:
        """The whole motion, with how it was read where it is a file.  Raises `InputError`: it cannot be read."""
        if item.file is None or item.how is None:
            return records.find(item.name)
        more: dict[str, Any] = item.how.model_dump(exclude={"file", "name"})
        return records.read_file(item.file, name=item.name, **more)

    def motion(self, item: Item) -> Motion:
        """The whole motion; raises as `reading`."""
        found = self.reading(item)
        return found.motion if isinstance(found, records.Reading) else found

    def _items(self, record: str | RecordFile) -> tuple[Item, ...]:
        """The motions an entry of `use` stands for.  Raises `InputError` where there is none."""
        if isinstance(record, str):
            if record in records.names():
                return (Item(record),)
            is_path = re.search(r"[/\\*?]", record) or Path(record).suffix or os.path.exists(self.folder / record)
            if not is_path:
                records.entry(record)  # refuses the name, with the nearest one
            record = RecordFile(file=record)
        if len(record.file) > LONGEST_PATH:
            raise InputError(Problem(f"a path of {len(record.file)} characters", "no path is that long"))
        written = os.path.expanduser(record.file)
        files = self._files(written)
        if not files:
            message = f"there exists no motion {shortened(self.folder / written)}"
            raise InputError(Problem(message, "paths are relative to the study file"))
        if record.name is not None and len(files) > 1:
            hint = "leave it out: each is called by its file's stem"
            raise InputError(Problem(f"'name:' is one for {len(files)} files", hint))
        stems = Counter(each.stem for each in files)
        # K-NET's files of one record differ by their endings only.
        names = [each.stem if stems[each.stem] == 1 else each.name.replace(".", "-") for each in files]
        return tuple(Item(record.name or name, each, record) for each, name in zip(files, names, strict=True))

    def _files(self, written: str) -> list[Path]:
        """A file, the motions in a folder, or the files that a pattern matches."""
        path = self.folder / written
        if os.path.isdir(path):
            return [each for each in sorted(path.iterdir()) if each.is_file() and not _OTHER_FILES.search(each.name)]
        if os.path.exists(path) or "\0" in str(path):
            return [path] if os.path.exists(path) else []
        head, deep, tail = written.partition("**/")  # what lies below is visited file by file, so that it can be much
        visited = glob.iglob(f"{head}**" if deep else written, root_dir=self.folder, recursive=True)
        found = list(islice(visited, MOST_FILES + 1))
        if len(found) > MOST_FILES:
            hint = "begin the pattern nearer to the motions, e.g. `motions/**/*.AT2`"
            raise InputError(Problem(f"{shortened(path)}: more than {MOST_FILES} files and folders", hint))
        fits = (self.folder / name for name in found if not deep or PurePath(name).match(tail))
        return sorted(each for each in fits if os.path.isfile(each))


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


class _Wrong(Exception):
    """Where in the study, what is wrong, what to write."""


def motions_of(
    spec: Records, reader: MotionReader, root: Any, problems: Problems, warnings: Problems
) -> dict[str, Used]:
    """The motions of a study by name, as they are used; empty where something is wrong, which is noted."""
    motions, before = _Motions(spec, reader, root, problems, warnings), len(problems.found)
    for place, record in enumerate(spec.use):
        motions.read(record, ("records", "use", place))
    if len(problems.found) > before:
        return {}
    try:
        return motions.used()
    except _Wrong as wrong:
        path, message, hint = wrong.args
        problems.at(root, path, message, hint)
    except InputError as refused:
        motions.pass_on(refused, ("records", "scale"))
    return {}


class _Motions:
    """Motions on their way from the reader to the scenes.

    whole : by name;  known : names with durations and scales of Table 1
    """

    def __init__(self, spec: Records, reader: MotionReader, root: Any, problems: Problems, warnings: Problems) -> None:
        self.spec, self.reader, self.root, self.problems, self.warnings = spec, reader, root, problems, warnings
        self.whole: dict[str, Motion] = {}
        self.known: set[str] = set()

    def pass_on(self, refused: InputError, path: Steps) -> None:
        """Problems inside a record file keep their place; others are put at the study's line."""
        for problem in refused.problems:
            if problem.line:
                self.problems.extend([problem])
            else:
                file = f"{problem.file}: " if problem.file else ""
                self.problems.at(self.root, path, f"{file}{problem.message}", problem.hint)

    def read(self, record: Any, path: Steps) -> None:
        """Take the motions of one entry of `use`, and tell what is wrong or doubtful about them."""
        vertical, readings = list[str](), list[records.Reading]()
        try:
            items = self.reader.items(record)
        except InputError as refused:
            self.pass_on(refused, (*path, "file"))
            return
        for item in items:
            if item.name in self.whole:
                hint = "remove one, or give it another `name:`"
                self.problems.at(self.root, path, f"the record '{item.name}' occurs twice", hint)
                continue
            try:
                read, self.whole[item.name] = self.reader.reading(item), self.reader.motion(item)
            except InputError as refused:
                self.pass_on(refused, (*path, "file"))
                continue
            if item.file is None:
                self.known.add(item.name)
            elif len(items) > 1 and (_VERTICAL.search(item.file.stem) or _VERTICAL.search(item.file.name)):
                vertical.append(item.name)
            readings += [read] if isinstance(read, records.Reading) else []
        for message, hint in _doubts(vertical, readings):
            self.warnings.at(self.root, path, message, hint)

    def used(self) -> dict[str, Used]:
        """The motions cut and scaled.  Raises `_Wrong`, and `InputError` where they cannot be scaled."""
        cut, short, asked = dict[str, Motion](), list[str](), self.spec.duration
        for name, motion in self.whole.items():
            seconds = self._seconds(asked, name, motion, "duration")
            if isinstance(asked, float) and seconds > motion.duration + motion.dt:
                short.append(f"{name} ({motion.duration:g} s)")
            cut[name] = motion.windowed(seconds)
        if short:
            message = f"shorter than the {asked:g} s asked for: {listed(short)}"
            hint = "the whole length is used; `tail:` adds free vibration"
            self.warnings.at(self.root, ("records", "duration"), message, hint)
        target = self._target(cut) if isinstance(self.spec.scale, Spectrum) else None
        found = {}
        for name, factor in self._factors(cut, target).items():
            motion = cut[name].scaled(factor) if factor != 1.0 else cut[name]
            arias = float(records.arias(motion))
            use = MotionUse(name, motion.source, motion.digest, factor, motion.duration, motion.pga, arias)
            found[name] = Used(motion, use, target)
        return found

    def _seconds(self, wanted: float | str, name: str, motion: Motion, key: str) -> float:
        """The part of a motion that is used [s]; a name of Table 1 that the study does not use has its duration too."""
        has_one = name in self.known or (name not in self.whole and name in records.names())
        if wanted == "whole" or (wanted == "auto" and not has_one):
            return float(motion.duration)
        if wanted not in ("auto", "table1"):
            return float(wanted)
        if has_one:
            return float(records.entry(name).duration)
        path = ("records", key) if key == "duration" else ("records", "scale", key)
        raise _Wrong(path, f"table1 has no duration for '{name}'", "write `whole` or a time, e.g. `duration: 10 s`")

    def _other(self, name: str, key: str) -> Motion:
        """A motion that others are scaled to, whole: of the study or of the catalogue."""
        if name in self.whole:
            return self.whole[name]
        if name in records.names():
            return self.reader.motion(Item(name))
        known = dict.fromkeys((*self.whole, *records.names()))
        raise _Wrong(("records", "scale", key), f"no record '{name}'", nearest(name, known))

    def _target(self, cut: dict[str, Motion]) -> records.TargetSpectrum:
        """The target as a spectrum over its range."""
        scale: Any = self.spec.scale
        name, ends = scale.target, (scale.low, scale.high, scale.damping)
        if isinstance(name, dict):
            periods, values = zip(*sorted(name.items()), strict=True)
            return records.TargetSpectrum(periods, values, *ends)
        motion = cut.get(name)
        if motion is None:
            whole = self._other(name, "target")
            motion = whole.windowed(self._seconds(self.spec.duration, name, whole, "duration"))
        return records.TargetSpectrum.of(motion, *ends)

    def _factors(self, cut: dict[str, Motion], target: records.TargetSpectrum | None) -> dict[str, float]:
        scale: Any = self.spec.scale
        match scale:
            case "table1":
                for name in cut.keys() - self.known:
                    hint = "write a factor, {arias: NAME}, {pga: 0.35 g}, {sa: 0.8 g, period: 0.5 s} or {spectrum: ...}"
                    raise _Wrong(("records", "scale"), f"table1 has no scale for '{name}'", hint)
                return {name: float(records.entry(name).scale) for name in cut}
            case Pga():
                return {name: records.scale_factor(each, each.pga, scale.pga) for name, each in cut.items()}
            case Pgv():
                return {name: records.scale_factor(each, records.pgv(each), scale.pgv) for name, each in cut.items()}
            case Sa():
                found = {name: records.spectrum(each, (scale.period,), scale.damping)[0] for name, each in cut.items()}
                return {name: records.scale_factor(cut[name], sa, scale.sa) for name, sa in found.items()}
            case Spectrum() if target is not None:
                return records.spectrum_factors(cut, target, scale.spectrum == "each", scale.at_least)
            case Arias():
                reference = self._other(scale.arias, "arias")
                window = self.spec.duration if scale.window == "duration" else scale.window
                part = {
                    name: motion.windowed(self._seconds(window, name, motion, "window"))
                    for name, motion in {scale.arias: reference, **self.whole}.items()
                }
                one = part[scale.arias]
                return {
                    name: 1.0 if name == scale.arias else records.arias_factor(part[name], one) for name in self.whole
                }
        return dict.fromkeys(cut, float(scale))


def _doubts(vertical: Sequence[str], readings: Sequence[records.Reading]) -> Iterator[tuple[str, str]]:
    """Message and hint of files named like vertical components, of time steps that no accelerograph has, and of units
    other than the study's that the files state."""
    if vertical:
        hint = "name the horizontal ones, e.g. `{file: motions/*.NS}`"
        yield f"named like vertical components, will shake the buildings sideways: {listed(vertical)}", hint
    doubts: dict[records.Doubt, list[str]] = {}
    against: dict[tuple[str, str], list[str]] = {}
    for each in readings:
        for doubt in each.doubts:
            doubts.setdefault(doubt, []).append(each.motion.name)
        if each.stated:
            against.setdefault((each.unit, each.stated), []).append(each.motion.name)
    for doubt, names in doubts.items():
        yield f"{listed(names)}: {doubt.message}", doubt.hint
    for (unit, stated), names in against.items():
        message = f"{listed(names)}: read in {unit}, as the study says, although the file says {stated}"
        yield message, "remove `unit:` if the file is right"
