"""`solve`: one scene in, one response out, whatever the method."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from math import ceil, inf, isfinite, nan
from typing import Any

import numba
import numpy as np

from pounding_cli.errors import InputError, Problem
from pounding_cli.methods import METHODS, Method
from pounding_cli.model.effects import effects_of
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Scene
from pounding_cli.solver import outcome, records
from pounding_cli.solver.assemble import MOST_EVENTS, MOST_STEPS, Layout, layout_of, records_of, segments, term_matrix
from pounding_cli.solver.options import FOLDER
from pounding_cli.solver.records import Data
from pounding_cli.solver.response import COLLAPSED, Response, nothing

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

    Raises
    ------
    InputError : unknown method, a setting that it does not take or that is not above zero, or a scene that it does not
        run
    """
    run = prepare(scene, accuracy, method, initial, bounds, time_step=time_step)
    run.integrate()
    return run.response()


@dataclass(eq=False)
class Prepared:
    """A scene laid out for its run; `integrate`, and then `response`, once each.

    before : energy held at the start [J]
    seconds : time inside the kernel [s]
    limit : longest stable time step [s], where a method has one
    """

    scene: Scene
    layout: Layout
    data: Data
    method: Method
    accuracy: float
    time_step: float
    before: float = 0.0
    seconds: float = field(default=0.0, init=False)
    limit: float = field(default=inf, init=False)

    def integrate(self) -> None:
        """Run it, with a kernel that is compiled or loaded first if it has to be; not where the step is too long."""
        arguments: tuple[Any, ...] = (*self.data, *segments(self.scene))
        if self.method.takes_step:
            from pounding_cli.solver import fixed_step
            from pounding_cli.solver.fixed_step import march as kernel

            dt = self.scene.motion.dt
            parts = max(1, ceil(dt / self.time_step - 1e-9))  # the fewest in a sample that are not longer
            if self.method.name == "central-difference":
                self.limit = fixed_step.central_difference_limit(self.layout, self.data.elements, self.scene.links)
            if dt / parts > self.limit:
                self.data.run["status"] = records.UNSTABLE
                return
            memory, shape = self.data.elements.view(np.float64), term_matrix(self.layout)
            method = fixed_step.FIXED.index(self.method.name)
            part = "the methods of fixed time steps"
            arguments = (*self.data[:-1], *segments(self.scene), memory, shape, parts, method)
        else:
            from pounding_cli.solver.run import integrate as kernel

            part = "the solver" if self.data.room is None else "the solver for smooth laws"
        ready(part, kernel, arguments)
        begin = time.perf_counter()
        try:
            kernel(*arguments)
        except np.linalg.LinAlgError:  # Newton's method has no direction
            self.data.run["status"] = records.NO_ROOT
        self.seconds = time.perf_counter() - begin

    def response(self) -> Response:
        """What came of it."""
        layout, data, r, links = self.layout, self.data, self.data.run[0], self.scene.links
        fixed = self.method.takes_step
        with np.errstate(all="ignore"):  # a run that failed may have ended at any numbers
            energy = {} if fixed else outcome.balance(layout, data, links, self.before)
            status, advice = outcome.outcome_of(data, self.accuracy, energy.get("residual", 0.0))
        if int(r["status"]) == records.UNSTABLE:
            advice = advice.replace("a shorter time step", f"a time step below {self.limit:.2g} s")
        effects = effects_of(self.scene)
        told: dict[str, Any] = {
            "status": status, "advice": advice, "method": self.method.name,
            "accuracy": nan if fixed else self.accuracy, "time_step": self.time_step, "seconds": self.seconds,
            "steps": int(r["steps"]), "events": int(r["events"]), "orders": int(r["orders"]),
            "effects": effects.kept, "dropped": effects.dropped,
        }  # fmt: skip
        if status not in outcome.OUTCOMES:
            peaks = nothing([building.storeys for building in layout.buildings], len(links))
            final = tuple((each.drift, each.drift) for each in peaks[0])
            return Response(*peaks, **told, energy=dict.fromkeys(energy, nan), final=final)
        buildings, peaks_of_links = outcome.buildings_of(layout, data), outcome.links_of(layout, data, links)
        flags = outcome.flags_of(self.scene, buildings, peaks_of_links)
        if status == COLLAPSED:
            building, storey = outcome.collapse_of(layout, data)
            told |= {"collapse_time": float(r["time"]), "collapse_building": building, "collapse_storey": storey}
            where = f"{layout.buildings[building].name} storey {storey}"
            flags = (f"{COLLAPSED}: {where}, at {told['collapse_time']:.4g} s", *flags)
        if fixed and r["trials"]:
            cut = f"Newton found no root in {r['trials']} of {r['steps']} steps, because a contact force jumps"
            flags += (f"{cut}; these were cut in half",)
        final = tuple((data.dofs["u0"][span].copy(), data.dofs["w"][span, 0].copy()) for span in layout.floors)
        columns = outcome.columns_of(layout, data)
        return Response(buildings, peaks_of_links, **told, energy=energy, flags=flags, final=final, columns=columns)


