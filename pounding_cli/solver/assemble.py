"""From a scene to the records of its run.

What scenes of the same buildings, links and analysis share is laid out once (`Layout`); a run gets a copy and its
motion (`Prepared`)."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from pounding_cli.laws import BEHAVIOURS
from pounding_cli.laws.formula import Formula, WrittenLaw
from pounding_cli.laws.joints import Maxwell
from pounding_cli.laws.law import JOINED, PARAMETERS, Behaviour
from pounding_cli.laws.storey import StoreyLaw
from pounding_cli.methods import Method
from pounding_cli.model.building import Building
from pounding_cli.model.effects import Effects
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Scene
from pounding_cli.model.wall import Wall
from pounding_cli.records.motion import Motion
from pounding_cli.solver.records import COLUMN, DOF, ELEMENT, FORMULA, RUN, SERIES, STATE, TERM, Data, Room, Watch

SAFETY = 0.5
"""What a series may leave out of an acceleration, over the accuracy asked of the peaks [-]."""

COARSEST, FINEST = 1e-4, 1e-16
"""Most and least that a series may leave out, relative to the acceleration [-]."""

SMOOTHER, FINEST_SMOOTH = 0.01, 1e-13
"""Error that a step by DOP853 may have, over what a series may leave out, and its least [-]."""

LEAST_STATE = 1e-6
"""Size of a displacement [m], velocity [m/s] or history variable below which DOP853 resolves nothing."""

LEAST_SCALE = 1e-3
"""Acceleration below which nothing is resolved, over the ground's peak [-]."""

POINTS = ((1e-5, 5), (1e-7, 6), (1e-8, 7), (0.0, 9))
"""(accuracy from which on, places of the quadrature of energies inside a step)."""

MOST_STEPS, MOST_EVENTS = 20_000_000, 5_000_000
"""Bounds of a run, after which it ends with a status that says so."""

Weights = dict[int, float]
"""Weight of every degree of freedom in the deformation of an element."""


def max_order(tolerance: float) -> int:
    """Highest order worth computing before a step is cut: near the optimum of Jorba & Zou, -ln(tol) / 2 + 1, and above
    it, because most steps end at a sample of the motion."""
    return min(30, max(10, math.ceil(-0.75 * math.log(tolerance)) + 4))


@dataclass(frozen=True)
class Columns:
    """Columns whose shear is asked for because link number `link` strikes them: building, storey from 1, whether they
    are those on the building's left side, height of the blow in the storey [-], part of the storey that they have
    [-]."""

    link: int
    building: int
    storey: int
    on_left: bool
    at: float
    share: float


def struck_columns(links: Sequence[Link]) -> tuple[Columns, ...]:
    """The columns that links strike, where their share of the storey is given."""
    found = []
    for number, link in enumerate(links):
        if link.columns > 0.0:
            (building, storey, at), on_left = (link.ends[1], True) if link.left_at == 1.0 else (link.ends[0], False)
            found.append(Columns(number, building, storey, on_left, at, link.columns))
    return tuple(found)


@dataclass
class _Elements:
    """What a scene is made of, as it is collected: fields of `records` by name."""

    dofs: list[dict[str, Any]] = field(default_factory=list)
    storeys: list[dict[str, Any]] = field(default_factory=list)
    drags: list[tuple[dict[str, Any], Weights]] = field(default_factory=list)
    links: list[tuple[dict[str, Any], Weights]] = field(default_factory=list)
    formulas: list[Formula] = field(default_factory=list)


@dataclass(frozen=True, eq=False)
class Layout:
    """What all runs of the same buildings, links and analysis share: records at rest, and where everything stands.

    floors : degrees of freedom of the floors of every building
    bases, feet : those of a base that sways, and that rocks; -1 where none does
    struck : columns that links strike; two shears each stand in `columns`, below and above the blow
    """

    buildings: tuple[Building, ...]
    links: tuple[Link, ...]
    dofs: np.ndarray
    elements: np.ndarray
    terms: np.ndarray
    columns: np.ndarray
    formulas: np.ndarray
    floors: tuple[slice, ...]
    bases: tuple[int, ...]
    feet: tuple[int, ...]
    drags: int
    struck: tuple[Columns, ...]
    has_smooth: bool

    @property
    def number(self) -> int:
        """Degrees of freedom."""
        return self.dofs.size

    @property
    def of_links(self) -> slice:
        """Where the elements of the links stand."""
        return slice(self.number + self.drags, self.elements.size)


