"""The time step of a column of times: even, merely rounded, or none."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from pounding_cli.cells import TextFile
from pounding_cli.records.declaration import Declaration
from pounding_cli.records.number_rows import NumberRows

MAX_UNEVENNESS = 0.01
"""Part of the time step by which times may miss even ones, as those that are printed with few digits do [-]."""

MIN_COUNTED_STEP = 0.5
"""Steps [s] of times from here on are sample numbers, or times in milliseconds."""

MIN_MILLISECONDS, MAX_MILLISECONDS = 0.5, 50.0
"""Steps that accelerographs have [ms]."""


def find_step(text: TextFile, rows: NumberRows, declared: Declaration) -> float:
    """Return the time step [s] of the column of times that is declared.

    Raises
    ------
    InputError : they do not rise evenly; where they are rounded, count samples or milliseconds, with the `dt` that
        settles it
    """
    column = declared.time or 1
    times = rows.take_column(column)
    first = rows.rows[0].line
    if times.size < 2:
        raise text.refuse("only one row of numbers", "a motion needs two samples at least", first)
    steps = np.diff(times)
    mean = float(times[-1] - times[0]) / (times.size - 1)
    misses = np.abs(times - (times[0] + mean * np.arange(times.size)))
    value_column = declared.column or next(each for each in (1, 2) if each != column)
    if mean > 0 and misses.max() <= MAX_UNEVENNESS * mean:
        step = _round_step(mean, float(misses.max()), times.size)
        if step < MIN_COUNTED_STEP:
            return step
        is_milliseconds = step > 1 and MIN_MILLISECONDS <= step <= MAX_MILLISECONDS
        settled = step / 1000 if is_milliseconds else math.nan
        what = "they are milliseconds" if is_milliseconds else "they number the samples"
        message = f"the times of column {column} rise by {step:g} s: {what}"
        hint = f"write the time step, `dt:`, and `column: {value_column}` in place of `time: {column}`"
        if rows.width > 2 and declared.column is None:
            raise text.refuse(message, f"write the time step, `dt:`, and `column:`, from 1 to {rows.width}", first)
        raise text.refuse_curable(message, hint, {"dt": settled, "column": value_column, "time": None}, first)
    fit = _find_rounded_step(rows, times, column)
    if fit is not None:
        last_digit, step = fit
        message = f"the times are uneven, as they are rounded to {last_digit:g} s; steps of {step:.6g} s fit them"
        hint = f"write `dt: {step:.7g} s, column: {value_column}` in place of `time: {column}`"
        cure = {"dt": float(f"{step:.7g}"), "column": value_column, "time": None}
        raise text.refuse_curable(message, hint, cure, first)
    usual = float(steps[0] if steps.size > 1 and steps[0] == steps[1] else np.median(steps))
    if usual <= 0:
        message = f"column {column} does not rise, so that it holds no times"
        hint = "write the column of the times, from 1, or `dt:`; `decimal:` and `separator:` say what commas mean"
        raise text.refuse(message, hint, first)
    odd = int(np.argmax(np.abs(steps - usual) > 0.1 * usual)) + 1
    line = rows.rows[odd].line
    message = f"the times are uneven: {times[odd]:g} s follows {times[odd - 1]:g} s, where the step is {usual:g} s"
    rest = np.diff(times[1:])
    if odd == 1 and declared.skip is None and rest.size and np.allclose(rest, rest[0], rtol=0.01, atol=0.0):
        hint = f"write `skip: {line - 1}` if the rows begin here"
        raise text.refuse_curable(message, hint, {"skip": line - 1}, line)
    raise text.refuse(
        message, "correct the row if one is missing or stands twice; else resample the motion evenly", line
    )


def _round_step(mean: float, miss: float, count: int) -> float:
    """Return a time step [s] with as few digits as the printed times allow: 0.02 for 0.0199999."""
    for digits in range(1, 10):
        rounded = float(f"{mean:.{digits}g}")
        if abs(rounded - mean) * (count - 1) <= miss + 1e-9 * mean * count:
            return rounded
    return mean


def _find_rounded_step(rows: NumberRows, times: np.ndarray, column: int) -> tuple[float, float] | None:
    """Return the last digit [s] to which even times are rounded, and their step [s]; None where they are uneven."""
    decimals = max(len(row.cells[column - 1].partition(rows.grammar.decimal)[2]) for row in rows.rows)
    last_digit = 10.0**-decimals
    reach = float(times[-1] - times[0])
    if reach <= 0:
        return None
    least = (times.size - 1) / (reach + last_digit)
    most = (times.size - 1) / max(reach - last_digit, 0.5 * reach)
    for step in _iter_steps(least, most):
        grid = times[0] + step * np.arange(times.size)
        in_digits = step / last_digit
        is_between_digits = abs(in_digits - round(in_digits)) > 1e-3  # others are printed without rounding
        if is_between_digits and np.ptp(grid - times) <= last_digit * (1 + 1e-6):
            return last_digit, step
    return None


def _iter_steps(least: float, most: float) -> Iterator[float]:
    """Yield time steps [s] for rates between two [Hz]: whole rates, those near the middle first, then the middle."""
    middle = 0.5 * (least + most)
    whole = range(int(np.ceil(least)), min(int(most), int(least) + 20) + 1)
    yield from (1.0 / rate for rate in sorted(whole, key=lambda rate: abs(rate - middle)) if rate > 0)
    yield 1.0 / middle
