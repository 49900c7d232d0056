"""Error and time of every method at every setting on given scenes: the cost of accuracy.

Errors are against Taylor with events at `REFERENCE`, which a second located method confirms; the difference of the two
is measured and kept, because no error below it means anything."""

from __future__ import annotations

import dataclasses
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pounding_cli.methods import METHODS, get_method
from pounding_cli.model.scene import Scene
from pounding_cli.numbers import count_histories
from pounding_cli.solver.response import DONE, Response
from pounding_cli.solver.solve import explain_refusal, solve

QUANTITIES = ("V", "mu", "acceleration", "force")
"""Peak storey shear, peak ductility, peak floor acceleration, peak link force."""

REFERENCE = ("taylor", 1e-12)
"""Method and setting of the reference."""

SECOND = ("dop853", 1e-11)
"""Method and setting of the run that confirms the reference."""

MAX_REPEATS = 20
"""Most repeats of a run; the least time counts."""

MAX_REPEAT_TIME = 0.1
"""Time of all repeats of a run together after which it is not repeated again [s]."""

WARM_UP = 3
"""Samples of the motion that a method sees before it is timed, so that compiling is not."""

Subject = tuple[dict[str, str], Scene]
"""A scene and its place in the study: case, analysis, record."""


@dataclass(frozen=True)
class WorkPrecision:
    """All runs on all scenes; errors by QUANTITIES are the largest over storeys, floors or links, relative [-].

    runs : a row for one method at one setting on one scene: place, method, setting, status, seconds inside the solver,
        least of the repeats [s], seconds_noise, as of `noise_of_least` [s], steps, events, `error_V`...,
        NaN when it did not end, impacts in all and those of the reference, energy_residual [-], NaN where the method
        keeps none, advice
    references : a row a scene: place, differences of the two reference methods `V`..., and of their counts of impacts
    left_out : what was not run, and why
    spent, compiling : wall time of the runs, and of compiling before them [s]
    """

    runs: list[dict[str, Any]]
    references: list[dict[str, Any]]
    left_out: list[str]
    spent: float = 0.0
    compiling: float = 0.0


def find_errors(response: Response, reference: Response) -> dict[str, float]:
    """Return the largest relative errors by QUANTITIES [-]; forces are relative to the scene's largest."""
    worst = dict.fromkeys(QUANTITIES, 0.0)
    fields = {"V": "shear", "mu": "ductility", "acceleration": "acceleration"}
    for quantity, name in fields.items():
        x = response.peaks[name]
        y = reference.peaks[name]
        moving = np.nan_to_num(y) != 0
        worst[quantity] = float(np.max(np.abs(x[moving] / y[moving] - 1), initial=0.0))
    force = reference.links.peak_force
    if force.size and force.max() > 0:
        worst["force"] = float(np.max(np.abs(response.links.peak_force - force)) / force.max())
    return worst


def resolve_methods(names: Sequence[str]) -> tuple[str, ...]:
    """Return methods by name, all of them when none is named.

    Raises
    ------
    InputError : a name is that of no method
    """
    return tuple(dict.fromkeys(get_method(name).name for name in names)) or tuple(METHODS)


def _solve_at(scene: Scene, name: str, setting: float) -> Response:
    """Return the response by a method at a value of its setting."""
    settings = {METHODS[name].setting.key: setting}
    return solve(scene, method=name, **settings)  # type: ignore[arg-type]


