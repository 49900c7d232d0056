"""From the records of the study file to motions: found, cut to their windows, scaled."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from pathlib import Path

from pounding_cli import records
from pounding_cli.errors import InputError, Problem
from pounding_cli.records import Motion
from pounding_cli.study.plan import MotionUse
from pounding_cli.study.problems import Faults, Tree, nearest
from pounding_cli.study.schema import AriasScale, PgaScale, RecordFile, Records
from pounding_cli.study.source import Node


@dataclass(frozen=True)
class Used:
    """A motion as it is used, and what the tables say of it."""

    motion: Motion
    use: MotionUse


class Shelf:
    """Reads every motion once, however many scenes it drives."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._read: dict[str | RecordFile, Motion | InputError] = {}

    def take(self, record: str | RecordFile) -> Motion:
        """The whole motion; raises `InputError` where there is none."""
        if record not in self._read:
            try:
                self._read[record] = self._fresh(record)
            except InputError as refused:
                self._read[record] = refused
        found = self._read[record]
        if isinstance(found, InputError):
            raise found
        return found

    def _fresh(self, record: str | RecordFile) -> Motion:
        if isinstance(record, str):
            return records.find(record)
        path = self.folder / Path(record.file).expanduser()
        if not path.is_file():
            what = "is a folder" if path.is_dir() else "does not exist"
            raise InputError(Problem(f"the record file {path} {what}", "paths are relative to the study file"))
        return records.read_motion(path, name=name_of(record), unit=record.unit, dt=record.dt, format=record.format)


def name_of(record: str | RecordFile) -> str:
    """What tables call a record: its catalogue name, its `name:`, or its file's stem."""
    return record if isinstance(record, str) else (record.name or Path(record.file).stem)


def motions_of(spec: Records, shelf: Shelf, root: Node | Tree, faults: Faults, warnings: Faults) -> dict[str, Used]:
    """The motions of a study by name, as they are used; what is wrong is noted in `faults`."""
    found: dict[str, Motion] = {}
    for place, record in enumerate(spec.use):
        path = ("records", "use", place)
        name = name_of(record)
        if name in found:
            faults.at(root, path, f"the record '{name}' stands twice", "remove one, or give it another `name:`")
            continue
        try:
            found[name] = shelf.take(record)
        except InputError as refused:
            _pass_on(refused, root, (*path, "file"), faults)
    if len(found) < len(spec.use):
        return {}
    names = {name_of(record) for record in spec.use if isinstance(record, str)}
    cut: dict[str, Motion] = {}
    for name, motion in found.items():
        seconds = _seconds(spec.duration, name, name in names, motion, root, ("records", "duration"), faults)
        if seconds is None:
            return {}
        if isinstance(spec.duration, float) and seconds > motion.duration + motion.dt:
            message = f"'{name}' lasts {motion.duration:g} s, shorter than the {seconds:g} s asked for"
            warnings.at(
                root,
                ("records", "duration"),
                message,
                "its whole length is used; `tail:` adds free vibration",
            )
        cut[name] = motion.windowed(seconds)
    factors = _factors(spec, found, cut, names, shelf, root, faults)
    used = {}
    for name, factor in factors.items():
        motion = cut[name].scaled(factor) if factor != 1.0 else cut[name]
        use = MotionUse(
            name,
            motion.source,
            motion.digest,
            factor,
            motion.duration,
            motion.pga,
            float(records.arias(motion)),
        )
        used[name] = Used(motion, use)
    return used


def _pass_on(refused: InputError, root: Node | Tree, path: tuple[str | int, ...], faults: Faults) -> None:
    """Problems inside a record file keep their place; others are put at the study's line."""
    for problem in refused.problems:
        if problem.line:
            faults.extend([problem])
        else:
            faults.at(root, path, problem.message, problem.hint)


def _seconds(
    duration: float | str,
    name: str,
    known: bool,
    motion: Motion,
    root: Node | Tree,
    path: tuple[str, ...],
    faults: Faults,
) -> float | None:
    if duration == "whole":
        return motion.duration
    if duration != "table1":
        return float(duration)
    if not known:
        faults.at(
            root,
            path,
            f"table1 has no duration for '{name}'",
            "write `whole` or a time, e.g. `duration: 10 s`",
        )
        return None
    return float(records.entry(name).duration)


def _factors(
    spec: Records,
    whole: dict[str, Motion],
    cut: dict[str, Motion],
    names: set[str],
    shelf: Shelf,
    root: Node | Tree,
    faults: Faults,
) -> dict[str, float]:
    scale, path = spec.scale, ("records", "scale")
    factor: dict[str, float] = {}
    if isinstance(scale, float):
        return dict.fromkeys(cut, scale)
    for name in cut:
        if scale == "table1" and name not in names:
            faults.at(
                root,
                path,
                f"table1 has no scale for '{name}'",
                "write a factor, {arias: NAME} or {pga: 0.35 g}",
            )
            return {}
    if scale == "table1":
        return {name: float(records.entry(name).scale) for name in cut}
    try:
        if isinstance(scale, PgaScale):
            return {name: records.pga_factor(motion, scale.pga) for name, motion in cut.items()}
        assert isinstance(scale, AriasScale)
        part = partial(_measured, scale, spec, root=root, faults=faults)
        reference = whole.get(scale.arias) or _reference(scale.arias, whole, shelf, root, faults)
        if reference is None:
            return {}
        target = part(scale.arias, scale.arias in names or scale.arias not in whole, reference)
        for name, motion in whole.items():
            own = part(name, name in names, motion)
            if own is None or target is None:
                return {}
            factor[name] = 1.0 if name == scale.arias else records.arias_factor(own, target)
    except InputError as refused:
        _pass_on(refused, root, path, faults)
        return {}
    return factor


def _reference(name: str, whole: dict[str, Motion], shelf: Shelf, root: Node | Tree, faults: Faults) -> Motion | None:
    known = records.names()
    if name not in known:
        faults.at(
            root,
            ("records", "scale", "arias"),
            f"no record '{name}'",
            nearest(name, dict.fromkeys((*whole, *known))),
        )
        return None
    return shelf.take(name)


def _measured(
    scale: AriasScale,
    spec: Records,
    name: str,
    known: bool,
    motion: Motion,
    root: Node | Tree,
    faults: Faults,
) -> Motion | None:
    """The part of a motion its Arias intensity is measured over."""
    window = spec.duration if scale.window == "duration" else scale.window
    seconds = _seconds(window, name, known, motion, root, ("records", "scale", "window"), faults)
    return None if seconds is None else motion.windowed(seconds)
