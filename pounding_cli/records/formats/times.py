"""Times beside samples: even steps are taken, uneven ones refused at their line."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pounding_cli.records.formats.text import Text

_UNEVEN = 0.02
# Times are often printed with few digits; a sample may stand off its even place by this part of a step,
_DIGITS = 1.02
# or by the last digit printed (half of it for the sample, half for the last, which the step comes from),
# where that is less than a quarter of a step.
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
        raise text.refuse(f"the time {t[worst]:g} s is not a valid time", "write times in s", lines[worst] + 1)
    falling = np.flatnonzero(np.diff(t) <= 0)
    if falling.size:
        raise text.refuse(
            f"the time {t[falling[0] + 1]:g} s does not come after {t[falling[0]]:g} s",
            "write the times in rising order; for values printed row by row say format 'column' and dt",
            lines[falling[0] + 1] + 1,
        )
    step = float(f"{(t[-1] - t[0]) / (t.size - 1):.9g}")
    step = text.step(step, lines[0] + 1) if given is None else text.same_step(given, step, lines[0] + 1)
    allowed = max(_UNEVEN * step, 0.0 if digits is None else min(_DIGITS * 10.0**-digits, 0.25 * step))
    places = np.arange(t.size)
    if given is not None and np.abs(t - t[0] - given * places).max() <= allowed:
        return given  # exact, where the times are rounded
    off = np.abs(t - t[0] - step * places)
    if off.max() > allowed:
        gaps = np.diff(t)
        usual = float(np.median(gaps))
        worst = int(np.argmax(np.abs(gaps - usual)))
        raise text.refuse(
            f"uneven time steps: {gaps[worst]:.6g} s here, {usual:.6g} s elsewhere", way_out, lines[worst + 1] + 1
        )
    return step