def prepare(
    scene: Scene,
    accuracy: float = 1e-6,
    method: str = "taylor",
    initial: Start | None = None,
    bounds: tuple[int, int] = (MOST_STEPS, MOST_EVENTS),
    *,
    time_step: float | None = None,
    times: np.ndarray | None = None,
) -> Prepared:
    """A scene laid out for its run; `times` [s]: what is kept over time. Other parameters and errors as of `solve`."""
    chosen, setting = chosen_method(method, accuracy, time_step)
    if reason := refusal_of(chosen, scene):
        hint = "write `method: taylor`, which runs every scene"
        raise InputError(Problem(f"method {chosen.name} does not run this scene: {reason}", hint))
    layout = layout_of(scene)
    data = records_of(scene, layout, accuracy, chosen, initial, times, bounds)
    before = 0.0 if initial is None else _held_at_start(layout, data, scene.links)
    return Prepared(scene, layout, data, chosen, accuracy, setting if chosen.takes_step else nan, before)


def _held_at_start(layout: Layout, data: Data, links: Sequence[Link]) -> float:
    """Energy in a scene at its initial displacements and velocities [J]: it has not yielded, and lies on its first
    line."""
    n, u, stiffness = layout.number, data.dofs["u0"], data.elements["p"][:, 0]
    moved = term_matrix(layout) @ u
    stored, _ = outcome.stored_in_storeys(layout, moved[:n], stiffness[:n] * moved[:n], u)
    in_links = sum(
        link.law.stored(float(closing), float(k * closing))
        for link, closing, k in zip(links, moved[layout.of_links], stiffness[layout.of_links], strict=True)
        if link.law.can_close
    )
    return 0.5 * float(data.dofs["mass"] @ data.dofs["w"][:, 0] ** 2) + float(stored) + in_links


def method_named(name: str) -> Method:
    """The method of that name.  Raises `InputError` where there is none."""
    if name not in METHODS:
        raise InputError(Problem(f"there is no method {name}", f"write one of {', '.join(METHODS)}"))
    return METHODS[name]


def chosen_method(name: str, accuracy: float, time_step: float | None = None) -> tuple[Method, float]:
    """The method of that name and its setting, checked.

    Raises
    ------
    InputError : no such method, a setting that it does not take, or one that is not above zero
    """
    method = method_named(name)
    what, setting = method.setting, time_step if method.takes_step else accuracy
    if method.takes_step != (time_step is not None):
        wrong = f"method {name} takes {'a time step' if method.takes_step else 'an accuracy and no time step'}"
        raise InputError(Problem(wrong, f"give it e.g. `{what.key}: {what.example}` and no other setting"))
    if setting is None or not (isfinite(setting) and setting > 0):
        hint = f"write e.g. `{what.key}: {what.example}`"
        raise InputError(Problem(f"{what.title} is {setting:g}; it must be above zero", hint))
    return method, setting


def refusal_of(method: Method, scene: Scene) -> str:
    """Why a method does not run a scene; "" when it does."""
    if method.remembers:
        return ""
    laws = {link.kind for link in scene.links if link.law.remembers}
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
    mark, signature = FOLDER / f"{part}.compiled", tuple(map(numba.typeof, arguments))
    compiling = f"compiling {part}, once on this machine (half a minute)"
    if not mark.exists():
        say(compiling)
    try:
        kernel.compile(signature)
    except Exception:  # of pickle, of LLVM, of numba: whatever damaged bytes lead to
        for kept in FOLDER.rglob("*.nb?"):
            kept.unlink(missing_ok=True)
        say(compiling)
        kernel.compile(signature)
    _loaded.add(part)
    with contextlib.suppress(OSError):
        FOLDER.mkdir(parents=True, exist_ok=True)
        mark.touch()
