"""What runs have left, read together: those that are laid out alike as rows of the same arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import nan
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from pounding_cli.kernels import layout
from pounding_cli.solve.arrays import drift_of, ended
from pounding_cli.solve.energy import balance
from pounding_cli.solve.flags import collapse_flag, flags_of
from pounding_cli.solve.method import NO_ROOT, UNSTABLE
from pounding_cli.solve.response import (
    BOUNDED,
    COLLAPSED,
    DONE,
    BuildingResponse,
    ColumnResponse,
    LinkResponse,
    Response,
)
from pounding_cli.solve.response import OUTCOMES as ENDS
from pounding_cli.solve.tangent import Moved, bounds, moved
from pounding_cli.solve.unpack import Unpacked, unpack

if TYPE_CHECKING:
    from pounding_cli.solve.run import Prepared

End = tuple[str, str]
"""How a run ended, in words, and what to do about it."""

OUTCOMES: dict[int, End] = {
    layout.DONE: (DONE, ""),
    layout.COLLAPSED: (COLLAPSED, ""),
    layout.EVENT_BOUND: (
        "event bound reached",
        "the floors strike each other too often: check the stiffness and damping of the links",
    ),
    layout.STEP_BOUND: (
        "step bound reached",
        "a part of the scene is far stiffer than the rest: check stiffnesses and masses",
    ),
    layout.NOT_FINITE: ("not finite", "the numbers exceed the range of double precision: check masses and stiffnesses"),
    UNSTABLE: ("unstable step", ""),
    NO_ROOT: (
        "no root",
        "Newton's method found no root at any step, because a contact force jumps: use a method with events, such as "
        "taylor",
    ),
    layout.STALLED: (
        "stalled",
        "events repeat without advancing in time: check for links whose force jumps",
    ),
}
"""Kernel outcome to the words a user reads and what to do about it."""

LEDGER_BOUND = 1e-8
"""Energy residual over the input that is always allowed; a run asked for less accuracy may leave as much open as
that."""

OPEN_LEDGER: End = (
    "energy does not close",
    "the error of the series exceeds the accuracy asked: set a finer accuracy, or reduce extreme stiffnesses",
)


@dataclass(eq=False)
class Responses:
    """The responses of runs that are laid out alike; row i of every array is that of run i.

    runs : of the same buildings and analysis, with as many links
    ends : how they ended
    energy : the ledgers by entry [J], shape (runs,) each; empty where none was kept
    peaks : of buildings, links and struck columns
    final : floor displacements [m] and velocities [m/s] at the end, a pair a building, shape (runs, n) each
    moved : by their motions, where they carried their tangents
    """

    runs: Sequence[Prepared]
    ends: Sequence[End]
    energy: dict[str, np.ndarray]
    peaks: Unpacked
    final: Sequence[tuple[np.ndarray, np.ndarray]]
    moved: Moved | None

    @cached_property
    def bounds(self) -> np.ndarray:
        """Bounds of their errors by their tangents [-], nan where there is none that is enough, shape (runs,)."""
        if self.moved is None:
            return np.full(len(self.runs), nan)
        found = bounds(self.moved, np.array([run.accuracy for run in self.runs]))
        found[[end[0] != DONE for end in self.ends]] = nan
        return found

    @cached_property
    def estimated(self) -> list[str]:
        """As of `Response`."""
        return ["" if none else BOUNDED for none in np.isnan(self.bounds).tolist()]

    @cached_property
    def collapses(self) -> list[tuple[float, int, int]]:
        """Of every run when a storey collapsed [s], the place of its building from 0, and the storey from 1; nan, -1
        and 0 where none did."""
        each = zip(self.runs, self.ends, strict=True)
        return [run.collapse() if end[0] == COLLAPSED else (nan, -1, 0) for run, end in each]

    @cached_property
    def flags(self) -> list[tuple[str, ...]]:
        """The flags of every run."""
        return [self._flags_of(row, run) for row, run in enumerate(self.runs)]

    def _flags_of(self, row: int, run: Prepared) -> tuple[str, ...]:
        """The flags of one run."""
        said = collapse_flag(run.scene, *self.collapses[row]) if self.ends[row][0] == COLLAPSED else ()
        if run.what.may_be_flagged:
            said += flags_of(run.scene, self._links(row))
        note = run.what.code.note(*run.found[1:3])
        return (*said, note) if note else said

    @cached_property
    def scalars(self) -> dict[str, Sequence[Any]]:
        """The numbers of `Response` that are one a run, by name; nan for what `assess` finds."""
        _, steps, events, orders, seconds = zip(*[run.found for run in self.runs], strict=True)
        time, building, storey = zip(*self.collapses, strict=True)
        fixed = self.runs[0].what.method.takes_step
        sensitivity = np.where(np.isnan(self.bounds), nan, self.moved.storeys if self.moved else nan)
        return {
            "accuracy": [nan if fixed else run.accuracy for run in self.runs],
            "time_step": [run.setting if fixed else nan for run in self.runs],
            "steps": steps, "events": events, "orders": orders, "seconds": seconds,
            "collapse_time": time, "collapse_building": building, "collapse_storey": storey,
            "error_estimate": self.bounds.tolist(), "sensitivity": sensitivity.tolist(),
        }  # fmt: skip

    def response(self, row: int) -> Response:
        """That of one run."""
        run, what, (buildings, _, columns) = self.runs[row], self.runs[row].what, self.peaks
        return Response(
            tuple([BuildingResponse(*[of[row] for of in most], *[float(of[row]) for of in base])
                   for most, base in buildings]),
            self._links(row), *self.ends[row], what.method.name,
            **{name: values[row] for name, values in self.scalars.items()},
            energy={name: float(values[row]) for name, values in self.energy.items()},
            flags=self.flags[row], effects=what.effects, dropped=what.dropped,
            final=tuple([(u[row], v[row]) for u, v in self.final]),
            samples=tuple([run.samples[:, span].copy() for span in what.arrays.floors]) if run.watch else (),
            columns=columns[row] if columns else ColumnResponse(), estimated=self.estimated[row],
            moved=tuple([float(each[row]) for each in self.moved]) if self.moved else None,
        )  # fmt: skip

    def _links(self, row: int) -> LinkResponse:
        return LinkResponse(*[of[row] for of in self.peaks[1]])


class OneOf(NamedTuple):
    """The response of one run among those that were read together, made when it is asked for."""

    responses: Responses
    row: int

    @property
    def status(self) -> str:
        """As of `Response`."""
        return self.responses.ends[self.row][0]

    @property
    def is_open(self) -> bool:
        """Whether its tangent did not tell enough of its error."""
        return self.responses.moved is not None and not self.responses.estimated[self.row]

    @property
    def sensitivity(self) -> float:
        """What its tangent tells of that [-]; nan where it carried none, or did not end with its motion."""
        told = self.responses.moved
        return nan if told is None or self.status != DONE else float(told.storeys[self.row])

    def response(self) -> Response:
        """All of it."""
        return self.responses.response(self.row)


def read(runs: Sequence[Prepared]) -> list[OneOf]:
    """What came of runs, in their order; those that are laid out alike are read as rows of the same arrays, since a
    row's numbers cost as little as the smallest step of Python."""
    alike: dict[tuple[object, ...], list[int]] = {}
    for place, run in enumerate(runs):
        alike.setdefault(run.what.layout, []).append(place)
    found: list[Any] = [None] * len(runs)
    for places in alike.values():
        responses = _responses([runs[place] for place in places])
        for row, place in enumerate(places):
            found[place] = OneOf(responses, row)
    return found


