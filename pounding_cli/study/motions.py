"""From the records of the study file to motions: found, cut to their windows, scaled."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

from pounding_cli import records
from pounding_cli.errors import InputError
from pounding_cli.numbers import listed
from pounding_cli.records import Motion
from pounding_cli.study.motion_reader import MotionReader
from pounding_cli.study.plan import MotionUse
from pounding_cli.study.problems import Problems, Tree, nearest
from pounding_cli.study.record_schema import AriasScale, PgaScale, PgvScale, Records, SaScale, SpectrumScale
from pounding_cli.study.source import Node


@dataclass(frozen=True)
class Used:
    """A motion as it is used, what the tables say of it, and the target spectrum it was scaled to (None: to none)."""

    motion: Motion
    use: MotionUse
    target: records.TargetSpectrum | None = None


def motions_of(
    spec: Records, reader: MotionReader, root: Node | Tree, problems: Problems, warnings: Problems
) -> dict[str, Used]:
    """The motions of a study by name, as they are used; what is wrong is noted in `problems`."""
    found: dict[str, Motion] = {}
    names: set[str] = set()
    sound = True
    for place, record in enumerate(spec.use):
        path = ("records", "use", place)
        vertical: list[str] = []
        readings: list[records.Reading] = []
        try:
            items = reader.items(record)
        except InputError as refused:
            _pass_on(refused, root, (*path, "file"), problems)
            sound = False
            continue
        for item in items:
            if item.name in found:
                problems.at(
                    root, path, f"the record '{item.name}' occurs twice", "remove one, or give it another `name:`"
                )
                sound = False
                continue
            if item.vertical:
                vertical.append(item.name)
            if item.known:
                names.add(item.name)
            try:
                found[item.name] = reader.take(record, item)
            except InputError as refused:
                _pass_on(refused, root, (*path, "file"), problems)
                sound = False
                continue
            read = reader.reading(record, item)
            if isinstance(read, records.Reading):
                readings.append(read)
        _tell_vertical(vertical, root, path, warnings)
        _tell_units(readings, root, path, warnings)
    if not sound:
        return {}
    cut: dict[str, Motion] = {}
    short: dict[str, Motion] = {}
    for name, motion in found.items():
        seconds = _seconds(spec.duration, name, name in names, motion, root, ("records", "duration"), problems)
        if seconds is None:
            return {}
        if isinstance(spec.duration, float) and seconds > motion.duration + motion.dt:
            short[name] = motion
        cut[name] = motion.windowed(seconds)
    _tell_short(short, spec.duration, root, warnings)
    target = None
    if isinstance(spec.scale, SpectrumScale):
        try:
            target = _target(spec.scale, spec, found, cut, reader, root, problems)
        except InputError as refused:
            _pass_on(refused, root, ("records", "scale"), problems)
        if target is None:
            return {}
    factors = _factors(spec, found, cut, names, target, reader, root, problems)
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
        used[name] = Used(motion, use, target)
    return used


def _tell_vertical(names: list[str], root: Node | Tree, path: tuple[str | int, ...], warnings: Problems) -> None:
    """Warn of files that are named like vertical components."""
    if not names:
        return
    what = f"'{names[0]}' looks like a vertical component; it will"
    if len(names) > 1:
        what = f"{len(names)} motions look like vertical components and will"
    whole = f": {listed(names)}" if len(names) > 1 else ""
    hint = "name the horizontal ones, e.g. `{file: motions/*.NS}`"
    warnings.at(root, path, f"{what} shake the buildings sideways{whole}", hint)


def _tell_units(
    readings: list[records.Reading], root: Node | Tree, path: tuple[str | int, ...], warnings: Problems
) -> None:
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


def _tell_short(motions: dict[str, Motion], seconds: float | str, root: Node | Tree, warnings: Problems) -> None:
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


def _pass_on(refused: InputError, root: Node | Tree, path: tuple[str | int, ...], problems: Problems) -> None:
    """Problems inside a record file keep their place; others are put at the study's line."""
    for problem in refused.problems:
        if problem.line:
            problems.extend([problem])
        else:
            file = f"{problem.file}: " if problem.file else ""
            problems.at(root, path, f"{file}{problem.message}", problem.hint)


