"""The state of scenes at a time after the motion: their equilibrium, and how far they may ever get from it.

With the stiffness matrix K of the present branches and the displacements u* of their equilibrium, a scene still holds

    H = sum(m u'^2) / 2 + (u - u*)^T K (u - u*) / 2   and what its contacts store,

and on still ground nothing adds to it. So the deformation w^T u of an element is never further from w^T u* than
sqrt(2 H w^T K^-1 w), its *reach*. A contact that is open at rest only takes from H, whether it closes on the way or
not.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from pounding_cli.laws import BEHAVIOURS
from pounding_cli.laws.formula import WRITTEN_BEHAVIOUR, WrittenLaw, evaluate_operations
from pounding_cli.laws.joints import Maxwell
from pounding_cli.laws.law import LinkLaw
from pounding_cli.laws.slider import FRICTION
from pounding_cli.model.scene import Scene
from pounding_cli.solver.balance import compute_forces
from pounding_cli.solver.branches import TOUCH
from pounding_cli.solver.layout import Layout, build_term_matrix
from pounding_cli.solver.records import Data

STILL = 5e-4
"""Reach of a storey over its drift at rest [-] at which it counts as at rest although its branch may still end."""

LEAST_DRIFT = 0.02
"""Part of a storey's largest drift [-] that stands for its drift at rest where that is smaller."""

UNDAMPED = 1e-6
"""Damping ratio [-] below which a mode counts as undamped."""

DASHPOTS_OF_BLOW = 3.0
"""Largest force of a blow over that of its spring alone at the largest closing [-]: the dashpot 2 xi sqrt(k m) adds at
most 2 sqrt(2 H k) to sqrt(2 H k)."""

ROUNDING = 1e-13
"""Drift at rest over the largest displacement [-] below which it is rounding."""

NUDGE = 1e-6
"""Part of a deformation by which the slope of a curved force is found."""