def _element(behaviour: Behaviour, p: Sequence[float], **more: float) -> dict[str, Any]:
    """The fields of an element with these parameters."""
    return {"kind": BEHAVIOURS.index(behaviour), "p": tuple(p) + (0.0,) * (PARAMETERS - len(p)), **more}


def _storey(k: float, c: float, law: StoreyLaw | None = None) -> dict[str, Any]:
    """The element of a storey or under a base, with a dashpot c [N s/m]; with a spring k [N/m] where it cannot
    yield."""
    if law is None:
        return _element(JOINED, (k, c), c=c)
    return _element(law.behaviour, law.numbers(), c=c, yields=1)


def _add_building(made: _Elements, b: Building, inelastic: bool, collapses: bool) -> tuple[slice, int, int]:
    """The degrees of freedom of a building: its base if it sways, floors from the ground up, its rocking. Returns its
    floors, and the places of base and rocking."""
    f = b.foundation
    sways, rocks = f is not None and f.sways, f is not None and f.rocks
    base = len(made.dofs) if sways else -1
    if f is not None and sways:
        made.dofs.append({"mass": f.mass, "inv_mass": 1.0 / f.mass, "loaded": 1.0})
        made.storeys.append(_storey(*b.base_spring, b.isolators))
    first = len(made.dofs)
    if isinstance(b, Wall) and not b.moves:
        made.dofs.append({"mass": 1.0, "inv_mass": 0.0, "loaded": 1.0})
        made.storeys.append(_storey(0.0, 0.0))
        return slice(first, first + 1), -1, -1
    foot = first + b.storeys if rocks else -1
    for j, law in enumerate(b.laws):
        mass, height = float(b.mass[j]), float(b.height[j])
        made.dofs.append({
            "mass": mass, "inv_mass": 1.0 / mass, "loaded": 1.0, "drag": b.alpha if f is None else 0.0,
            "below": 1.0 if j or sways else 0.0, "lean": -height if rocks else 0.0, "foot": max(foot, 0),
        })  # fmt: skip
        limit = float(b.collapse_drift[j]) if collapses else math.inf
        load = 0.0 if b.gravity_load is None else float(b.gravity_load[j]) / height
        storey = _storey(law.stiffness, b.beta * law.stiffness, law if inelastic and law.can_yield else None)
        made.storeys.append(storey | {"collapse": limit, "load": load})
        if f is not None and b.alpha > 0:
            weights = {first + j: 1.0} | ({base: -1.0} if sways else {})
            if rocks:
                weights[foot] = -float(b.elevation[j])
            made.drags.append((_element(JOINED, (0.0, b.alpha * mass)), weights))
    if f is not None and rocks:
        made.dofs.append({"mass": f.inertia, "inv_mass": 1.0 / f.inertia})
        made.storeys.append(_storey(f.rocking_stiffness, f.rocking_damping))
    return slice(first, first + b.storeys), base, foot


def _end(b: Building, floors: slice, base: int, foot: int, floor: int, at: float) -> Weights:
    """The motion of where a link ends: a floor, or columns clamped in the floors above and below, `at` of the height
    of the storey below the floor. The floors lean with a base that rocks."""
    if isinstance(b, Wall):
        return {floors.start: 1.0}
    if floor == 0:
        return {base: 1.0}
    shape = at * at * (3.0 - 2.0 * at)
    weights = {floors.start + floor - 1: shape}
    below = floors.start + floor - 2 if floor > 1 else base
    if below >= 0:
        weights[below] = 1.0 - shape
    if foot >= 0:
        weights[foot] = float(b.height[floor - 1]) * (at - shape)
    return {dof: weight for dof, weight in weights.items() if weight}


def _add_link(made: _Elements, link: Link, ends: Sequence[Weights]) -> None:
    """A link between two ends; its law is told the masses that move with them."""
    inverse = [sum(w * w * made.dofs[i]["inv_mass"] for i, w in end.items()) for end in ends]
    masses = [1.0 / each if each else math.inf for each in inverse]
    numbers = link.law.numbers(*masses)
    if isinstance(link.law, WrittenLaw):
        made.formulas.append(link.law.force(1.0 / sum(inverse)))
    left, right = ends
    weights = left | {dof: -weight for dof, weight in right.items()}
    eased = link.law.behaviour.force is not None
    formula = max(len(made.formulas) - 1, 0)
    element = _element(link.law.behaviour, numbers, offset=link.law.offset, eased=eased, formula=formula)
    if not link.law.can_close:  # its closing alone is asked for
        element = _element(JOINED, (0.0, 0.0))
    made.links.append((element, weights))


