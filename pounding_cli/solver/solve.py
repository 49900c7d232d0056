"""`solve`: one scene in, one response out, whatever the method; `solve_all`: many scenes at once."""

from __future__ import annotations

import gc
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from math import ceil, nan
from typing import Any

import numba
import numpy as np

from pounding_cli.errors import InputError, Problem
from pounding_cli.laws.slider import Slider
from pounding_cli.methods import Method, get_method
from pounding_cli.model.effects import effects_of
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Scene
from pounding_cli.solver import assemble, outcome, records
from pounding_cli.solver.assemble import MOST_EVENTS, MOST_STEPS, Layout, layout_of, records_of, segments, term_matrix
from pounding_cli.solver.kernels import FIXED_STEP_KERNEL, FOLDER, is_compiled, kernel_for, mark_compiled
from pounding_cli.solver.records import Data, Room
from pounding_cli.solver.response import COLLAPSED, DONE, Flag, Response, no_peaks
from pounding_cli.solver.rest import NO_RESIDUAL_DRIFT, find_rest

say: Callable[[str], None] = lambda text: None  # noqa: E731 (replaced by whoever shows progress)
"""Told when something is about to be compiled, which takes its time."""

_loaded: set[str] = set()

Start = tuple[Sequence[np.ndarray], Sequence[np.ndarray]]


def solve(
    scene: Scene,
    accuracy: float = 1e-6,
    method: str = "taylor",
    initial: Start | None = None,
    bounds: tuple[int, int] = (MOST_STEPS, MOST_EVENTS),
    *,
    time_step: float | None = None,
    least_steps: int = 1,
) -> Response:
    """The response of a scene.

    Parameters
    ----------
    scene : in SI units
    accuracy : wanted relative error of the peaks [-]; a method that takes a time step has no use for it
    method : a key of METHODS
    initial : floor displacements [m] and velocities [m/s] relative to the ground, one array (n,) a building; None is
        rest
    bounds : most steps, most events
    time_step : of a method that takes one (`methods.METHODS`) [s]
    least_steps : in a time step of the motion, of a method that chooses its steps: runs of one accuracy that have other
        steps round otherwise

    Raises
    ------
    InputError : unknown method, a setting that it does not take or that is not above zero, or a scene that it does not
        run
    """
    run = prepare([scene], accuracy, method, initial, bounds, time_step=time_step, least_steps=least_steps)
    run.integrate()
    return run.responses()[0]


def solve_all(
    scenes: Sequence[Scene], accuracy: float = 1e-6, method: str = "taylor", *, time_step: float | None = None
) -> list[Response]:
    """The responses of scenes in their order, each as by `solve`; those of one layout are run by one call that lets
    other threads go on, and share its time by their steps.  Raises InputError as `solve`."""
    alike, found = dict[Layout, list[int]](), dict[int, Response]()
    for number, scene in enumerate(scenes):
        alike.setdefault(layout_of(scene), []).append(number)
    for numbers in alike.values():
        run = prepare([scenes[number] for number in numbers], accuracy, method, time_step=time_step)
        run.integrate()
        found |= zip(numbers, run.responses(), strict=True)
    return [found[number] for number in range(len(scenes))]