class RestState:
    """Scenes of one layout at a time after the motion, on their present branches.

    A base on a slider that sticks is where it is, and everything else vibrates about the equilibrium beside it.

    drift : deformation of every element at the equilibrium of these branches [m], shape (scenes, elements)
    reach : how far every element may ever get from there [m], inf where that is not bounded
    drive : force at the equilibrium that would move a base held by a slider [N], shape (scenes, degrees of freedom)
    drive_reach : how far it may ever get from there [N]
    """

    def __init__(self, layout: Layout, scenes: Sequence[Scene], data: Data) -> None:
        self.layout = layout
        self.scenes = scenes
        self.data = data
        self.is_contact = np.zeros(data.elements.shape, bool)
        for row, scene in enumerate(scenes):
            self.is_contact[row, layout.of_links] = [not link.law.joins for link in scene.links]
        self.is_pressed = np.zeros_like(self.is_contact)
        self.is_held = data.elements["holds"][:, : layout.number] > 0
        self.is_still = self.is_held | (layout.dofs["inv_mass"] == 0.0)
        self.is_storey = layout.elements["drifts"] > 0  # lines too
        self.is_storey.setflags(write=False)
        self._put_lines()
        self._find_equilibrium()
        would_press = self.is_contact & (self.drift > TOUCH) & (data.elements["closed"] > 0)
        if would_press.any():
            self.is_pressed = would_press
            self._find_equilibrium()
        self._find_reach()

    def _put_lines(self) -> None:
        """Enter stiffness [N/m] and offset [N] of every element, straight lines in place of curved forces."""
        elements = self.data.elements
        n = self.layout.number
        self.k = np.where(elements["acts"] > 0, elements["k"], 0.0)
        self.f0 = np.where(elements["acts"] > 0, elements["f0"], 0.0)
        self.k[:, n : self.layout.of_lines.start] = 0.0
        is_sum = elements["twists"] > 0  # its lines have elements of their own
        self.k = np.where(is_sum, elements["p"][:, :, 0], self.k)
        self.f0 = np.where(is_sum, 0.0, self.f0)
        is_smooth = self.is_storey & (elements["smooth"] > 0)
        self.is_curved = is_smooth.copy()
        self.k = np.where(is_smooth, elements["p"][:, :, 0], self.k)
        self.f0 = np.where(is_smooth, compute_forces(elements) - self.k * elements["v1"], self.f0)
        relaxes = elements["relaxation"] > 0.0
        self.k[relaxes] = 0.0
        curved = (elements["acts"] > 0) & ((elements["smooth"] > 0) | (elements["cubic"] != 0.0))
        curved[:, self.is_storey] = False
        for row, place in np.argwhere(curved).tolist():
            self.k[row, place], self.f0[row, place] = self._find_tangent(row, place)
            self.is_curved[row, place] = self.k[row, place] != 0.0

    def _find_tangent(self, row: int, place: int) -> tuple[float, float]:
        """Return the tangent (stiffness [N/m], offset [N]) of a curved force at the present deformation, at rest.

        It is 0 where a building that falls has gone beyond the range of numbers.
        """
        element = self.data.elements.view(np.recarray)[row, place]
        v = float(element.v1)
        step = NUDGE * max(abs(v), NUDGE)
        above = self._compute_force(element, row, v + step, 0.0)
        below = self._compute_force(element, row, v - step, 0.0)
        k = (above - below) / (2.0 * step)
        offset = 0.5 * (above + below) - k * v
        return (k, offset) if math.isfinite(k) and math.isfinite(offset) else (0.0, 0.0)

    def _compute_force(self, element: Any, row: int, v: float, rate: float) -> float:
        """Return the force [N] of an element at the deformation v [m] and the rate [m/s]."""
        force = float(element.k * v + element.c * rate + element.cubic * (v * v * v) + element.f0)
        if element.smooth and BEHAVIOURS[element.kind] is WRITTEN_BEHAVIOUR:
            assert self.data.room is not None  # of every scene with a formula
            formula = self.data.room.formulas.view(np.recarray)[row, element.formula]
            return force + float(evaluate_operations(formula, v, rate))
        smooth_force = BEHAVIOURS[element.kind].force
        if element.smooth and smooth_force is not None:
            return force + float(smooth_force(element, v, rate))
        return force

    def _find_equilibrium(self) -> None:
        """Find the equilibrium, with the contacts that are pressed and without the others."""
        shape = _build_shape(self.layout)
        acts = ~self.is_contact | self.is_pressed
        k = np.where(acts, self.k, 0.0)
        f0 = np.where(acts, self.f0, 0.0)
        offset = self.data.elements["offset"]
        self.whole_matrix = _build_stiffness_matrix(self.layout, k)
        self.matrix = _hold(self.whole_matrix, self.is_still, 1.0)
        place = np.where(self.is_held, self.data.dofs["u0"], 0.0)  # of what does not move
        pull = (k * offset - f0) @ shape
        free_pull = np.where(self.is_still, place, pull - _multiply(self.whole_matrix, place))
        self.is_stable = np.linalg.eigvalsh(self.matrix)[:, 0] > 0.0
        self.matrix[~self.is_stable] = np.eye(self.layout.number)
        self.displacement = np.linalg.solve(self.matrix, free_pull[..., None])[..., 0]
        self.drive = pull - _multiply(self.whole_matrix, self.displacement)
        self.drift = self.displacement @ shape.T - offset
        size = np.abs(self.displacement).max(axis=1, keepdims=True, initial=0.0)
        self.drift[np.abs(self.drift) <= ROUNDING * size] = 0.0

    def _find_reach(self) -> None:
        """Find how far the energy that is left takes every element, and the force on every held base."""
        shape = _build_shape(self.layout)
        dofs = self.data.dofs
        away = dofs["u0"] - self.displacement
        energy = 0.5 * (dofs["mass"] * dofs["w"][:, :, 0] ** 2).sum(axis=1)
        energy += 0.5 * np.einsum("si,sij,sj->s", away, self.matrix, away) + self._compute_energy_beside()
        self.twice_energy = 2.0 * np.maximum(energy[:, None], 0.0)
        inverse = _hold(np.linalg.inv(self.matrix), self.is_still, 0.0)
        flexibility = np.einsum("en,snk,ek->se", shape, inverse, shape)
        self.reach = np.sqrt(self.twice_energy * np.maximum(flexibility, 0.0))
        self.reach[~self.is_stable] = math.inf
        self.drive_reach = np.zeros(self.is_held.shape)
        if self.is_held.any():
            self._find_drive_reach(inverse)

    def _find_drive_reach(self, inverse: np.ndarray) -> None:
        """Find how far the force on every held base may get from that at the equilibrium.

        It is linear in displacements, velocities and forces of Maxwell dampers, whose squares make up the energy; the
        forces of contacts that may close, and of links whose forces are curved, come on top of it.
        """
        shape = _build_shape(self.layout)
        elements = self.data.elements
        inverse_mass = np.where(self.is_still, 0.0, self.layout.dofs["inv_mass"])
        slopes = np.where(self.is_still[:, None, :], 0.0, self.whole_matrix)
        squares = np.einsum("sij,sjk,sik->si", slopes, inverse, slopes)
        rates = shape.T @ (self._list_dashpots()[:, :, None] * shape)
        squares += np.einsum("sij,sj->si", rates**2, inverse_mass)
        squares += np.where(elements["relaxation"] > 0.0, elements["k"], 0.0) @ shape**2
        self.drive_reach = np.where(self.is_held, np.sqrt(self.twice_energy * squares), 0.0)
        rate_reach = np.sqrt(self.twice_energy * (inverse_mass @ (shape**2).T))
        is_beside = (self.is_contact & ~self.is_pressed & (self.drift + self.reach > 0.0)) | (
            (elements["acts"] > 0) & (elements["smooth"] > 0) & ~self.is_contact
        )
        is_beside[:, self.is_storey] = False
        for row, place in np.argwhere(is_beside).tolist():
            weights = np.where(self.is_held[row], np.abs(shape[place]), 0.0)
            if weights.any():
                self.drive_reach[row] += weights * self._find_largest_force(row, place, float(rate_reach[row, place]))

    def _find_largest_force(self, row: int, place: int, rate: float) -> float:
        """Return how far the force of a contact or of a link whose force is curved may get from that at rest [N].

        rate : largest rate [m/s]
        """
        rest = float(self.drift[row, place])
        reach = float(self.reach[row, place])
        element = self.data.elements.view(np.recarray)[row, place]
        if self.is_contact[row, place]:
            law = self.scenes[row].links[place - self.layout.of_links.start].law
            closing = rest + reach + float(element.offset)
            step = NUDGE * (rest + reach)
            gained = law.stored_energy(closing + step, 0.0) - law.stored_energy(closing, 0.0)
            return DASHPOTS_OF_BLOW * gained / step
        ends = [(rest + side * reach, way * rate) for side in (-1.0, 1.0) for way in (-1.0, 1.0)]
        at_rest = self._compute_force(element, row, rest, 0.0)
        tangent = float(self.k[row, place]) * reach  # which is in the linear part
        return max(abs(self._compute_force(element, row, v, r) - at_rest) for v, r in ends) + tangent

    def _list_dashpots(self) -> np.ndarray:
        """Return the dashpots of all elements that act [N s/m], shape (scenes, elements)."""
        elements = self.data.elements
        n = self.layout.number
        first_line = self.layout.of_lines.start
        is_open = self.is_contact & ~self.is_pressed
        c = np.where(is_open, 0.0, elements["c"])
        c = np.where(elements["twists"] > 0, elements["p"][:, :, 1], c)  # its lines have dashpots of their own
        c[:, n:first_line] = elements["p"][:, n:first_line, 1]
        return c

    def _compute_energy_beside(self) -> np.ndarray:
        """Return the energy [J] in contacts that are open at rest and in Maxwell dampers, shape (scenes,)."""
        elements = self.data.elements
        first = self.layout.of_links.start
        stored = np.zeros(len(self.scenes))
        for row, place in np.argwhere((elements["closed"] > 0) & ~self.is_pressed).tolist():
            if place < first:
                continue
            law = self.scenes[row].links[place - first].law
            element = elements[row, place]
            if isinstance(law, Maxwell):
                stored[row] += law.stored_energy(0.0, float(element["h"][0]))
            elif not law.joins:
                force = float(element["k"] * element["v1"] + element["f0"])
                stored[row] += law.stored_energy(float(element["v1"] + element["offset"]), force)
        return stored

    def is_at_rest(self, largest: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return whether scenes are at rest but for a vibration that moves no drift at rest, and whether that is sure.

        It is where no element can leave its branch, and not where the vibration is only small.

        largest : largest drift of every storey and frame line [m], shape (scenes, elements before the links)
        """
        elements = self.data.elements
        n = self.layout.number
        is_open = self.is_contact & ~self.is_pressed
        fits = np.where(is_open, self.drift <= TOUCH, ~self.is_contact | (self.drift > 0.0))
        stays = (self.drift - self.reach > elements["low"]) & (self.drift + self.reach < elements["high"])
        stays &= np.isneginf(elements["slow"]) & np.isposinf(elements["fast"]) & ~self.is_curved
        stays &= np.abs(self.drift) + self.reach < elements["collapse"]
        storeys = np.flatnonzero(self.is_storey)
        scale = np.maximum(np.abs(self.drift[:, storeys]), LEAST_DRIFT * largest[:, storeys])
        is_still = (self.reach[:, storeys] <= STILL * scale).all(axis=1)
        friction = np.where(self.is_held, elements["p"][:, :n, FRICTION], math.inf)
        holds = (np.abs(self.drive) + self.drive_reach < friction).all(axis=1)
        is_sure = (is_open | stays).all(axis=1)
        return self.is_stable & fits.all(axis=1) & holds & (is_sure | is_still), is_sure

    def is_undamped(self) -> np.ndarray:
        """Return whether a mode of the buildings has no damping, neither of theirs nor of links; shape (scenes,)."""
        layout = self.layout
        omega, modes = _find_modes(layout)
        takes_energy = [[_always_takes_energy(link.law) for link in scene.links] for scene in self.scenes]
        c = np.where(self.is_contact, 0.0, self._list_dashpots())
        in_modes = (_build_shape(layout) @ modes) ** 2
        of_masses = (layout.dofs["drag"] * layout.dofs["mass"]) @ modes**2
        ratios = (c @ in_modes + of_masses) / (2.0 * omega)
        return (ratios < UNDAMPED).any(axis=1) & ~np.array(takes_energy, bool).any(axis=1)


def find_longest_period(layout: Layout) -> float:
    """Return the longest period of the buildings with their initial stiffnesses [s]."""
    return 2.0 * math.pi / float(_find_modes(layout)[0].min(initial=math.inf))


@functools.lru_cache(maxsize=64)
def _find_modes(layout: Layout) -> tuple[np.ndarray, np.ndarray]:
    """Return frequencies [rad/s] and shapes of what moves, without links and on sliders that stick.

    The buildings have their initial stiffnesses; the shapes are over the square roots of the masses. Shapes (modes,)
    and (n, modes).
    """
    n = layout.number
    k = np.zeros((1, layout.elements.size))
    is_spring = layout.elements["drifts"] > 0
    k[0, is_spring] = layout.elements["p"][is_spring, 0]
    is_still = (layout.dofs["inv_mass"] == 0.0) | (layout.elements["slides"][:n] > 0)
    root = np.sqrt(np.where(is_still, 0.0, layout.dofs["inv_mass"]))
    matrix = _hold(_build_stiffness_matrix(layout, k), is_still[None, :], 0.0)[0]
    squares, shapes = np.linalg.eigh(matrix * np.outer(root, root))
    moves = squares > 0.0
    return np.sqrt(squares[moves]), root[:, None] * shapes[:, moves]


@functools.lru_cache(maxsize=64)
def _build_shape(layout: Layout) -> np.ndarray:
    """Return `build_term_matrix` of a layout, made once."""
    return build_term_matrix(layout)


@functools.lru_cache(maxsize=64)
def _build_load_matrix(layout: Layout) -> np.ndarray:
    """Return the stiffness that P-Delta takes away [N/m], shape (n, n). The weight acts on the floors alone."""
    rows = np.eye(layout.number)
    for i in range(1, layout.number):
        rows[i, i - 1] = -layout.dofs["below"][i]
    return rows.T @ (layout.elements["load"][: layout.number, None] * rows)


def _build_stiffness_matrix(layout: Layout, k: np.ndarray) -> np.ndarray:
    """Return the stiffness matrices of elements of the stiffnesses k [N/m], shape (scenes, n, n)."""
    shape = _build_shape(layout)
    return shape.T @ (k[:, :, None] * shape) - _build_load_matrix(layout)


def _hold(matrix: np.ndarray, is_still: np.ndarray, diagonal: float) -> np.ndarray:
    """Return matrices with `diagonal` and nothing beside it for degrees of freedom that do not move."""
    held = np.where(is_still[:, :, None] | is_still[:, None, :], 0.0, matrix)
    row, place = np.nonzero(is_still)
    held[row, place, place] = diagonal
    return held


def _multiply(matrices: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """Return the products of matrices (scenes, n, n) and vectors (scenes, n)."""
    return np.einsum("sij,sj->si", matrices, vectors)


def _always_takes_energy(law: LinkLaw) -> bool:
    """Return whether a link may take energy at any closing, by more than the dashpot of its branch."""
    return law.joins and (law.takes_energy or isinstance(law, WrittenLaw))