def _responses(runs: Sequence[Prepared]) -> Responses:
    """Of runs that are laid out alike."""
    arrays, scenes = runs[0].what.arrays, [run.scene for run in runs]
    state, peaks, ledger, finite = ended(arrays, [run.memory for run in runs])
    drift = drift_of(arrays, state.u)
    book: dict[str, np.ndarray] = {}
    if runs[0].keeps_ledger:
        with np.errstate(over="ignore", invalid="ignore"):  # a run that failed may have ended at any numbers
            every = [run.what.arrays for run in runs]
            book = balance(scenes, every, [run.before for run in runs], state, drift, peaks, ledger)
    missing = np.abs(book["residual"]).tolist() if book else [0.0] * len(runs)
    ends = [_end(*each) for each in zip(runs, finite.tolist(), missing, strict=True)]
    for row, (outcome, _) in enumerate(ends):
        if outcome not in ENDS:  # no number of a run that failed is ever shown
            for numbers in (*(each for each in peaks[1:-1] if each is not peaks.samples), state.u, state.v, drift):
                numbers[row].fill(np.nan)
            runs[row].samples.fill(np.nan)
    final = [(state.u[:, span], state.v[:, span]) for span in arrays.floors]
    told = moved(arrays, peaks) if runs[0].carries_tangent else None
    return Responses(runs, ends, book, unpack(scenes, arrays, drift, peaks), final, told)


def _end(run: Prepared, is_finite: bool, missing: float) -> End:
    """How a run ended; `missing` : the energy residual [-]."""
    status = run.found[0]
    if status == UNSTABLE:
        advice = (
            f"the solution would grow without bound: use a time step below {run.what.limit:.2g} s, or method: taylor"
        )
        return OUTCOMES[status][0], advice
    if status == layout.DONE and not (is_finite and (not run.watch or np.isfinite(run.samples).all())):
        status = layout.NOT_FINITE
    end = OUTCOMES[status]
    if end[0] in ENDS and missing > max(run.accuracy, LEDGER_BOUND):
        return OPEN_LEDGER
    return end
