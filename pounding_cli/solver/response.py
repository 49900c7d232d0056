"""What a run returns: the peaks of every storey, floor and link, and what they cost."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from pounding_cli.numbers import counted

DONE, COLLAPSED = "done", "collapsed"
"""The outcomes of runs that tell something of their scene."""

OUTCOMES = (DONE, COLLAPSED)

NEVER_CLOSES = "the gap never closes"
"""In a sentence of `Response.dropped`: of neighbours that never meet."""


@dataclass(frozen=True, eq=False)
class BuildingResponse:
    """Largest values over time of one building; shape (n,), from the ground up.

    shear : largest |restoring force| of each storey, without damping force [N]
    drift : largest |drift| of each storey [m]
    ductility : drift / yield drift [-], the same yield drift in elastic runs
    acceleration : largest |total acceleration| of each floor [m/s2]
    displacement_max, displacement_min : largest and smallest displacement relative to the ground [m]
    residual_drift : drift at the end [m]
    sway, rocking : largest |u_b| [m] and |phi_b| [rad] of the foundation (0 on a fixed base)
    isolator_displacement : the sway of a base on isolators [m]; NaN of others
    """

    shear: np.ndarray
    drift: np.ndarray
    ductility: np.ndarray
    acceleration: np.ndarray
    displacement_max: np.ndarray
    displacement_min: np.ndarray
    residual_drift: np.ndarray
    sway: float = 0.0
    rocking: float = 0.0
    isolator_displacement: float = float("nan")


@dataclass(frozen=True, eq=False)
class LinkResponse:
    """Per link of the scene, in its order; shape (m,).

    impacts : number of times the link closed [-]
    peak_force : largest |force| [N]
    max_closing : largest closing u_l - u_r [m], gap not subtracted
    impulse : integral of the force over time [N s]; pulling counts negative
    contact_time : time with a force [s]
    """

    impacts: np.ndarray
    peak_force: np.ndarray
    max_closing: np.ndarray
    impulse: np.ndarray
    contact_time: np.ndarray


@dataclass(frozen=True, eq=False)
class ColumnResponse:
    """Of columns that slabs strike, one entry for each link that asks for them (`Link.columns`); shape (c,).

    link : number of the link in the scene, from 0
    shear_below, shear_above : largest |shear| in the columns below and above the blow, without damping force [N]
    demand : the larger of both over the columns' share of the storey's yield shear, in elastic runs too [-]; NaN where
        the storey cannot yield
    """

    link: np.ndarray = field(default_factory=lambda: np.zeros(0, np.int64))
    shear_below: np.ndarray = field(default_factory=lambda: np.zeros(0))
    shear_above: np.ndarray = field(default_factory=lambda: np.zeros(0))
    demand: np.ndarray = field(default_factory=lambda: np.zeros(0))


@dataclass(frozen=True, eq=False)
class Response:
    """The response of a scene, what its solution cost, and what the user should know about it.

    status : "done"; COLLAPSED, when a storey's drift passed what its building stands (then the numbers are those up to
        that time); or another named outcome such as "event bound reached" (then the numbers are NaN)
    advice : what to do about a status other than "done"
    method : how it was solved
    accuracy : accuracy asked [-]; nan for a method that takes a time step
    steps, events : counts [-]
    seconds : time inside the solver [s]
    energy : energy balance [J]: input, kinetic, stored, links_stored, damping, hysteresis, links; residual is what is
        missing over the largest of them, or over what storeys held at their peaks if that is more [-]
    flags : sentences about the scene, e.g. "infill compressed beyond its thickness: stiff|soft floor 5"
    effects, dropped : effects simulated; effects left out, each with its reason
    orders : Taylor orders computed in all (0 for other methods)
    error_estimate, sensitivity : see `estimate.assess` [-]; nan where not assessed
    final : floor displacements [m] and velocities [m/s] at the end, one pair of arrays (n,) a building
    time_step : of a method that takes one [s]; nan for the others
    collapse_time : when a storey collapsed [s], nan where none did
    columns : shears in columns that slabs strike
    collapse_building, collapse_storey : place of its building from 0, and storey from 1; -1 and 0 where none did
    """

    buildings: tuple[BuildingResponse, ...]
    links: LinkResponse
    status: str
    advice: str
    method: str
    accuracy: float
    steps: int
    events: int
    seconds: float
    energy: dict[str, float] = field(default_factory=dict)
    flags: tuple[str, ...] = ()
    effects: tuple[str, ...] = ()
    dropped: tuple[str, ...] = ()
    orders: int = 0
    error_estimate: float = float("nan")
    sensitivity: float = float("nan")
    time_step: float = float("nan")
    final: tuple[tuple[np.ndarray, np.ndarray], ...] = ()
    collapse_time: float = float("nan")
    collapse_building: int = -1
    collapse_storey: int = 0
    columns: ColumnResponse = field(default_factory=ColumnResponse)

    @property
    def has_result(self) -> bool:
        """Whether the run came to an end of its own: that of the motion, or a collapse."""
        return self.status in OUTCOMES

    def __repr__(self) -> str:
        shears = ", ".join(f"{each.shear.max():.4g}" for each in self.buildings)
        impacts = ""
        if self.links.impacts.size and self.has_result:
            impacts = f"; {counted(int(self.links.impacts.sum()), 'impact')}"
        return f"Response({self.status}; {self.method}; largest storey shears {shears} N{impacts})"


def nothing(storeys: Sequence[int], links: int) -> tuple[tuple[BuildingResponse, ...], LinkResponse]:
    """The numbers of a run that failed, of buildings with so many storeys: none of them is ever shown."""
    buildings = []
    for n in storeys:
        none = np.full(n, np.nan)
        buildings.append(BuildingResponse(none, none, none, none, none, none, none))
    none = np.full(links, np.nan)
    return tuple(buildings), LinkResponse(none, none, none, none, none)
