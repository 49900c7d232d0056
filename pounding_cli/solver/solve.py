"""`solve`: one scene in, one response out, whatever the method; `solve_all`: many scenes at once."""

from __future__ import annotations

import gc
import logging
import time
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from math import ceil, nan
from typing import Any

import numba
import numpy as np

from pounding_cli.errors import InputError
from pounding_cli.laws.slider import Slider
from pounding_cli.methods import Method, get_method
from pounding_cli.model.effects import effects_of
from pounding_cli.model.links import Link
from pounding_cli.model.parts import divide_scene
from pounding_cli.model.scene import Scene
from pounding_cli.solver import outcome, records
from pounding_cli.solver.assemble import MAX_EVENTS, MAX_STEPS, Bounds, InitialState, build_records
from pounding_cli.solver.balance import balance_energies, compute_energy_of_lines, compute_energy_of_storeys
from pounding_cli.solver.flags import build_collapse_flag, list_flags
from pounding_cli.solver.kernels import FIXED_STEP_KERNEL, FOLDER, IS_INTERPRETED, find_kernel, mark_compiled
from pounding_cli.solver.layout import Layout, build_layout, build_term_matrix
from pounding_cli.solver.parts import join_responses
from pounding_cli.solver.records import Data, Room
from pounding_cli.solver.response import COLLAPSED, DONE, Flag, Response, no_peaks
from pounding_cli.solver.rest import find_rest
from pounding_cli.solver.segments import Segments, build_segments, join_segments
from pounding_cli.solver.stopping import call_kernel, find_flag


def solve(
    scene: Scene,
    accuracy: float = 1e-6,
    method: str = "taylor",
    initial: InitialState | None = None,
    bounds: Bounds = (MAX_STEPS, MAX_EVENTS),
    *,
    time_step: float | None = None,
    least_steps: int = 1,
) -> Response:
    """Return the response of a scene; from rest its parts that nothing links are solved each by itself.

    Parameters
    ----------
    scene : in SI units
    accuracy : wanted relative error of the peaks [-]; a method that takes a time step has no use for it
    method : a key of METHODS
    initial : state at the start; None is rest
    bounds : largest number of steps, largest number of events
    time_step : of a method that takes one (`methods.METHODS`) [s]
    least_steps : in a time step of the motion, of a method that chooses its steps: runs of one accuracy that have other
        steps round otherwise

    Raises
    ------
    InputError : unknown method, a setting that it does not take or that is not above zero, or a scene that it cannot
        run
    """
    parts = divide_scene(scene) if initial is None else ()
    if parts:
        responses = [
            solve(each.scene, accuracy, method, bounds=bounds, time_step=time_step, least_steps=least_steps)
            for each in parts
        ]
        return join_responses(scene, parts, responses)
    run = prepare_run([scene], accuracy, method, initial, bounds, time_step=time_step, least_steps=least_steps)
    run.integrate()
    return run.build_responses()[0]


def solve_all(
    scenes: Sequence[Scene],
    accuracy: float = 1e-6,
    method: str = "taylor",
    *,
    time_step: float | None = None,
    bounds: Sequence[Bounds] | None = None,
) -> list[Response]:
    """Return the responses of scenes in their order, each as by `solve`, with bounds of its own.

    Scenes of one layout are run by one call that lets other threads go on, and share its time by their steps.

    Raises
    ------
    InputError : as `solve`
    """
    if bounds is None:
        bounds = [(MAX_STEPS, MAX_EVENTS)] * len(scenes)
    numbers_by_layout = dict[Layout, list[int]]()
    responses = dict[int, Response]()
    for number, scene in enumerate(scenes):
        parts = divide_scene(scene)
        if parts:
            of_parts = solve_all(
                [each.scene for each in parts],
                accuracy,
                method,
                time_step=time_step,
                bounds=[bounds[number]] * len(parts),
            )
            responses[number] = join_responses(scene, parts, of_parts)
        else:
            numbers_by_layout.setdefault(build_layout(scene), []).append(number)
    for numbers in numbers_by_layout.values():
        group = [scenes[number] for number in numbers]
        most = [bounds[number] for number in numbers]
        run = prepare_run(group, accuracy, method, bounds=most, time_step=time_step)
        run.integrate()
        responses |= zip(numbers, run.build_responses(), strict=True)
    return [responses[number] for number in range(len(scenes))]


