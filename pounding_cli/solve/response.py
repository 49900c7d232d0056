"""What a run returns: the peaks of every storey, floor and link, and what they cost."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np

from pounding_cli.numbers import counted

DONE, COLLAPSED = "done", "collapsed"
"""The outcomes of runs that tell something of their scene."""

OUTCOMES = (DONE, COLLAPSED)


BOUNDED, MEASURED = "bounded", "measured"
"""How an error is estimated: by the tangent of the run itself, or against a finer run."""


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
    method : how it was solved, of a row that fell into groups `composed_method`
    accuracy : accuracy asked [-]; nan for a method that takes a time step
    steps, events : counts [-]
    seconds : time inside the solver [s]
    energy : ledger [J]: input, kinetic, stored, damping, hysteresis, links; residual is relative to the input [-]
    flags : sentences about the scene, e.g. "infill compressed beyond its thickness: stiff|soft floor 5"
    effects, dropped : effects simulated; effects left out, each with its reason
    orders : Taylor orders computed in all (0 for other methods)
    error_estimate, sensitivity : see `assess` [-]; nan where not assessed
    estimated : how they were found, BOUNDED or MEASURED; "" where not assessed
    moved : as in `tangent.Moved` of this run [-]; None where no tangent was carried
    final : floor displacements [m] and velocities [m/s] at the end, one pair of arrays (n,) a building
    time_step : of a method that takes one [s]; nan for the others
    samples : floor displacements at the end of every segment of the motion [m], one array (segments, n) a building,
        where the run was asked to watch them
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
    estimated: str = ""
    moved: tuple[float, ...] | None = None
    time_step: float = float("nan")
    final: tuple[tuple[np.ndarray, np.ndarray], ...] = ()
    samples: tuple[np.ndarray, ...] = ()
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
        impacts = f"; {counted(int(self.links.impacts.sum()), 'impact')}" if self.links.impacts.size else ""
        return f"Response({self.status}; {self.method}; largest storey shears {shears} N{impacts})"

    @property
    def methods(self) -> tuple[str, ...]:
        """Keys in METHODS of all that solved it: one, or those of the groups the row fell into."""
        return methods_in(self.method)


@dataclass(frozen=True, eq=False)
class PointResponse:
    """The response of a point of a model of its own, as the `variables` of its workflow say.

    values : by variable, of any shape; none of a point that failed
    status, advice, flags, seconds : as of `Response`
    """

    values: Mapping[str, np.ndarray]
    status: str = DONE
    advice: str = ""
    flags: tuple[str, ...] = ()
    seconds: float = 0.0


def composed_method(methods: Iterable[str]) -> str:
    """The `method` of a row that fell into groups: theirs, each once, with commas."""
    return ", ".join(dict.fromkeys(methods))


def methods_in(method: str) -> tuple[str, ...]:
    """The methods that a response's `method` names."""
    return tuple(method.split(", "))
