"""One impact from model to result: force, separation, energy, stresses in wall, beams and columns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pounding_cli.errors import InputError, Problem
from pounding_cli.wall.assembly import assemble
from pounding_cli.wall.mesh import build_mesh
from pounding_cli.wall.model import Bond, WallModel
from pounding_cli.wall.stress import stress_operators, von_mises
from pounding_cli.wall.transient import Transient, integrate, natural_step

MOST_STEPS = 200_000


@dataclass(frozen=True, eq=False)
class Fields:
    """What is drawn on the mesh; e elements, n corner nodes, f frame nodes.

    points [m], shape (n, 2); quads : node numbers, shape (e, 4);
    displacement : at the stress peak [m], shape (n, 2); time_of_peak [s];
    stress_peak : von Mises at the instant of its largest value [N/m2], shape (e,);
    stress_envelope : largest over time [N/m2], shape (e,)
    """

    points: np.ndarray
    quads: np.ndarray
    displacement: np.ndarray
    stress_peak: np.ndarray
    stress_envelope: np.ndarray
    time_of_peak: float


@dataclass(frozen=True, eq=False)
class WallResponse:
    """The result of one impact.

    transient : history
    step : time step used [s]; freedoms : number of unknowns [-]
    peak_force [N] at peak_time [s]; impulse : of the contact force [N s];
    separation : first time the striker leaves (glued: that the force pulls) [s], NaN if it never does;
    last_contact : last time the striker pushes [s];
    momentum_residual : impulse less the striker's change of momentum, over its first momentum [-];
    energy_residual : the energy that is missing or too much, its largest over time, over the first energy [-]
    wall_stress : largest von Mises of an element's mean stress [N/m2];
    averaged_stress : largest von Mises of the mean stress in a cell of side `averaging_length` [N/m2];
    beam_stress, column_stress : largest edge stress over time [N/m2];
    beam_stress_then, column_stress_then : the same at the instant of the wall's peak [N/m2];
    reach : farthest from the contact that a cell's stress exceeds half the largest [m];
    stressed_share : share of the wall's area whose envelope exceeds a tenth of `averaged_stress` [-]
    cell_height [m], cell_stress : envelope of the cells' von Mises [N/m2], shape (c,)
    row_height [m]; normal, shear [N], moment [N m] : largest size over time in each row, shape (r,)
    """

    transient: Transient
    step: float
    freedoms: int
    peak_force: float
    peak_time: float
    separation: float
    last_contact: float
    impulse: float
    momentum_residual: float
    energy_residual: float
    wall_stress: float
    averaged_stress: float
    beam_stress: float
    column_stress: float
    beam_stress_then: float
    column_stress_then: float
    reach: float
    stressed_share: float
    cell_height: np.ndarray
    cell_stress: np.ndarray
    row_height: np.ndarray
    normal: np.ndarray
    shear: np.ndarray
    moment: np.ndarray
    fields: Fields
    flags: tuple[str, ...]

    @property
    def wall_shear(self) -> float:
        """Largest shear force in a cross-section of the wall over time [N]."""
        return float(self.shear.max())

    @property
    def wall_moment(self) -> float:
        """Largest bending moment in a cross-section of the wall over time [N m]."""
        return float(self.moment.max())


class _Recorder:
    """Takes from every step the largest values and the field at the stress peak."""

    def __init__(self, model: WallModel, operators, system, step: float) -> None:
        self.model, self.operators, self.system, self.step = model, operators, system, step
        self.elements = np.zeros(operators.area.size)
        self.field = self.elements.copy()
        self.at_peak, self.peak, self.time = np.zeros(system.M.size), -1.0, 0.0
        self.cells = np.zeros(operators.cell_height.size)
        self.rows = np.zeros((operators.row_height.size, 3))
        self.members = np.zeros(system.members.shape[0])

    def __call__(self, n: int, u: np.ndarray) -> None:
        stress = von_mises((self.operators.elements @ u).reshape(-1, 3))
        np.maximum(self.elements, stress, out=self.elements)
        top = stress.max()
        if top > self.peak:
            self.peak, self.time, self.field, self.at_peak = top, n * self.step, stress, u.copy()
        np.maximum(self.cells, von_mises((self.operators.cells @ u).reshape(-1, 3)), out=self.cells)
        np.maximum(self.rows, np.abs((self.operators.resultants @ u).reshape(-1, 3)), out=self.rows)
        np.maximum(self.members, np.abs(self.system.members @ u), out=self.members)


def strike(model: WallModel) -> WallResponse:
    """Solve one impact.

    Raises
    ------
    InputError : where it would take too many steps or gave a number that is not finite, with what to change
    """
    wall = build_mesh(model)
    system = assemble(model, wall)
    operators = stress_operators(model, wall, system)
    wished = model.time.step or natural_step(system, model)
    if model.time.end / wished > MOST_STEPS:
        raise InputError(
            Problem(
                f"an impact this short needs {model.time.end / wished:.0f} time steps",
                f"give an earlier `time.end`, e.g. {MOST_STEPS / 10 * wished:.1g} s, or a heavier striker",
            )
        )
    step = model.time.end / max(10, np.ceil(model.time.end / wished - 1e-9))
    recorder = _Recorder(model, operators, system, step)
    run = integrate(system, model.striker, model.contact.bond, model.time.end, step, model.time.rho, each=recorder)
    if not (np.isfinite(run.force).all() and np.isfinite(run.strain_energy).all()):
        raise InputError(
            Problem(
                "the response is not finite",
                "masses and stiffnesses differ by too many powers of ten",
            )
        )
    peak = int(np.argmax(run.force))
    start = model.striker.mass * model.striker.speed
    impulse = float(np.trapezoid(run.force, run.time))
    energy = run.striker_energy + run.kinetic_energy + run.strain_energy
    averaged = float(recorder.cells.max())
    contact = 0.5 * sum(model.patch)
    corners = wall.mesh.p.shape[1]
    # scikit-fem numbers the corners of the mesh first
    moved = (system.spread @ recorder.at_peak).reshape(-1, 2)[wall.basis.nodal_dofs[0]][:corners]
    beams = 4 * system.beams
    then = np.abs(system.members @ recorder.at_peak)
    return WallResponse(
        transient=run,
        step=step,
        freedoms=system.M.size,
        peak_force=float(run.force[peak]),
        peak_time=float(run.time[peak]),
        separation=separation(run.time, run.force),
        last_contact=float(run.time[np.flatnonzero(run.force > 0)[-1]]),
        impulse=impulse,
        momentum_residual=impulse / start - (1 - float(run.velocity[-1]) / model.striker.speed),
        energy_residual=float(np.abs(energy / energy[0] - 1).max()),
        wall_stress=float(recorder.elements.max()),
        averaged_stress=averaged,
        beam_stress=float(recorder.members[:beams].max()),
        column_stress=float(recorder.members[beams:].max()),
        beam_stress_then=float(then[:beams].max()),
        column_stress_then=float(then[beams:].max()),
        reach=reach(np.abs(operators.cell_height - contact), recorder.cells),
        stressed_share=float(operators.area[recorder.elements > 0.1 * averaged].sum() / operators.area.sum()),
        cell_height=operators.cell_height,
        cell_stress=recorder.cells,
        row_height=operators.row_height,
        normal=recorder.rows[:, 0],
        shear=recorder.rows[:, 1],
        moment=recorder.rows[:, 2],
        fields=Fields(
            wall.mesh.p.T.copy(),
            wall.mesh.t.T.copy(),
            moved,
            recorder.field,
            recorder.elements,
            recorder.time,
        ),
        flags=_flags(model, run, energy),
    )


def reach(distance: np.ndarray, stress: np.ndarray) -> float:
    """Farthest distance at which the stress is half its largest [m], on straight lines between the cells."""
    half = 0.5 * stress.max()
    ends = [float(distance[stress >= half].max())]
    for i in np.flatnonzero((stress[1:] >= half) != (stress[:-1] >= half)):
        share = (half - stress[i]) / (stress[i + 1] - stress[i])
        ends.append(float(distance[i] + share * (distance[i + 1] - distance[i])))
    return max(ends)


def separation(time: np.ndarray, force: np.ndarray) -> float:
    """First time the force is positive no more [s], on a straight line between steps; NaN if it stays so."""
    pushed = np.flatnonzero(force > 0)
    if pushed.size == 0:
        return float("nan")
    free = np.flatnonzero(force[pushed[0] :] <= 0)
    if free.size == 0:
        return float("nan")
    n = pushed[0] + free[0]
    before, after = force[n - 1], force[n]
    # Cut off at zero, the force goes on falling as in the step before, but not beyond the step.
    fall = before - after if after < 0 else max(force[n - 2] - before, before)
    return float(time[n - 1] + (time[n] - time[n - 1]) * before / fall)


def _flags(model: WallModel, run: Transient, energy: np.ndarray) -> tuple[str, ...]:
    found = []
    if model.patch_is_cut:
        low, high = model.patch
        found.append(f"the patch ends with the wall: {high - low:.3g} m of {model.contact.patch:.3g} m touch")
    if run.force[-1] > 0 and model.contact.bond is Bond.UNILATERAL:
        found.append(f"still in contact at {run.time[-1]:.3g} s: give a later `time.end`")
    if np.abs(energy / energy[0] - 1).max() > 5e-3:
        found.append("the energy balance is open by more than 0.5 %: give a smaller `time.step`")
    return tuple(found)