def measure(
    subjects: Sequence[Subject], methods: Sequence[str], budget: float, tell: Callable[[str], None] = lambda text: None
) -> WorkPrecision:
    """Run every method at every setting on as many scenes as the budget [s] allows.

    Every case and analysis gets one motion first, then the next motion; each scene gets an even share of the time left.
    Of each method the settings are tried from coarse to fine, one at least, as long as its share lasts. The budget is
    wall time, in which compiling does not count.
    """
    runs = list[dict[str, Any]]()
    references = list[dict[str, Any]]()
    left_out = list[str]()
    skipped = Counter[tuple[str, float]]()
    spent = 0.0
    compiling = 0.0
    records = list(dict.fromkeys(place["record"] for place, _ in subjects))
    order = sorted(subjects, key=lambda subject: records.index(subject[0]["record"]))
    ended = "the budget ended (--budget gives more)"
    for number, (place, scene) in enumerate(order):
        if number and spent >= budget:
            left_out.append(f"{len(order) - number} of {count_histories(len(order))}: {ended}")
            break
        tell(", ".join(place.values()))
        begin = time.perf_counter()
        runnable = [name for name in methods if not explain_refusal(METHODS[name], scene)]
        short = dataclasses.replace(scene, motion=scene.motion.cut_to(WARM_UP * scene.motion.dt))
        for name in {*runnable, REFERENCE[0], SECOND[0]}:
            _solve_at(short, name, 1e-4)
        compiled = time.perf_counter()
        reference = _solve_at(scene, *REFERENCE)
        second = _solve_at(scene, *SECOND)
        if reference.status == second.status == DONE:
            impacts = int(np.abs(reference.links.impacts - second.links.impacts).sum())
            references.append({**place, **find_errors(second, reference), "impacts": impacts})
            scenes_of_motion = sum(other["record"] == place["record"] for other, _ in order[number:])
            share = ((budget - spent) / scenes_of_motion - (time.perf_counter() - compiled)) / len(methods)
            for name in runnable:
                rows = list(_iter_runs(scene, name, reference, share))
                runs += [{**place, **row} for row in rows]
                skipped.update((name, setting) for setting in METHODS[name].setting.trial_values[len(rows) :])
        else:
            ends = f"{reference.status}, {second.status}"
            left_out.append(f"{', '.join(place.values())}: the reference did not end ({ends})")
        spent += time.perf_counter() - compiled
        compiling += compiled - begin
    for (name, setting), count in skipped.items():
        left_out.append(f"{name} at {METHODS[name].setting.text(setting)} on {count_histories(count)}: {ended}")
    return WorkPrecision(runs, references, left_out, spent, compiling)


def estimate_noise(seconds: Sequence[float]) -> float:
    """Return how well the least of some repeats can be repeated [s]; 0 of one time, which tells nothing.

    It is by how much those of every other repeat differ.
    """
    return abs(min(seconds[::2]) - min(seconds[1::2])) if len(seconds) > 1 else 0.0


def _iter_runs(scene: Scene, name: str, reference: Response, allowed: float) -> Iterator[dict[str, Any]]:
    """Yield the runs of one method from coarse to fine, one at least, as far as the time allowed [s] reaches."""
    begin = time.perf_counter()
    last_seconds = 0.0
    last_setting = 0.0
    settings = METHODS[name].setting.trial_values
    for setting in settings:
        longer = last_setting / setting if METHODS[name].takes_step else 1.0
        if last_seconds and time.perf_counter() - begin + last_seconds * longer > allowed:
            return
        response = _solve_at(scene, name, setting)
        seconds = [response.seconds]
        done = response.status == DONE
        repeat_time = min(MAX_REPEAT_TIME, allowed / len(settings))
        while done and len(seconds) < MAX_REPEATS and sum(seconds) + response.seconds < repeat_time:
            seconds.append(_solve_at(scene, name, setting).seconds)
        errors = find_errors(response, reference) if done else dict.fromkeys(QUANTITIES, np.nan)
        yield {
            "method": name, "setting": setting, "status": response.status, "seconds": min(seconds),
            "seconds_noise": estimate_noise(seconds),
            "steps": response.steps, "events": response.events, **{f"error_{q}": error for q, error in errors.items()},
            "impacts": int(response.links.impacts.sum()) if done else np.nan,
            "impacts_reference": int(reference.links.impacts.sum()),
            "energy_residual": response.energy.get("residual", np.nan), "advice": response.advice,
        }  # fmt: skip
        last_seconds = response.seconds
        last_setting = setting
