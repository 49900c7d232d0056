"""Times beside samples: even steps are taken, uneven ones refused at their line."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pounding_cli.records.formats.text import Text

_UNEVEN = 0.02
# Times are often printed with few digits; a sample may stand off its even place by this part of a step,
_DIGITS = 0.51
# or by this part of the last digit printed, where the steps themselves are rounded to it.
_LATEST = 1e6


def even_step(
    text: Text,
    times: Sequence[float],
    lines: Sequence[int],
    given: float | None,
    way_out: str = "resample the record to even steps, or restore the missing samples",
    digits: int | None = None,
) -> float:
    """The time step [s] of evenly rising `times` [s].

    lines : their indices in the file; given : the step the user gave; digits : decimals the times are printed with
    Raises `InputError` for times that fall or stand, uneven steps, and a step other than `given`.
    """
    t = np.array(times, dtype=float)
    if t.size < 2:
        raise text.refuse("only one sample found", "a motion needs at least two samples", lines[0] + 1)
    if np.abs(t).max() > _LATEST:
        worst = int(np.abs(t).argmax())
        raise text.refuse(f"the time {t[worst]:g} s is no time of a record", "write times in s", lines[worst] + 1)
    falling = np.flatnonzero(np.diff(t) <= 0)
    if falling.size:
        raise text.refuse(
            f"the time {t[falling[0] + 1]:g} s does not come after {t[falling[0]]:g} s",
            "write the times in rising order; for values printed row by row say format 'column' and dt",
            lines[falling[0] + 1] + 1,
        )
    step = float(f"{(t[-1] - t[0]) / (t.size - 1):.9g}")
    if given is None:
        step = text.step(step, lines[0] + 1)
    else:
        # A given step is the exact one; times printed with few digits only have to agree with it.
        mean = text.same_step(given, step, lines[0] + 1)
        step = given if abs(given - mean) * (t.size - 1) <= _UNEVEN * mean else mean
    allowed = max(_UNEVEN * step, 0.0 if digits is None else min(_DIGITS * 10.0**-digits, 0.25 * step))
    off = np.abs(t - t[0] - step * np.arange(t.size))
    if off.max() > allowed:
        gaps = np.diff(t)
        usual = float(np.median(gaps))
        worst = int(np.argmax(np.abs(gaps - usual)))
        raise text.refuse(
            f"uneven time steps: {gaps[worst]:.6g} s here, {usual:.6g} s elsewhere", way_out, lines[worst + 1] + 1
        )
    return step