def _filled(dtype: np.dtype, rows: Sequence[Mapping[str, Any]], least: int = 0) -> np.ndarray:
    """Records with these fields, zero where nothing is said."""
    records = np.zeros(max(len(rows), least), dtype)
    for name in {name for row in rows for name in row}:
        blank = (0.0,) * PARAMETERS if name == "p" else 0
        records[name][: len(rows)] = [row.get(name, blank) for row in rows]
    return records


def _formulas(formulas: Sequence[Formula]) -> np.ndarray:
    """Records of formulas, one at least."""
    records = np.zeros(max(len(formulas), 1), FORMULA)
    for record, formula in zip(records, formulas, strict=False):
        record["count"], record["result"] = len(formula.rows), formula.result
        record["operations"][: len(formula.rows)] = formula.rows
    return records


def _tied(elements: np.ndarray, first: int, all_weights: Sequence[Weights], terms: list[tuple[float, int]]) -> None:
    """Enter the degrees of freedom of links: two plain ends where there are, all else as terms."""
    for element, weights in zip(elements[first:], all_weights, strict=True):
        ends = [next((i for i, w in weights.items() if w == sign), -1) for sign in (1.0, -1.0)]
        left, right = (0, 0) if -1 in ends else ends  # no plain ends: all weights are terms
        element["left"], element["right"], element["hold"], element["first"] = left, right, 1.0, len(terms)
        terms += [(w, i) for i, w in weights.items() if left == right or i not in (left, right)]
        element["last"] = len(terms)


def _column_shears(
    struck: Sequence[Columns], floors: Sequence[slice], first_link: int, terms: list[tuple[float, int]]
) -> list[dict[str, Any]]:
    """The shears below and above every blow: what the columns have of the storey's shear, and of the forces of all
    blows on them the reaction of a clamped beam at that end; between two blows, that of both sides."""
    made = []
    for own in struck:
        for above in (False, True):
            first = len(terms)
            for other in struck:
                if (other.building, other.storey, other.on_left) != (own.building, own.storey, own.on_left):
                    continue
                to_above = other.at * other.at * (3.0 - 2.0 * other.at)
                higher = other.at > own.at if above else other.at >= own.at
                weight = 1.0 - to_above if higher else -to_above
                terms.append((weight if own.on_left else -weight, first_link + other.link))
            storey = floors[own.building].start + own.storey - 1
            made.append({"share": own.share, "storey": storey, "first": first, "last": len(terms)})
    return made


@functools.lru_cache(maxsize=64)  # the same for every motion
def layout_of(buildings: tuple[Building, ...], links: tuple[Link, ...], effects: Effects) -> Layout:
    """Lay out buildings and links."""
    made = _Elements()
    places = [_add_building(made, b, effects.yielding, effects.collapse) for b in buildings]
    for link in links:
        ends = [_end(buildings[b], *places[b], floor, at) for b, floor, at in link.ends]
        _add_link(made, link, ends)
    n, others = len(made.dofs), [*made.drags, *made.links]
    dofs = _filled(DOF, made.dofs)
    rows = [{"collapse": math.inf} | fields for fields in (*made.storeys, *(own for own, _ in others))]
    elements, terms = _filled(ELEMENT, rows), list[tuple[float, int]]()
    for i, element in enumerate(elements[:n]):
        element["left"], element["right"], element["hold"] = i, max(i - 1, 0), dofs[i]["below"]
        element["first"] = len(terms)
        terms += [(dofs[i]["lean"], dofs[i]["foot"])] if dofs[i]["lean"] else []
        element["last"] = len(terms)
    _tied(elements, n, [weights for _, weights in others], terms)
    struck, floors = struck_columns(links), tuple(place[0] for place in places)
    columns = _filled(COLUMN, _column_shears(struck, floors, n + len(made.drags), terms), 1)
    table = np.zeros(max(len(terms), 1), TERM)
    table["weight"][: len(terms)], table["dof"][: len(terms)] = [w for w, _ in terms], [i for _, i in terms]
    behaviours = [BEHAVIOURS[kind] for kind in elements["kind"].tolist()]
    storeys = np.flatnonzero([each.force is not None for each in behaviours[:n]])
    elements["row"][storeys] = elements.size - n + np.arange(storeys.size)
    maxwell = Maxwell.behaviour
    changing = [e for e, each in enumerate(behaviours) if each.history_rate is not None or each is maxwell]
    elements["state"][changing] = 2 * n + np.arange(len(changing))
    return Layout(
        buildings, links, dofs, elements, table, columns, _formulas(made.formulas), floors,
        tuple(place[1] for place in places), tuple(place[2] for place in places), len(made.drags), struck,
        any(each.force is not None for each in behaviours),
    )  # fmt: skip