@dataclass(eq=False)
class Prepared:
    """Scenes of one layout, laid out for their runs; `integrate`, and then `responses`, once each.

    before : energy held at the start [J]
    seconds : time inside the kernel [s], shape (scenes,)
    limit : longest stable time step [s], where a method has one, of a scene that it kept from running
    """

    scenes: Sequence[Scene]
    layout: Layout
    data: Data
    method: Method
    accuracy: float
    time_step: float
    before: float
    seconds: np.ndarray = field(init=False)
    limit: dict[int, float] = field(default_factory=dict, init=False)

    def integrate(self) -> None:
        """Run them, with a kernel that is compiled or loaded first if it has to be."""
        self.seconds = np.zeros(len(self.scenes))
        self.integrate_records(self.data, np.arange(len(self.scenes)), [segments(scene) for scene in self.scenes])

    def integrate_records(self, data: Data, places: np.ndarray, grounds: Sequence[assemble.Segments]) -> None:
        """Run the records of the scenes at `places` through their `grounds`, one a scene."""
        if self.method.takes_step:
            for row, place in enumerate(places.tolist()):
                self._march(data, row, place, grounds[row])
            return
        from pounding_cli.solver.run import integrate as kernel

        arguments = (*data, *assemble.join_segments(grounds))
        ready(kernel_for(False, data.room is not None), kernel, arguments)
        begin = time.perf_counter()
        kernel(*arguments)
        steps = data.run["steps"]
        self.seconds[places] += (time.perf_counter() - begin) * steps / max(steps.sum(), 1)

    def _march(self, data: Data, row: int, number: int, ground: assemble.Segments) -> None:
        """Run one of the scenes by a method of fixed time steps; not where the step is too long."""
        from pounding_cli.solver import fixed_step

        scene, elements, room = self.scenes[number], data.elements[row], data.room
        dt = scene.motion.dt
        parts = max(1, ceil(dt / self.time_step - 1e-9))  # the fewest in a sample that are not longer
        if self.method.name == "central-difference":
            limit = fixed_step.central_difference_limit(self.layout, elements, scene.links)
            if dt / parts > limit:
                data.run["status"][row], self.limit[number] = records.UNSTABLE, limit
                return
        assert room is not None  # of every method of fixed time steps
        arguments = (
            data.dofs[row], elements, data.terms, data.run[row : row + 1],
            data.series[row], data.columns[row], Room(room.states[row], room.formulas[row]),
            *ground, elements.view(np.float64), term_matrix(self.layout), parts,
            fixed_step.FIXED.index(self.method.name),
        )  # fmt: skip
        ready(FIXED_STEP_KERNEL, fixed_step.march, arguments)
        begin = time.perf_counter()
        try:
            fixed_step.march(*arguments)
        except np.linalg.LinAlgError:  # Newton's method has no direction
            data.run["status"][row] = records.NO_ROOT
        self.seconds[number] += time.perf_counter() - begin

    def responses(self) -> list[Response]:
        """What came of them."""
        layout, data, scenes = self.layout, self.data, self.scenes
        with np.errstate(all="ignore"):  # a run that failed may have ended at any numbers
            energies = {} if self.method.takes_step else outcome.balance(layout, data, scenes, self.before)
            residuals = energies.get("residual", np.zeros(len(scenes)))
            ends = outcome.ends_of(data, self.accuracy, residuals)
            rest = find_rest(self, np.array([status == DONE for status, _ in ends], bool))
            peaks = outcome.peaks_of(layout, data, scenes, rest.drift)
        responses = []
        for number, end in enumerate(ends):
            energy = {name: float(each[number]) for name, each in energies.items()}
            response = self._response(number, end, peaks[number], energy)
            if rest.reasons[number]:
                response = replace(response, flags=(*response.flags, Flag(NO_RESIDUAL_DRIFT, rest.reasons[number])))
            responses.append(replace(response, closing_to_rest=rest.max_closing[number]))
        return responses

    def _response(self, number: int, end: outcome.Outcome, peaks: np.void, energy: dict[str, float]) -> Response:
        """What came of one of them."""
        scene, layout, r, (status, advice) = self.scenes[number], self.layout, self.data.run[number], end
        dofs, effects, fixed = self.data.dofs[number], effects_of(scene), self.method.takes_step
        if number in self.limit:
            advice = advice.replace("a shorter time step", f"a time step below {self.limit[number]:.2g} s")
        storeys = tuple(building.storeys for building in layout.buildings)
        told: dict[str, Any] = {
            "storeys": storeys, "status": status, "advice": advice, "method": self.method.name,
            "accuracy": nan if fixed else self.accuracy, "time_step": self.time_step,
            "seconds": float(self.seconds[number]), "steps": int(r["steps"]), "events": int(r["events"]),
            "orders": int(r["orders"]), "effects": effects.kept, "dropped": effects.dropped,
        }  # fmt: skip
        if status not in outcome.OUTCOMES:
            final = tuple((np.full(each, nan), np.full(each, nan)) for each in storeys)
            return Response(no_peaks(storeys, len(scene.links)), **told, energy=dict.fromkeys(energy, nan), final=final)
        flags = outcome.flags_of(scene, peaks)
        if status == COLLAPSED:
            building, storey = outcome.collapse_of(layout, self.data.elements[number, : layout.number])
            told |= {"collapse_time": float(r["time"]), "collapse_building": building, "collapse_storey": storey}
            time = told["collapse_time"]
            detail = f"{layout.buildings[building].name} storey {storey}, at {time:.4g} s"
            flags = (Flag(COLLAPSED, detail, severity=-time), *flags)  # the earlier, the worse
        if fixed and r["trials"]:
            kind = "time steps cut in half, because Newton found no root where a contact force jumps"
            flags += (Flag(kind, f"{r['trials']} of {r['steps']} steps", float(r["trials"] / r["steps"])),)
        final = tuple((dofs["u0"][span].copy(), dofs["w"][span, 0].copy()) for span in layout.floors)
        return Response(peaks.copy(), **told, energy=energy, flags=flags, final=final)


