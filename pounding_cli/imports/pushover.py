"""Storeys of a building from pushover curves: two lines of equal area for the shear of every storey over its drift."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from scipy.integrate import trapezoid
from scipy.optimize import brentq

from pounding_cli.errors import InputError, Issue
from pounding_cli.imports.building import Choices, ImportedBuilding
from pounding_cli.imports.headings import normalize_name
from pounding_cli.imports.rows import TOTALS, refuse_nameless, select_case
from pounding_cli.imports.tables import ProgramColumn, ProgramRow, ProgramTable, TableFile
from pounding_cli.numbers import join_limited
from pounding_cli.reading import shorten_path
from pounding_cli.report.style import finish, grid, shared_legend, with_style
from pounding_cli.texts import escape_controls

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PART_OF_YIELD = 0.6
"""Part of the yield shear through which the first line goes [-] (FEMA 356, 3.3.3.2.4)."""

MIN_YIELD = 0.3
"""Lowest yield shear that is looked for, over the largest shear of the curve [-]."""

MAX_BEND = 0.02
"""Largest distance of a curve from a straight line, over its largest shear, at which it counts as straight [-]."""

MAX_DROP = 1e-3
"""Largest loss of shear, over the largest shear of a curve, within which it still lies on its plateau [-]."""

MAX_FIT_ERROR = 0.10
"""Mean distance of a curve from its two lines, over its largest shear, beyond which a warning is due [-]."""

DEFAULT_HARDENING = 0.05
"""Hardening of a storey whose curve does not yield [-]: that of studies that give none."""


@dataclass(frozen=True)
class PushoverCurve:
    """The shear of a storey over its drift.

    storey : its name
    drift [m], shear [N] : rising from 0; shape (n,)
    softening : the largest shear over that of the last point, where the curve falls after its peak; 1 where it does not
    fall_drift [m], fall_shear [N] : from the peak to the last point; shape (m,)
    is_reversed : True where drift or shear were negative
    end_row : row of the table before which the curve ends, since its drift does not grow there; 0 where it goes on
    """

    storey: str
    drift: np.ndarray
    shear: np.ndarray
    softening: float = 1.0
    fall_drift: np.ndarray = field(default_factory=lambda: np.zeros(0))
    fall_shear: np.ndarray = field(default_factory=lambda: np.zeros(0))
    is_reversed: bool = False
    end_row: int = 0


@dataclass(frozen=True)
class Fit:
    """Two lines in place of a curve.

    stiffness [N/m], yield_shear [N], hardening [-] : of the two lines
    mean_error, max_error : distance of curve and lines over the largest shear [-], mean over the drift, and largest
    yields : False where the curve is straight up to its end, which the yield shear is then; where it falls after that,
        it yields there
    """

    stiffness: float
    yield_shear: float
    hardening: float
    mean_error: float
    max_error: float
    yields: bool

    def shear_at(self, drift: np.ndarray) -> np.ndarray:
        """Return the shear of the two lines at drifts [N]."""
        yield_drift = self.yield_shear / self.stiffness
        beyond = np.maximum(drift - yield_drift, 0.0)
        return self.stiffness * (np.minimum(drift, yield_drift) + self.hardening * beyond)


def fit_two_lines(curve: PushoverCurve) -> Fit:
    """Return the two lines that enclose the area of a curve, the first one through 60 % of the yield shear.

    FEMA 356 (2000), 3.3.3.2.4, on each storey.

    Raises
    ------
    ValueError : no yield shear between 30 % and 100 % of the largest shear does that
    """
    largest = float(curve.shear[-1])
    straight = float(np.dot(curve.drift, curve.shear) / np.dot(curve.drift, curve.drift))
    if np.abs(curve.shear - straight * curve.drift).max() <= MAX_BEND * largest:
        falls = curve.softening > 1.0 + MAX_DROP
        return _measure_fit(curve, straight, largest, 0.0 if falls else DEFAULT_HARDENING, yields=falls)

    def first_stiffness(yield_shear: float) -> float:
        shear = PART_OF_YIELD * yield_shear
        return shear / _interpolate_drift(curve, shear)

    def excess_area(yield_shear: float) -> float:
        yield_drift = yield_shear / first_stiffness(yield_shear)
        below = 0.5 * yield_shear * yield_drift
        beyond = 0.5 * (yield_shear + largest) * (curve.drift[-1] - yield_drift)
        return float(below + beyond - trapezoid(curve.shear, curve.drift))

    excess = excess_area(largest) / (largest * float(curve.drift[-1]))
    has_plateau = -MAX_DROP <= excess <= 1e-9
    low = MIN_YIELD * largest
    yield_shear = largest if has_plateau else float(brentq(excess_area, low, largest, xtol=1e-12 * largest))
    stiffness = first_stiffness(yield_shear)
    beyond = float(curve.drift[-1]) - yield_shear / stiffness
    if beyond <= 0.0:
        raise ValueError(curve.storey)
    return _measure_fit(curve, stiffness, yield_shear, (largest - yield_shear) / beyond / stiffness, yields=True)


def _interpolate_drift(curve: PushoverCurve, shear: float) -> float:
    """Return the drift at which a curve first reaches a shear [m]."""
    place = int(np.argmax(curve.shear >= shear))
    ends = curve.shear[place - 1 : place + 1]
    return float(np.interp(shear, ends, curve.drift[place - 1 : place + 1]))


def _measure_fit(curve: PushoverCurve, stiffness: float, yield_shear: float, hardening: float, yields: bool) -> Fit:
    """Return the fit with its distances from the curve."""
    fit = Fit(stiffness, yield_shear, hardening, 0.0, 0.0, yields)
    corner = yield_shear / stiffness
    drift = np.union1d(np.linspace(0.0, curve.drift[-1], 400), [min(corner, curve.drift[-1])])
    distance = np.abs(np.interp(drift, curve.drift, curve.shear) - fit.shear_at(drift)) / curve.shear[-1]
    mean_error = float(trapezoid(distance, drift) / drift[-1])
    return Fit(stiffness, yield_shear, hardening, mean_error, float(distance.max()), yields)


def read_curves(tables: TableFile, choices: Choices) -> tuple[list[PushoverCurve], list[str]]:
    """Return the curve of every storey, in the order of the table, and which columns were taken.

    The table has a row for each storey and step: storey, drift and shear; of ETABS that is `Story Stiffness` of a
    nonlinear static case.

    Raises
    ------
    InputError : there is no such table, or a curve is none
    """
    table = tables.find_table_with("storey", "drift", "shear")
    if table is None:
        there = [f"'{each.title}' with {', '.join(column.name for column in each.columns)}" for each in tables.tables]
        shown = join_limited([escape_controls(each) for each in there], 300)
        message = f"no table has the columns storey, drift and shear; the file has {shown}"
        hint = "write a row for each storey and step below `storey, drift [mm], shear [kN]`, or give --column drift=3"
        raise InputError(Issue((), message, hint, file=shorten_path(tables.path)))
    storey = table.get_column("storey", "name of the storey")
    drift = table.get_column("drift", "interstorey drift")
    shear = table.get_column("shear", "storey shear")
    rows, case = select_case(table, shear, choices, "that pushes the frame over")
    if not rows:
        raise table.refuse("has no row", "write a row for each storey and step below the headings")
    refuse_nameless(table, rows, storey)
    names = list(dict.fromkeys(table.read_text(row, storey) for row in rows))
    curves = [
        _build_curve(table, [row for row in rows if table.read_text(row, storey) == name], name, drift, shear)
        for name in names
    ]
    of_case = f", load case {escape_controls(case)}" if case else ""
    notes = [f"drift: {table.describe_column(drift)}{of_case}", f"shear: {table.describe_column(shear)}{of_case}"]
    return curves, notes


def _build_curve(
    table: ProgramTable, rows: Sequence[ProgramRow], name: str, drift: ProgramColumn, shear: ProgramColumn
) -> PushoverCurve:
    """Return a curve from the rows of a storey.  Raises InputError: it does not rise from the origin."""
    step = table.find_column("step")
    if step is not None and all(table.read_text(row, step) for row in rows):
        rows = sorted(rows, key=lambda row: table.read_number(row, step))
    drifts = np.array([table.read_quantity(row, drift, "m") for row in rows])
    shears = np.array([table.read_quantity(row, shear, "N") for row in rows])
    is_reversed = False
    if drifts[np.argmax(np.abs(drifts))] < 0.0:
        drifts = -drifts
        is_reversed = True
    if shears[np.argmax(np.abs(shears))] < 0.0:
        shears = -shears
        is_reversed = True
    shown = escape_controls(name)
    if drifts[0] != 0.0 and shears[0] != 0.0:
        drifts = np.insert(drifts, 0, 0.0)
        shears = np.insert(shears, 0, 0.0)
        rows = [rows[0], *rows]
    if drifts[0] != 0.0 or shears[0] != 0.0:
        hint = "begin the curve with drift 0 and shear 0: take what gravity gives off both"
        raise table.refuse(f"the curve of storey '{shown}' does not begin at the origin", hint, rows[0], drift)
    first_peak = int(np.argmax(shears))
    does_not_grow = np.diff(drifts) <= 0.0
    does_not_grow[:first_peak] = False
    end_row = 0
    if does_not_grow.any():
        end = int(np.argmax(does_not_grow)) + 1
        end_row = rows[end][0]
        drifts = drifts[:end]
        shears = shears[:end]
    on_plateau = np.flatnonzero(shears >= (1.0 - MAX_DROP) * shears[first_peak])
    peak = int(on_plateau[-1])
    if peak < 2:
        message = f"the curve of storey '{shown}' has fewer than two points beyond the origin before its largest shear"
        raise table.refuse(message, "give more steps", rows[0], shear)
    falling = np.flatnonzero(np.diff(drifts[: peak + 1]) <= 0.0)
    if falling.size:
        message = f"the drift of storey '{shown}' does not grow from the step before"
        hint = "give the steps in their order, each drift larger; take repeated rows and unloading out"
        raise table.refuse(message, hint, rows[int(falling[0]) + 1], drift)
    softening = float(shears[first_peak] / max(shears[-1], 1e-300))
    return PushoverCurve(
        name,
        drifts[: peak + 1],
        shears[: peak + 1],
        softening,
        drifts[peak:],
        shears[peak:],
        is_reversed,
        end_row,
    )


def apply_curves(
    building: ImportedBuilding, curves: Sequence[PushoverCurve], path: str, has_other_towers: bool = False
) -> dict[str, Fit]:
    """Set stiffness, yield shear and hardening of a building from the curves of its storeys; return the fits by storey.

    has_other_towers : some curves may be of storeys of other towers

    Raises
    ------
    InputError : a storey has no curve, a curve has no storey, or a curve has no fit
    """
    by_name = {curve.storey: curve for curve in curves}
    missing = [escape_controls(name) for name in building.names if name not in by_name]
    if missing:
        there = join_limited([escape_controls(name) for name in by_name], 300)
        message = f"no curve of storey {join_limited(missing, 300)}; the curves are of {there}"
        raise InputError(
            Issue((), message, "give one for each storey, with the names of the table of storeys", file=path)
        )
    no_storeys = {"base", *TOTALS}
    names = [name for name in by_name if normalize_name(name) not in no_storeys]
    others = [escape_controls(name) for name in names if name not in building.names]
    if others and not has_other_towers:
        there = join_limited([escape_controls(name) for name in building.names], 300)
        message = f"no height and mass of storey {join_limited(others, 300)}; the storeys are {there}"
        raise InputError(Issue((), message, "give them in the table of storeys, or take the curve out", file=path))
    fits: dict[str, Fit] = {}
    problems = []
    for name in building.names:
        try:
            fits[name] = fit_two_lines(by_name[name])
        except ValueError:
            message = f"no two lines with the area of the curve fit storey '{escape_controls(name)}'"
            hint = "push further, or end the curve before it falls; or write stiffness and yield shear yourself"
            problems.append(Issue((), message, hint, file=path))
    if problems:
        raise InputError(problems)
    building.stiffness = np.array([fits[name].stiffness for name in building.names])
    building.yield_shear = np.array([fits[name].yield_shear for name in building.names])
    building.hardening = np.array([fits[name].hardening for name in building.names])
    building.notes.append("stiffness, yield shear, hardening: two lines of equal area (FEMA 356, 3.3.3.2.4)")
    building.notes += _list_changes([by_name[name] for name in building.names])
    building.warnings += [warning for name in building.names for warning in _list_doubts(by_name[name], fits[name])]
    return fits


def _list_changes(curves: Sequence[PushoverCurve]) -> list[str]:
    """Return what was changed or left out of curves."""
    notes = []
    reversed_names = [escape_controls(curve.storey) for curve in curves if curve.is_reversed]
    if reversed_names:
        notes.append(f"negative, and taken with the other sign: storey {join_limited(reversed_names, 200)}")
    for curve in curves:
        if curve.end_row:
            name = escape_controls(curve.storey)
            notes.append(f"the curve of storey '{name}' ends before row {curve.end_row}, where its drift does not grow")
    return notes


def _list_doubts(curve: PushoverCurve, fit: Fit) -> list[str]:
    """Return what a reader must know of a fit."""
    name = escape_controls(curve.storey)
    doubts = []
    if not fit.yields:
        doubts.append(
            f"storey '{name}' is straight up to its largest shear: its yield shear is not known; "
            f"{fit.yield_shear / 1e3:.6g} kN, the largest that it reached, is a lower bound, and its hardening of "
            f"{fit.hardening:g} the default"
        )
    if fit.yields and fit.hardening == 0.0 and fit.yield_shear / fit.stiffness > 0.95 * float(curve.drift[-1]):
        doubts.append(
            f"storey '{name}' is straight up to its peak and falls then: its yield shear is the peak, its hardening 0"
        )
    if curve.softening > 1.0 + MAX_DROP:
        share = 100.0 * (1.0 - 1.0 / curve.softening)
        doubts.append(
            f"storey '{name}' loses {share:.3g} % of its shear after the peak: the lines end there, and a study with "
            "`storey_law: imk-peak-oriented` has the loss"
        )
    if fit.mean_error > MAX_FIT_ERROR:
        doubts.append(
            f"storey '{name}': the two lines are {100 * fit.mean_error:.3g} % of the largest shear off the curve"
        )
    return doubts


@with_style
def draw_fits(curves: Sequence[PushoverCurve], fits: dict[str, Fit], title: str) -> Figure:
    """Draw the curve of every storey, from the roof down, with its two lines."""
    by_name = {curve.storey: curve for curve in curves}
    figure, axes = grid(len(fits), 2.9, 2.2, "storey shear [kN]")
    for ax, (name, fit) in zip(axes, reversed(fits.items()), strict=True):
        curve = by_name[name]
        corner = min(fit.yield_shear / fit.stiffness, float(curve.drift[-1]))
        ends = np.array([0.0, corner, float(curve.drift[-1])])
        ax.plot(1e3 * curve.drift, curve.shear / 1e3, color="black", lw=1.6, label="pushover curve")
        if curve.softening > 1.0 + MAX_DROP:
            ax.plot(
                1e3 * curve.fall_drift, curve.fall_shear / 1e3, color="0.6", lw=1.2, label="beyond the peak, left out"
            )
        ax.plot(1e3 * ends, fit.shear_at(ends) / 1e3, color="#D55E00", lw=1.4, dashes=(5, 2), label="two lines")
        ax.plot([1e3 * corner], [fit.shear_at(np.array([corner]))[0] / 1e3], "o", color="#D55E00", ms=4)
        state = "" if fit.yields else ", does not yield"
        ax.set_title(
            f"storey {escape_controls(name)}: mean error {100 * fit.mean_error:.1f} %{state}", fontsize=9, loc="left"
        )
        ax.set_xlim(left=0.0)
        ax.set_ylim(bottom=0.0)
        ax.set_xlabel("interstorey drift [mm]")
    shared_legend(figure, axes)
    text = "Two lines of equal area, the first through 60 % of the yield shear. The error is the mean distance of the "
    finish(figure, title, text + "lines from the curve over its largest shear.")
    return figure