def term_matrix(layout: Layout) -> np.ndarray:
    """Rows that give the deformation of every element from the displacements, shape (elements, degrees of freedom)."""
    matrix = np.zeros((layout.elements.size, layout.number))
    for row, element in zip(matrix, layout.elements, strict=True):
        row[element["left"]] += 1.0
        row[element["right"]] -= element["hold"]
        for x in range(element["first"], element["last"]):
            row[layout.terms["dof"][x]] += layout.terms["weight"][x]
    return matrix


def segments(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """(acceleration at each segment's start [m/s2], its slope [m/s3]); a tail is still ground. Scenes of one motion
    share the arrays; nothing writes to them."""
    return _segments(scene.motion, math.ceil(max(scene.tail, 0.0) / scene.motion.dt - 1e-9))


@functools.lru_cache(maxsize=16)
def _segments(motion: Motion, still: int) -> tuple[np.ndarray, np.ndarray]:
    tail = np.zeros(still)
    slopes = np.diff(motion.acceleration) / motion.dt
    return np.concatenate((motion.acceleration[:-1], tail)), np.concatenate((slopes, tail))


def _at_line(rows: np.ndarray) -> np.ndarray:
    """A copy that begins at a line of the processor's cache (64 bytes)."""
    room = np.empty(rows.nbytes + 64, np.uint8)
    first = -room.ctypes.data % 64
    made = room[first : first + rows.nbytes].view(rows.dtype)
    made[:] = rows
    return made


def records_of(
    scene: Scene,
    layout: Layout,
    accuracy: float,
    method: Method,
    initial: tuple[Sequence[np.ndarray], Sequence[np.ndarray]] | None,
    times: np.ndarray | None,
    bounds: tuple[int, int],
) -> Data:
    """The records of a run; parameters as of `solve.prepare`."""
    dofs, elements, run = _at_line(layout.dofs), layout.elements.copy(), np.zeros(1, RUN)
    if initial is not None:
        for span, u, v in zip(layout.floors, *initial, strict=True):
            dofs["u0"][span], dofs["w"][span, 0] = u, v
    tolerance = min(max(accuracy * SAFETY, FINEST), COARSEST)
    r, always_smooth = run[0], method.name == "dop853"
    r["n"], r["m"], r["drags"], r["columns"] = layout.number, elements.size, layout.drags, 2 * len(layout.struck)
    r["dt"], r["tolerance"], r["least"] = scene.motion.dt, tolerance, _least_acceleration(scene, dofs, elements)
    r["smooth_tolerance"] = max(SMOOTHER * tolerance, FINEST_SMOOTH)
    r["points"] = next(points for above, points in POINTS if accuracy >= above)
    r["max_order"], r["has_lean"] = max_order(tolerance), bool(np.any(dofs["lean"] != 0.0))
    r["most_steps"], r["most_events"] = bounds
    r["always_smooth"] = always_smooth
    room = None
    if layout.has_smooth or always_smooth or method.takes_step:
        changing = int(np.count_nonzero(elements["state"]))
        room = Room(np.zeros(2 * layout.number + changing, STATE), layout.formulas.copy())
        room.states["scale"] = LEAST_STATE
    rows = max(elements.size - layout.number + layout.number * layout.has_smooth, 1)
    kept, n, m = np.zeros(0) if times is None else times, layout.number, elements.size
    t = kept.size
    watch = Watch(kept, np.zeros((t, n, 3)), np.zeros((t, m, 2)), np.zeros((t, 3)), np.zeros((t, n)))
    return Data(dofs, elements, layout.terms, run, np.zeros(rows, SERIES), layout.columns.copy(), room, watch)


def _least_acceleration(scene: Scene, dofs: np.ndarray, elements: np.ndarray) -> float:
    """Acceleration [m/s2] below which nothing is resolved: a part of the ground's peak, or on still ground that of the
    start: the largest spring force per mass, or what would turn its largest velocity within a second."""
    if scene.motion.pga > 0:
        return LEAST_SCALE * scene.motion.pga
    n = dofs.size
    below = np.concatenate(([0.0], dofs["u0"][:-1])) * dofs["below"]
    pulls = elements["p"][:n, 0] * np.abs(dofs["u0"] - below) * dofs["inv_mass"]
    return max(float(pulls.max()), float(np.abs(dofs["w"][:, 0]).max()))
