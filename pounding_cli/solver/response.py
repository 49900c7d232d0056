"""The response of a scene: the peaks of every storey, floor and link, and what they cost."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.notes import NOTES
from pounding_cli.numbers import pluralize

if TYPE_CHECKING:
    from pounding_cli.model.effects import DroppedEffect

DONE = "done"
"""Outcome of a run that came to the end of its motion."""

COLLAPSED = "collapsed"
"""Outcome of a run that ended as a storey collapsed."""

OUTCOMES = (DONE, COLLAPSED)
"""Outcomes of runs that tell something of their scene."""

# numbers of a record of peaks: of every storey and floor; of every building; of every link; where floors twist of every
# storey of a line, and of every floor and storey
STOREYS = ("shear", "drift", "ductility", "acceleration", "displacement_max", "displacement_min", "residual_drift")
BASES = ("sway", "rocking", "isolator_displacement")
COLLAPSES = ("collapse_storey", "collapse_time")
LINKS = ("impacts", "peak_force", "max_closing", "impulse", "contact_time")
COLUMNS = ("shear_below", "shear_above", "demand")
LINES = ("line_shear", "line_drift", "line_ductility", "line_residual_drift")
TURNS = ("twist", "edge_drift_low", "edge_drift_high")


@functools.lru_cache(maxsize=1024)
def peaks_type(buildings: int, storeys: int, links: int, lines: int = 0) -> np.dtype:
    """Return the type of the record of the peaks of a scene: numbers of every building and storey, base, and link.

    lines : most frame lines of a building whose floors twist; 0 where none does
    """
    shapes: dict[tuple[str, ...], tuple[int, ...]] = {
        STOREYS: (buildings, storeys),
        (*BASES, *COLLAPSES): (buildings,),
        LINKS: (links,),
        COLUMNS: (links,),
    }
    if lines:
        shapes |= {LINES: (buildings, storeys, lines), TURNS: (buildings, storeys)}
    return np.dtype([(name, "f8", shape) for names, shape in shapes.items() for name in names])


def no_peaks(storeys: Sequence[int], links: int, lines: int = 0) -> np.void:
    """Return the peaks of a run that failed, of buildings with so many storeys: NaN, and none of them is ever shown."""
    return np.full(1, np.nan, peaks_type(len(storeys), max(storeys), links, lines))[0]


def count_lines(peaks: np.void) -> int:
    """Return the most frame lines of a building that peaks have room for; 0 where no floors twist."""
    names = peaks.dtype.names or ()
    return int(peaks["line_shear"].shape[-1]) if "line_shear" in names else 0


def building_names(peaks: np.void) -> tuple[str, ...]:
    """Return the names of the numbers of buildings among peaks, those of lines and twist where floors twist."""
    twisting = (*LINES, *TURNS) if count_lines(peaks) else ()
    return (*STOREYS, *BASES, *COLLAPSES, *twisting)


@dataclass(frozen=True)
class Flag:
    """What a reader of the numbers of a scene should know.

    code : its entry in the catalogue of notes
    detail : where and by how much, in one line
    severity : number by which flags of one code compare, larger where it is worse; NaN where they do not compare
    """

    code: str
    detail: str = ""
    severity: float = math.nan

    @property
    def title(self) -> str:
        """What is flagged, in words."""
        return NOTES[self.code].title

    @property
    def is_meaningless(self) -> bool:
        """True if it takes the meaning from all numbers of its scene."""
        return not NOTES[self.code].can_be_accepted

    def __str__(self) -> str:
        return f"{self.title}: {self.detail}" if self.detail else self.title


@dataclass(frozen=True, eq=False, slots=True)
class BuildingPeaks:
    """The largest values of a building over time; of storeys and floors arrays of shape (storeys,), from the ground up.

    Attributes
    ----------
    shear : largest |restoring force| of each storey, without damping force; where floors twist that of the sum of its
        lines along the row [N]
    drift : largest |drift| of each storey; where floors twist that of the centres of mass [m]
    ductility : largest drift of each storey over its yield drift, in elastic runs too; where floors twist that of the
        line along the row with the largest, which governs [-]
    acceleration : largest |total acceleration| of each floor [m/s2]
    displacement_max : largest displacement of each floor relative to the ground [m]
    displacement_min : smallest displacement of each floor relative to the ground [m]
    residual_drift : drift of each storey at rest, long after the motion [m]; NaN where it is not found (a flag has the
        reason)
    sway : largest |translation| of the foundation, 0 on a fixed base [m]
    rocking : largest |rotation| of the foundation, 0 on a fixed base [rad]
    isolator_displacement : sway of a base on isolators; NaN of others [m]
    collapse_storey : storey of the building that collapsed, from 1; 0 where none did [-]
    collapse_time : when a storey of the building, or of one that links join to it, collapsed, up to which the other
        numbers are; NaN where none did, and of a wall that moves as the ground does [s]
    """

    shear: np.ndarray
    drift: np.ndarray
    ductility: np.ndarray
    acceleration: np.ndarray
    displacement_max: np.ndarray
    displacement_min: np.ndarray
    residual_drift: np.ndarray
    sway: float
    rocking: float
    isolator_displacement: float
    collapse_storey: int
    collapse_time: float


@dataclass(frozen=True, eq=False, slots=True)
class LinePeaks:
    """The largest values of the frame lines of a building whose floors twist, over time; arrays of shape (storeys,
    lines), storeys from the ground up, lines along the row before those across it. Of another building (storeys, 0).

    Attributes
    ----------
    shear : largest |restoring force| of each storey of each line, without damping force [N]
    drift : largest |drift| of each storey of each line, in its plane [m]
    ductility : largest drift over yield drift, in elastic runs too; 0 where the line cannot yield [-]
    residual_drift : drift at rest, long after the motion [m]; NaN where it is not found (a flag has the reason)
    """

    shear: np.ndarray
    drift: np.ndarray
    ductility: np.ndarray
    residual_drift: np.ndarray


@dataclass(frozen=True, eq=False, slots=True)
class TurnPeaks:
    """The largest values of floors that twist, over time; arrays of shape (storeys,), from the ground up, NaN of floors
    that do not twist.

    Attributes
    ----------
    twist : largest |rotation| of each floor [rad]
    edge_drift_low, edge_drift_high : largest |drift| of each storey along the row, at the edges of the floors where y
        is least and where it is largest [m]
    """

    twist: np.ndarray
    edge_drift_low: np.ndarray
    edge_drift_high: np.ndarray


@dataclass(frozen=True, eq=False, slots=True)
class LinkPeaks:
    """The largest values of the links of a scene over time, in the order of `scene.links`; arrays of shape (links,).

    Attributes
    ----------
    impacts : number of times the link closed [-]
    peak_force : largest |force| [N]
    max_closing : largest closing u_l - u_r, gap not subtracted [m]
    impulse : integral of the force over time; pulling counts negative [N s]
    contact_time : time with a force [s]
    """

    impacts: np.ndarray
    peak_force: np.ndarray
    max_closing: np.ndarray
    impulse: np.ndarray
    contact_time: np.ndarray


@dataclass(frozen=True, eq=False, slots=True)
class ColumnPeaks:
    """The largest values of columns that slabs strike, one entry a link that asks for them; arrays of shape (columns,).

    Attributes
    ----------
    link : number of the link in the scene, from 0
    shear_below : largest |shear| in the columns below the blow, without damping force [N]
    shear_above : largest |shear| in the columns above the blow, without damping force [N]
    demand : the larger of both over the columns' share of the storey's yield shear, in elastic runs too; NaN where the
        storey cannot yield [-]
    """

    link: np.ndarray
    shear_below: np.ndarray
    shear_above: np.ndarray
    demand: np.ndarray


@dataclass(frozen=True, eq=False)
class Response:
    """The response of a scene, what its solution cost, and what the user should know about it.

    peaks : a record of `peaks_type`, NaN where a building has no such storey, a link no struck columns, or the run no
        numbers; `buildings`, `links` and `columns` are views of it
    storeys : of every building
    status : "done"; COLLAPSED, when a storey's drift passed what its building stands (then the numbers are those up to
        that time); or another named outcome such as "event bound reached" (then the numbers are NaN)
    advice : what to do about a status other than "done"
    method : how it was solved
    accuracy : accuracy asked [-]; nan for a method that takes a time step
    steps, events : counts [-]
    seconds : time inside the solver [s]
    energy : energy balance [J]: input, kinetic, stored, links_stored, damping, hysteresis, links; residual is what is
        missing over the largest of them, or over what storeys held at their peaks if that is more [-]
    flags : what a reader of its numbers should know
    effects : names of the effects that were simulated
    dropped : effects left out, and links whose gap never closed, each with its reason
    orders : Taylor orders computed in all (0 for other methods)
    error_estimate, sensitivity : see `estimate.assess` [-]; nan where not assessed
    final : floor displacements [m] and velocities [m/s] at the end, one pair of arrays (n,) a building
    final_turns : rotations [rad] and their rates [rad/s] of floors that twist at the end, one pair of arrays (n,) a
        building; (0,) where floors do not twist
    time_step : of a method that takes one [s]; nan for the others
    closing_to_rest : largest closing of every link until the scene is at rest, that of the motion included [m]
    rest_error : error of the drifts at rest by the vibration that was left, over the largest drifts, of which
        `error_estimate` is no less [-]
    """

    peaks: np.void
    storeys: tuple[int, ...]
    status: str
    advice: str
    method: str
    accuracy: float
    steps: int
    events: int
    seconds: float
    energy: dict[str, float] = field(default_factory=dict)
    flags: tuple[Flag, ...] = ()
    effects: tuple[str, ...] = ()
    dropped: tuple[DroppedEffect, ...] = ()
    orders: int = 0
    error_estimate: float = float("nan")
    sensitivity: float = float("nan")
    time_step: float = float("nan")
    final: tuple[tuple[np.ndarray, np.ndarray], ...] = ()
    final_turns: tuple[tuple[np.ndarray, np.ndarray], ...] = ()
    closing_to_rest: np.ndarray = field(default_factory=lambda: np.zeros(0))
    rest_error: float = 0.0

    @property
    def buildings(self) -> tuple[BuildingPeaks, ...]:
        """The largest values over time of every building, left to right."""
        buildings = []
        for place, n in enumerate(self.storeys):
            values: dict[str, Any] = {name: self.peaks[name][place, :n] for name in STOREYS}
            values |= {name: float(self.peaks[name][place]) for name in (*BASES, *COLLAPSES)}
            values["collapse_storey"] = int(np.nan_to_num(values["collapse_storey"]))
            buildings.append(BuildingPeaks(**values))
        return tuple(buildings)

    @property
    def lines(self) -> tuple[LinePeaks, ...]:
        """The largest values over time of the frame lines of every building, left to right."""
        lines = []
        for place, n in enumerate(self.storeys):
            count = 0
            if count_lines(self.peaks):
                count = int(np.count_nonzero(~np.isnan(self.peaks["line_shear"][place, 0])))
            values = {
                name.removeprefix("line_"): self.peaks[name][place, :n, :count] if count else np.zeros((n, 0))
                for name in LINES
            }
            lines.append(LinePeaks(**values))
        return tuple(lines)

    @property
    def turns(self) -> tuple[TurnPeaks, ...]:
        """The largest values over time of floors that twist and of their edges, of every building, left to right."""
        has_lines = count_lines(self.peaks) > 0
        return tuple(
            TurnPeaks(**{name: self.peaks[name][place, :n] if has_lines else np.full(n, np.nan) for name in TURNS})
            for place, n in enumerate(self.storeys)
        )

    @property
    def links(self) -> LinkPeaks:
        """The largest values over time of the links of the scene, in their order."""
        values = {name: self.peaks[name] for name in LINKS}
        if self.has_result:
            values["impacts"] = values["impacts"].astype(np.int64)
        return LinkPeaks(**values)

    @property
    def columns(self) -> ColumnPeaks:
        """The largest values of columns that slabs strike, of each link that asks for them (`Link.columns`)."""
        struck = np.flatnonzero(~np.isnan(self.peaks["shear_below"]))
        return ColumnPeaks(struck, **{name: self.peaks[name][struck] for name in COLUMNS})

    @property
    def collapse_time(self) -> float:
        """The time of the first collapse of a storey [s], NaN where none collapsed."""
        return float(np.fmin.reduce(self.peaks["collapse_time"]))

    @property
    def collapse_building(self) -> int:
        """The place of the building that collapsed first, from 0; -1 where none did."""
        fallen = self.fallen_buildings
        return min(fallen, key=lambda place: self.peaks["collapse_time"][place]) if fallen else -1

    @property
    def collapse_storey(self) -> int:
        """The storey that collapsed first, from 1; 0 where none did."""
        place = self.collapse_building
        return int(self.peaks["collapse_storey"][place]) if place >= 0 else 0

    @property
    def fallen_buildings(self) -> list[int]:
        """The places of the buildings of which a storey collapsed, from 0."""
        fallen: list[int] = np.flatnonzero(self.peaks["collapse_storey"] > 0).tolist()
        return fallen

    @property
    def has_result(self) -> bool:
        """True where the run came to an end of its own: that of the motion, or a collapse."""
        return self.status in OUTCOMES

    def __repr__(self) -> str:
        shears = ", ".join(f"{each.shear.max():.4g}" for each in self.buildings)
        impacts = ""
        if self.links.impacts.size and self.has_result:
            impacts = f"; {pluralize(int(self.links.impacts.sum()), 'impact')}"
        return f"Response({self.status}; {self.method}; largest storey shears {shears} N{impacts})"
