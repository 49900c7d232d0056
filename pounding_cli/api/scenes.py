"""One scene by hand: buildings, a motion and what stands between, in the words and units of a study."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli import records
from pounding_cli.errors import InputError, Issue
from pounding_cli.model.building import Building
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Analysis, Scene
from pounding_cli.records.motion import Motion
from pounding_cli.study.data import building_of, by_place, links_between, quantity
from pounding_cli.study.schema.quantity import ACCELERATION, TIME, Quantity

if TYPE_CHECKING:
    from pounding_cli.results.histories import History

_SCALE = Quantity("scale", "", "1.5", 0.0, 1000.0, open_low=True)
_TAIL = TIME.replace(name="tail", example="5 s", open_low=False)
_EVERY = TIME.replace(name="output step", example="2 ms")


def building(name: str, **keys: Any) -> Building:
    """A building from the keys of a study's building, with the same defaults.

    Parameters
    ----------
    name : what tables and figures call it
    keys : `storeys`, `period`, `mass`, `height`, `taper`, `stiffness`, `damping`, `hardening`, `yield_` (for `yield`),
        `yield_shear`, `p_delta`, `collapse`,
        `foundation`: SI numbers or texts with units, one value or a list from the ground up

    Raises
    ------
    InputError : with every problem found, each at its key
    """
    return building_of(name, {key.rstrip("_"): value for key, value in keys.items()})


def motion(
    source: str | Path | Any,
    *,
    dt: float | str | None = None,
    unit: str | None = None,
    name: str | None = None,
    duration: float | str = "whole",
    scale: float = 1.0,
    pga: float | str | None = None,
    **declared: Any,
) -> Motion:
    """A ground motion from an array, a file or the catalogue.

    Parameters
    ----------
    source : accelerations, shape (n,), n >= 2; or the path of a file; or a name that `pound records list` shows; or a
        motion of a set, "far-field/KOBE-NIS000"
    dt : time step [s]; needed for an array, and for a plain file without times
    unit : of the accelerations: m/s2 for an array unless given; a plain file needs it
    name : what tables and figures call it; "motion", the file's stem or the catalogue's name unless given
    duration : how much of it is used [s]; "whole" for all
    scale : factor on it [-]
    pga : peak it is scaled to instead [m/s2]
    declared : the other keys of a file in a study: `time`, `column`, `skip`, `rows`, `separator`, `decimal`,
        `thousands`, `format`, `channel`, `baseline` (`records.Declaration`)

    Raises
    ------
    InputError : no such motion, a file that cannot be read, a missing time step, an unknown unit
    """
    known = [field.name for field in fields(records.Declaration)]
    unknown = next((key for key in declared if key not in known), None)
    if unknown is not None:
        raise InputError(f"unknown key '{unknown}' of a motion file", f"write one of {', '.join(known)}")
    if isinstance(source, str | Path):
        step = None if dt is None else quantity(TIME, dt, "dt")
        record = _named_or_read(source, records.Declaration(dt=step, unit=unit, **declared))
    else:
        record = _from_array(source, dt, unit)
    record = record if not name else replace(record, name=name)
    if duration != "whole":
        record = record.cut_to(quantity(TIME, duration, "duration"))
    if pga is None:
        return record.scale_by(quantity(_SCALE, scale, "scale")) if scale != 1.0 else record
    if scale != 1.0:
        raise InputError("both 'scale' and 'pga' are given", "leave one of them out")
    return record.scale_by(records.scale_factor(record, record.pga, quantity(ACCELERATION, pga, "pga")))


def scene(
    buildings: Sequence[Building],
    motion: Motion,
    *,
    analysis: str = "inelastic",
    link: str = "pounding",
    links: Sequence[Link] | Sequence[str | Mapping[str, Any]] | None = None,
    impact: Mapping[str, Any] | None = None,
    tail: float | str = 0.0,
    **case: Any,
) -> Scene:
    """A scene: buildings side by side, what stands between them, and one motion.

    Parameters
    ----------
    buildings : left to right; one alone has no links
    motion : as used, cut and scaled
    analysis : "elastic" or "inelastic"
    link : "pounding", "infill", "connector", ... or "none", between all floors at one elevation
    links : several, in place of `link`: entries of a study's `links`, which take the keys of the case; or the links
        themselves, in place of these keys too
    impact : keys of a study's `impact` (`stiffness`, `restitution`, `tension_cut`, ...)
    tail : free vibration after the motion [s]
    case : keys of a study's case: `gap` (needed unless `link` is none), `stiffness`, `floors`, ...

    Raises
    ------
    InputError : with every problem found, each at its key
    """
    if analysis not in list(Analysis):
        raise InputError(
            Issue((), f"the analysis '{analysis}' is not known", "write elastic or inelastic", file="analysis")
        )
    row = by_place(buildings)
    time = quantity(_TAIL, tail, "tail")
    between = [link for link in links or () if isinstance(link, Link)]
    if links is not None and len(between) == len(links):
        if case:
            raise InputError(f"'links' leaves no place for {', '.join(case)}", "give one or the other")
    elif len(row) > 1:
        link_keys = {"link": link} if links is None else {"links": links}
        between = list(links_between(row, {**link_keys, **case}, impact or {}))
    try:
        return Scene(row, tuple(between), motion, Analysis(analysis), time)
    except ValueError as error:
        raise InputError(str(error)) from None


def history(scene: Scene, every: float | str = "2 ms", accuracy: float = 1e-6) -> History:
    """Run a scene and keep what it does over time.

    Parameters
    ----------
    scene : what to run
    every : output step [s]
    accuracy : as in `solve` [-]

    Raises
    ------
    InputError : the output step is not above zero; the run did not end, and why
    """
    from pounding_cli.results.histories import History, to_arrays
    from pounding_cli.solver.histories import solve_history

    return History(to_arrays(solve_history(scene, accuracy, quantity(_EVERY, every, "every"))).to_dataset())


def _from_array(values: Any, dt: float | str | None, unit: str | None) -> Motion:
    factor = records.find_acceleration_unit(unit or "m/s2")
    if factor is None:
        raise InputError(
            f"unknown unit '{unit}' of acceleration", f"write one of {', '.join(records.ACCELERATION_UNITS)}"
        )
    if dt is None:
        raise InputError("an array does not say its time step", "give it: dt=0.01, or dt='10 ms'")
    step = quantity(TIME, dt, "dt")
    try:
        return Motion("motion", step, factor * np.asarray(values, dtype=float))
    except (TypeError, ValueError) as error:
        raise InputError(str(error), "give accelerations in equal steps of time, shape (n,)") from None


def _named_or_read(source: str | Path, declared: records.Declaration) -> Motion:
    word = str(source)
    is_of_set = isinstance(source, str) and records.find_set_name(word) is not None and not os.path.exists(word)
    if is_of_set or (isinstance(source, str) and word in records.list_names()):
        if given := declared.list_given():
            kind = "motion of a set" if is_of_set else "catalogue motion"
            message = f"'{word}' is a {kind}; its time step and unit are fixed"
            raise InputError(message, f"leave {' and '.join(map(repr, given))} out")
        if is_of_set:
            return records.read_set_motion(records.get_set_motion(word))
        return records.load_motion(word)
    if isinstance(source, str) and not (Path(word).suffix or os.path.exists(word) or set("/\\") & set(word)):
        records.get_entry(word, records.MOTION_SETS)  # refuses it, with the nearest name
    return records.read_file(Path(word).expanduser(), declared).motion