def _seconds(
    duration: float | str,
    name: str,
    known: bool,
    motion: Motion,
    root: Node | Tree,
    path: tuple[str, ...],
    problems: Problems,
) -> float | None:
    if duration == "whole" or (duration == "auto" and not known):
        return motion.duration
    if duration not in ("auto", "table1"):
        return float(duration)
    if not known:
        problems.at(
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
    target: records.TargetSpectrum | None,
    reader: MotionReader,
    root: Node | Tree,
    problems: Problems,
) -> dict[str, float]:
    scale, path = spec.scale, ("records", "scale")
    if isinstance(scale, float):
        return dict.fromkeys(cut, scale)
    for name in cut:
        if scale == "table1" and name not in names:
            problems.at(
                root,
                path,
                f"table1 has no scale for '{name}'",
                "write a factor, {arias: NAME}, {pga: 0.35 g}, {sa: 0.8 g, period: 0.5 s} or {spectrum: ...}",
            )
            return {}
    if scale == "table1":
        return {name: float(records.entry(name).scale) for name in cut}
    try:
        if isinstance(scale, PgaScale):
            return {name: records.pga_factor(motion, scale.pga) for name, motion in cut.items()}
        if isinstance(scale, PgvScale):
            return {name: records.pgv_factor(motion, scale.pgv) for name, motion in cut.items()}
        if isinstance(scale, SaScale):
            return {
                name: records.sa_factor(motion, scale.sa, scale.period, scale.damping) for name, motion in cut.items()
            }
        if isinstance(scale, SpectrumScale):
            assert target is not None
            return records.spectrum_factors(cut, target, scale.spectrum == "each", scale.at_least)
        assert isinstance(scale, AriasScale)
        return _arias_factors(scale, spec, whole, names, reader, root, problems)
    except InputError as refused:
        _pass_on(refused, root, path, problems)
        return {}


def _arias_factors(
    scale: AriasScale,
    spec: Records,
    whole: dict[str, Motion],
    names: set[str],
    reader: MotionReader,
    root: Node | Tree,
    problems: Problems,
) -> dict[str, float]:
    part = partial(_measured, scale, spec, root=root, problems=problems)
    reference = whole.get(scale.arias) or _reference(
        scale.arias, ("records", "scale", "arias"), whole, reader, root, problems
    )
    if reference is None:
        return {}
    target = part(scale.arias, scale.arias in names or scale.arias not in whole, reference)
    factor = {}
    for name, motion in whole.items():
        own = part(name, name in names, motion)
        if own is None or target is None:
            return {}
        factor[name] = 1.0 if name == scale.arias else records.arias_factor(own, target)
    return factor


def _target(
    scale: SpectrumScale,
    spec: Records,
    whole: dict[str, Motion],
    cut: dict[str, Motion],
    reader: MotionReader,
    root: Node | Tree,
    problems: Problems,
) -> records.TargetSpectrum | None:
    """The target as a spectrum over its range; what is wrong with it is noted in `problems`."""
    path = ("records", "scale")
    if not scale.low < scale.high:
        message = f"the range of periods runs from {scale.low:g} s to {scale.high:g} s"
        problems.at(root, (*path, "to"), message, "write `to:` above `from:`, e.g. `from: 0.2 s, to: 1.2 s`")
        return None
    if isinstance(scale.target, dict):
        points = sorted(scale.target.items())
        if len(points) < 2:
            problems.at(
                root,
                (*path, "target"),
                "a target spectrum needs two points at least",
                "write {0.1 s: 0.8 g, 2 s: 0.2 g}",
            )
            return None
        if not points[0][0] <= scale.low or not scale.high <= points[-1][0]:
            message = f"the target is given from {points[0][0]:g} to {points[-1][0]:g} s, not over the whole range"
            problems.at(root, (*path, "target"), message, f"give it from {scale.low:g} to {scale.high:g} s at least")
            return None
        periods, values = zip(*points, strict=True)
        return records.TargetSpectrum(periods, values, scale.low, scale.high, scale.damping)
    motion = cut.get(scale.target)
    if motion is None:
        reference = _reference(scale.target, (*path, "target"), whole, reader, root, problems)
        if reference is None:
            return None
        seconds = _seconds(spec.duration, scale.target, True, reference, root, ("records", "duration"), problems)
        assert seconds is not None  # the catalogue has a duration for each of its names
        motion = reference.windowed(seconds)
    return records.TargetSpectrum.of(motion, scale.low, scale.high, scale.damping)


def _reference(
    name: str,
    path: tuple[str, ...],
    whole: dict[str, Motion],
    reader: MotionReader,
    root: Node | Tree,
    problems: Problems,
) -> Motion | None:
    known = records.names()
    if name not in known:
        problems.at(root, path, f"no record '{name}'", nearest(name, dict.fromkeys((*whole, *known))))
        return None
    return reader.named(name)


def _measured(
    scale: AriasScale,
    spec: Records,
    name: str,
    known: bool,
    motion: Motion,
    root: Node | Tree,
    problems: Problems,
) -> Motion | None:
    """The part of a motion its Arias intensity is measured over."""
    window = spec.duration if scale.window == "duration" else scale.window
    seconds = _seconds(window, name, known, motion, root, ("records", "scale", "window"), problems)
    return None if seconds is None else motion.windowed(seconds)