def prepare(
    scenes: Sequence[Scene],
    accuracy: float = 1e-6,
    method: str = "taylor",
    initial: Start | None = None,
    bounds: tuple[int, int] = (MOST_STEPS, MOST_EVENTS),
    *,
    time_step: float | None = None,
    times: np.ndarray | None = None,
    least_steps: int = 1,
) -> Prepared:
    """Scenes of one layout, laid out for their runs; `times` [s]: what is kept of one scene over time. Other parameters
    and errors as of `solve`."""
    chosen = get_method(method)
    setting = chosen.check_setting(accuracy, time_step)
    for scene in scenes:
        if reason := refusal_of(chosen, scene):
            hint = "write `method: taylor`, which runs every scene"
            raise InputError(Problem(f"method {chosen.name} does not run this scene: {reason}", hint))
    layout = layout_of(scenes[0])
    data = records_of(scenes, layout, accuracy, chosen, initial, times, bounds, least_steps)
    before = 0.0 if initial is None else _held_at_start(layout, data, scenes[0].links)
    return Prepared(scenes, layout, data, chosen, accuracy, setting if chosen.takes_step else nan, before)


def _held_at_start(layout: Layout, data: Data, links: Sequence[Link]) -> float:
    """Energy in a scene at its initial displacements and velocities [J]: it has not yielded, and lies on its first
    line."""
    n, u, stiffness = layout.number, data.dofs["u0"][0], data.elements["p"][0, :, 0]
    moved = term_matrix(layout) @ u
    stored, _ = outcome.stored_in_storeys(layout, moved[:n], stiffness[:n] * moved[:n], u)
    in_links = sum(
        link.law.stored_energy(float(closing), float(k * closing))
        for link, closing, k in zip(links, moved[layout.of_links], stiffness[layout.of_links], strict=True)
    )
    return 0.5 * float(data.dofs["mass"][0] @ data.dofs["w"][0, :, 0] ** 2) + float(stored) + in_links


def refusal_of(method: Method, scene: Scene) -> str:
    """Why a method does not run a scene; "" when it does."""
    if method.remembers:
        return ""
    if any(isinstance(building.isolators, Slider) for building in scene.buildings):
        return (
            "the slider of a friction pendulum sticks, which it does not follow "
            "(with yield_displacement, e.g. 0.01 mm, it is a spring up to there)"
        )
    laws = {link.kind for link in scene.links if link.law.path_dependent}
    if effects_of(scene).yielding:
        laws |= {b.storey_law.name for b in scene.buildings if b.storey_law.behaviour.history_rate is not None}
    if not laws:
        return ""
    return f"the force of {' and '.join(sorted(laws))} depends on what happened before, which it does not keep"


def ready(part: str, kernel: Any, arguments: tuple[Any, ...]) -> None:
    """Load the kernel of a run, or compile it where it is not kept on disk, and say so: its time is not the scene's.
    What is kept and cannot be read is deleted."""
    if part in _loaded:
        return
    signature = tuple(map(numba.typeof, arguments))
    compiling = f"compiling {part}, once on this machine (half a minute)"
    if not is_compiled(part):
        say(compiling)
    collects = gc.isenabled()
    gc.disable()  # what the compiler makes stays: to look through it again and again takes a tenth of its time
    try:
        kernel.compile(signature)
    except Exception:  # of pickle, of LLVM, of numba: whatever damaged bytes lead to
        for kept in FOLDER.rglob("*.nb?"):
            kept.unlink(missing_ok=True)
        say(compiling)
        kernel.compile(signature)
    finally:
        if collects:
            gc.enable()
    _loaded.add(part)
    mark_compiled(part)