@dataclass(eq=False)
class SceneRun:
    """Scenes of one layout, laid out for their runs; `integrate`, and then `build_responses`, once each.

    initial_energy : energy in the scenes at the start [J]
    seconds : time inside the kernel [s], shape (scenes,)
    step_limits : longest stable time step [s] of each scene whose time step is too long, by number
    """

    scenes: Sequence[Scene]
    layout: Layout
    data: Data
    method: Method
    accuracy: float
    time_step: float
    initial_energy: float
    seconds: np.ndarray = field(init=False)
    step_limits: dict[int, float] = field(default_factory=dict, init=False)

    def integrate(self) -> None:
        """Run the scenes, with a kernel that is loaded or compiled first where necessary."""
        self.seconds = np.zeros(len(self.scenes))
        self.integrate_records(self.data, np.arange(len(self.scenes)), [build_segments(scene) for scene in self.scenes])

    def integrate_records(self, data: Data, places: np.ndarray, grounds: Sequence[Segments]) -> None:
        """Run the records of the scenes at `places` through their `grounds`, one a scene."""
        if self.method.takes_step:
            for row, place in enumerate(places.tolist()):
                self._march(data, row, place, grounds[row])
            return
        from pounding_cli.solver.run import integrate as kernel

        arguments = (*data, *join_segments(grounds), find_flag())
        load_kernel(find_kernel(False, data.room is not None), kernel, arguments)
        begin = time.perf_counter()
        call_kernel(kernel, arguments)
        steps = data.run["steps"]
        self.seconds[places] += (time.perf_counter() - begin) * steps / max(steps.sum(), 1)

    def _march(self, data: Data, row: int, number: int, ground: Segments) -> None:
        """Run one of the scenes by a method of fixed time steps; not where the step is too long."""
        from pounding_cli.solver import fixed_step

        scene = self.scenes[number]
        elements = data.elements[row]
        room = data.room
        dt = scene.motion.dt
        parts = max(1, ceil(dt / self.time_step - 1e-9))  # the fewest in a sample that are not longer
        if self.method.name == "central-difference":
            limit = fixed_step.find_longest_stable_step(self.layout, elements, scene.links)
            if dt / parts > limit:
                data.run["status"][row] = records.UNSTABLE
                self.step_limits[number] = limit
                return
        assert room is not None  # of every method of fixed time steps
        arguments = (
            data.dofs[row], elements, data.terms, data.run[row : row + 1],
            data.series[row], data.columns[row], Room(room.states[row], room.formulas[row]),
            *ground, elements.view(np.float64), build_term_matrix(self.layout), parts,
            fixed_step.FIXED.index(self.method.name), find_flag(),
        )  # fmt: skip
        load_kernel(FIXED_STEP_KERNEL, fixed_step.march, arguments)
        begin = time.perf_counter()
        try:
            call_kernel(fixed_step.march, arguments)
        except np.linalg.LinAlgError:  # Newton's method has no direction
            data.run["status"][row] = records.NO_ROOT
        self.seconds[number] += time.perf_counter() - begin

    def build_responses(self) -> list[Response]:
        """Return the responses of the scenes, after `integrate`."""
        data = self.data
        scenes = self.scenes
        with np.errstate(all="ignore"):  # a run that failed may have ended at any numbers
            energies = {}
            if not self.method.takes_step:
                energies = balance_energies(self.layout, data, scenes, self.initial_energy)
            residuals = energies.get("residual", np.zeros(len(scenes)))
            ends = outcome.find_outcomes(data, self.accuracy, residuals)
            rest = find_rest(self, np.array([status == DONE for status, _ in ends], bool))
            peaks = outcome.build_peaks(self.layout, data, scenes, rest.drift)
        responses = []
        for number, end in enumerate(ends):
            energy = {name: float(values[number]) for name, values in energies.items()}
            response = self._build_response(number, end, peaks[number], energy)
            if rest.reasons[number]:
                response = replace(response, flags=(*response.flags, Flag("residual-drift", rest.reasons[number])))
            response = replace(response, rest_error=float(rest.error[number]))
            responses.append(replace(response, closing_to_rest=rest.max_closing[number]))
        return responses

    def _build_response(self, number: int, end: outcome.Outcome, peaks: np.void, energy: dict[str, float]) -> Response:
        """Return the response of one of the scenes."""
        scene = self.scenes[number]
        layout = self.layout
        run = self.data.run[number]
        dofs = self.data.dofs[number]
        effects = effects_of(scene)
        takes_step = self.method.takes_step
        status, advice = end
        if number in self.step_limits:
            limit = self.step_limits[number]
            advice = advice.replace("a shorter time step", f"a time step below {limit:.2g} s")
        storeys = tuple(building.storeys for building in layout.buildings)
        facts: dict[str, Any] = {
            "storeys": storeys,
            "status": status,
            "advice": advice,
            "method": self.method.name,
            "accuracy": nan if takes_step else self.accuracy,
            "time_step": self.time_step,
            "seconds": float(self.seconds[number]),
            "steps": int(run["steps"]),
            "events": int(run["events"]),
            "orders": int(run["orders"]),
            "effects": effects.kept,
            "dropped": effects.dropped,
        }
        if status not in outcome.OUTCOMES:
            nowhere = np.full_like(dofs["u0"], nan)
            final = _split_motion(nowhere, nowhere, layout.floors)
            final_turns = _split_motion(nowhere, nowhere, layout.turns)
            no_energy = dict.fromkeys(energy, nan)
            peaks = no_peaks(storeys, len(scene.links), layout.most_lines)
            return Response(peaks, **facts, energy=no_energy, final=final, final_turns=final_turns)
        peaks = peaks.copy()
        flags = list_flags(scene, peaks)
        if status == COLLAPSED:
            building, storey = outcome.find_collapse(layout, self.data.elements[number])
            time = float(run["time"])
            outcome.put_collapse(peaks, layout, building, storey, time)
            flags = (build_collapse_flag(layout.buildings[building].name, storey, time), *flags)
        if takes_step and run["trials"]:
            detail = f"{run['trials']} of {run['steps']} steps"
            flags += (Flag("halved-steps", detail, float(run["trials"] / run["steps"])),)
        final = _split_motion(dofs["u0"], dofs["w"][:, 0], layout.floors)
        final_turns = _split_motion(dofs["u0"], dofs["w"][:, 0], layout.turns)
        return Response(peaks, **facts, energy=energy, flags=flags, final=final, final_turns=final_turns)


