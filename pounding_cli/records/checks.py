"""Check by physics that samples are a ground acceleration: what knows no language finds a wrong unit or column.

What the ground cannot do is refused, with the key that settles it; what it seldom does is warned.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from pounding_cli.cells import TextFile
from pounding_cli.errors import Issue
from pounding_cli.numbers import pluralize
from pounding_cli.records.declaration import KEPT, MEAN, Declaration
from pounding_cli.records.motion import Motion, displacement, pgv, velocity
from pounding_cli.records.samples import Samples
from pounding_cli.records.units import ACCELERATION_UNITS, find_acceleration_unit, find_stated_units
from pounding_cli.units import GRAVITY

MAX_PEAK = 5.0 * GRAVITY
"""Peak beyond which the unit is wrong [m/s2]: the strongest ground acceleration recorded is nearly 4 g, vertical, at
IWTH25 in Iwate-Miyagi 2008 (Aoi, Kunugi and Fujiwara, 2008, Science 322, 727-730)."""

MAX_USUAL_STEP = 0.05
"""Accelerographs sample at 50 Hz at least; a longer step is most often a sample number taken for a time [s]."""

MIN_USUAL_STEP = 0.001
"""Few accelerographs sample at more than 1000 Hz; a shorter step is most often minutes taken for seconds [s]."""

MAX_USUAL_DISPLACEMENT = 10.0
"""The ground beside a fault that broke moved by up to ten metres [m]: Chi-Chi 1999 by 9.9 m (Yang et al., 2000, Earth
Planets Space 52, 403-413, doi:10.1186/BF03352252); the two sides of the Kekerengu fault moved by 12 m against each
other in Kaikoura 2016 (Kearse et al., 2018, Bull. Seism. Soc. Am. 108(3B), 1605-1619)."""

MAX_DISPLACEMENT = 10.0 * MAX_USUAL_DISPLACEMENT
"""Ten times what the ground ever did: beyond, the samples have an offset, or are no acceleration [m]."""

MAX_USUAL_END_VELOCITY = 0.25
"""The ground rests when shaking ends.  Velocity at the end over the peak velocity that the motion has without its mean
[-]; the processed motions of Table 1 have 0.07 at most."""

MAX_USUAL_MEAN = 0.002
"""Mean of the samples over their peak [-]; the processed motions of Table 1 have 0.0002 at most."""

REPEATED_RATIO = 3.0
"""An extreme that stands there twice, so many times all others, is no sample but a mark for missing ones [-]."""


def check_samples(text: TextFile, samples: Samples, declared: Declaration) -> Iterator[Issue]:
    """Yield warnings about the samples of a file as they stand there.

    Raises
    ------
    InputError : every sample is zero, only one, a mark for missing samples among them
    """
    if samples.values.size < 2:
        raise text.refuse("only one sample found", "a motion needs at least two samples", samples.line)
    sizes = np.abs(samples.values)
    largest = float(sizes.max())
    if largest == 0.0:
        raise text.refuse("every sample is zero", "give a file that holds a ground motion", samples.line)
    yield from _check_extreme(text, samples, sizes, largest, declared.baseline == KEPT)
    if samples.dt < MIN_USUAL_STEP * (1 - 1e-6):
        message = f"the time step is {samples.dt:g} s, shorter than the {MIN_USUAL_STEP:g} s of any accelerograph"
        yield Issue((), message, "check that the times are in seconds; write `dt:` if they are not", code="time-step")
    if samples.dt > MAX_USUAL_STEP * (1 + 1e-6):
        message = f"the time step is {samples.dt:g} s, longer than the {MAX_USUAL_STEP:g} s of any accelerograph"
        hint = "check `dt:`" if declared.dt is not None else "check that the column of times is no sample number"
        yield Issue((), message, hint, code="time-step")
    stated = find_stated_units(samples.heading)
    for line in samples.unread if not stated else ():
        stated += find_stated_units(line.words)
    if stated and not any(_is_one_unit(each, samples.unit) for each in stated):
        message = f"read in {samples.unit}, as declared, although the file says {stated[0]}"
        yield Issue((), message, f"write `unit: {stated[0]}` if the file is right", code="stated-unit")


def _is_one_unit(stated: str, declared: str) -> bool:
    """Return whether a unit that is stated is the one declared, or one of which that is a multiple, 0.01 g."""
    size = find_acceleration_unit(stated)
    words = declared.split()
    sizes = {find_acceleration_unit(declared), find_acceleration_unit(words[-1])}
    return any(each is not None and size is not None and abs(each / size - 1) < 1e-6 for each in sizes)


def _check_extreme(
    text: TextFile, samples: Samples, sizes: np.ndarray, largest: float, is_meant: bool
) -> Iterator[Issue]:
    """Yield a warning where one sample is far beyond all others.

    is_meant : whether spikes may be

    Raises
    ------
    InputError : one value stands there several times, far beyond all others, or is -999, 9999 and the like
    """
    is_extreme = sizes == largest
    others = float(sizes[~is_extreme].max(initial=0.0))
    if others == 0.0:
        return
    count = int(is_extreme.sum())
    value = float(samples.values[is_extreme][0])
    ratio = largest / others
    is_nines = largest.is_integer() and largest >= 999 and set(f"{largest:.0f}") == {"9"}
    place = int(np.argmax(sizes))
    is_repeated = count > 1 and ratio > REPEATED_RATIO and not is_meant
    if is_repeated or (is_nines and (count > 1 or ratio > 1.5)):
        times = pluralize(count, "time")
        message = (
            f"{value:g} stands {times} among the samples, and the largest other is {others:g}: samples are missing"
        )
        raise text.refuse(message, "cut the record before the gap; `rows:` ends it there", samples.find_line(place))
    if ratio > REPEATED_RATIO and not is_meant:
        when = f"{samples.dt * place:g} s, line {samples.find_line(place)}"
        message = f"one sample, {value:g} at {when}, is {ratio:.3g} times the largest other"
        hint = "check that it is no spike; `skip:` passes over a number above the samples"
        yield Issue((), message, hint, code="spike")


def check_motion(text: TextFile, motion: Motion, samples: Samples, declared: Declaration) -> Iterator[Issue]:
    """Yield warnings about a motion.

    Peaks above 2 g are warned of as they are used (`study.warnings`).

    Raises
    ------
    InputError : a peak above 5 g; values of one sign, or a displacement that no ground has, unless they are meant so
    """
    peak = motion.pga
    in_g = f"{peak / GRAVITY:.4g} g"
    if peak > MAX_PEAK:
        line = samples.find_line(int(np.argmax(np.abs(motion.acceleration))))
        message = f"the peak is {in_g} read in {samples.unit}, on line {line}: no ground motion is that strong"
        hint = f"give the unit of the file: {', '.join(ACCELERATION_UNITS)}; recorder counts need their scale"
        raise text.refuse(message, f"{hint}, e.g. 6.34e-4 gal", line)
    yield from _check_drift(text, motion, samples, declared)


def _check_drift(text: TextFile, motion: Motion, samples: Samples, declared: Declaration) -> Iterator[Issue]:
    """Yield a warning where the ground drifts away.

    Raises
    ------
    InputError : it goes where no ground does, or is pushed one way, unless that is meant
    """
    values = motion.acceleration
    is_meant = declared.baseline == KEPT
    cure = "write `baseline: mean` to take the mean away, or `baseline: kept` if it is meant so"
    if declared.baseline == MEAN:
        cure = "correct the baseline of the record, or write `baseline: kept` if it is meant so"
    if not is_meant and (values.min() >= 0 or values.max() <= 0):
        message = "all samples have one sign: a spectrum, a displacement or a push, no ground motion"
        hint = "declare the column of the acceleration, `column:`; write `baseline: mean` if an offset is in it, or "
        hint += "`baseline: kept` if it is meant so"
        raise text.refuse(message, hint, samples.line)
    reach = float(np.abs(displacement(motion)).max())
    end = float(velocity(motion)[-1])
    without_mean = Motion(motion.name, motion.dt, values - values.mean())
    words = f"the samples have a mean of {values.mean():.3g} m/s2, so that the ground ends at {end:.3g} m/s"
    words += f", up to {reach:.3g} m away"
    if abs(values.mean()) < 1e-6 * motion.pga:
        words = f"the ground goes up to {reach:.3g} m away"
        cure = "check the time step, `dt:` or `time:`; write `baseline: kept` if it is meant so"
    if reach > MAX_DISPLACEMENT and not is_meant:
        raise text.refuse(f"{words}; no ground goes beyond {MAX_DISPLACEMENT:g} m", cure, samples.line)
    drifts = abs(end) > MAX_USUAL_END_VELOCITY * pgv(without_mean) and abs(values.mean()) > MAX_USUAL_MEAN * motion.pga
    if not is_meant and (drifts or reach > MAX_USUAL_DISPLACEMENT):
        yield Issue((), words, cure, code="drifting-ground")