def _split_motion(
    displacements: np.ndarray, velocities: np.ndarray, spans: Sequence[slice]
) -> tuple[tuple[np.ndarray, np.ndarray], ...]:
    """Return the displacements and velocities of some degrees of freedom of every building.

    spans : these degrees of freedom, a slice a building
    """
    return tuple((displacements[span].copy(), velocities[span].copy()) for span in spans)


def prepare_run(
    scenes: Sequence[Scene],
    accuracy: float = 1e-6,
    method: str = "taylor",
    initial: InitialState | None = None,
    bounds: Bounds | Sequence[Bounds] = (MAX_STEPS, MAX_EVENTS),
    *,
    time_step: float | None = None,
    times: np.ndarray | None = None,
    least_steps: int = 1,
) -> SceneRun:
    """Return scenes of one layout, laid out for their runs; other parameters and errors as of `solve`.

    Parameters
    ----------
    bounds : of all scenes, or of each
    times : output times at which the motion of the one scene is kept [s]
    """
    resolved_method = get_method(method)
    setting = resolved_method.check_setting(accuracy, time_step)
    for scene in scenes:
        reason = explain_refusal(resolved_method, scene)
        if reason:
            hint = "write `method: taylor`, which runs every scene"
            raise InputError(f"method {resolved_method.name} cannot run this scene: {reason}", hint)
    layout = build_layout(scenes[0])
    data = build_records(scenes, layout, accuracy, resolved_method, initial, times, bounds, least_steps)
    initial_energy = 0.0 if initial is None else _initial_energy(layout, data, scenes[0].links)
    step = setting if resolved_method.takes_step else nan
    return SceneRun(scenes, layout, data, resolved_method, accuracy, step, initial_energy)


def _initial_energy(layout: Layout, data: Data, links: Sequence[Link]) -> float:
    """Return the energy in a scene at its initial displacements and velocities [J].

    Nothing has yielded yet: storeys and links are on their first branches.
    """
    n = layout.number
    displacements = data.dofs["u0"][0]
    velocities = data.dofs["w"][0, :, 0]
    stiffness = data.elements["p"][0, :, 0]
    deformations = build_term_matrix(layout) @ displacements
    storey_forces = stiffness[:n] * deformations[:n]
    stored, _ = compute_energy_of_storeys(layout, deformations[:n], storey_forces, displacements)
    lines = layout.of_lines
    in_lines, _ = compute_energy_of_lines(layout, deformations[lines], stiffness[lines] * deformations[lines])
    in_links = sum(
        link.law.stored_energy(float(closing), float(k * closing))
        for link, closing, k in zip(links, deformations[layout.of_links], stiffness[layout.of_links], strict=True)
    )
    return 0.5 * float(data.dofs["mass"][0] @ velocities**2) + float(stored + in_lines) + in_links


def explain_refusal(method: Method, scene: Scene) -> str:
    """Return why a method cannot run a scene; "" where it can."""
    if method.remembers:
        return ""
    if any(isinstance(building.isolators, Slider) for building in scene.buildings):
        return (
            "the slider of a friction pendulum sticks, which the method does not follow "
            "(with yield_displacement, e.g. 0.01 mm, it is a spring up to that displacement)"
        )
    laws = {link.kind for link in scene.links if link.law.path_dependent}
    if effects_of(scene).yielding:
        storey_laws = [building.storey_law for building in scene.buildings]
        laws |= {law.name for law in storey_laws if law.behaviour.history_rate is not None}
    if not laws:
        return ""
    return f"the force of {' and '.join(sorted(laws))} is path-dependent, and the method keeps no history of it"


def load_kernel(name: str, kernel: Any, arguments: tuple[Any, ...]) -> None:
    """Load the kernel of a run from disk, or compile and keep it, so that this takes none of the run's time.

    Files of kernels that cannot be read are deleted.

    Parameters
    ----------
    name : one of those in `kernels`
    arguments : those of the run
    """
    if IS_INTERPRETED or is_loaded(kernel, arguments):
        return
    signature = tuple(map(numba.typeof, arguments))
    collects_garbage = gc.isenabled()
    gc.disable()  # all that the compiler makes stays; searching it for garbage takes a tenth of its time
    try:
        kernel.compile(signature)
    except Exception:  # of pickle, of LLVM, of numba: whatever damaged bytes lead to
        logging.getLogger(__name__).warning("the compiled kernels in %s are damaged: compiling %s again", FOLDER, name)
        for path in FOLDER.rglob("*.nb?"):
            path.unlink(missing_ok=True)
        kernel.compile(signature)
    finally:
        if collects_garbage:
            gc.enable()
    mark_compiled(name)


def is_loaded(kernel: Any, arguments: tuple[Any, ...]) -> bool:
    """Return whether a kernel is loaded in this process for arguments like these.

    Runs of one kernel differ only in which arguments are None; to compare all types would take a millisecond.
    """
    are_none = [argument is None for argument in arguments]
    return any([each is numba.none for each in types] == are_none for types in kernel.overloads)
