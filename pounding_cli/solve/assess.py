"""How far a response can be trusted: its numerical error, and how much a small change of the motion moves it.

The two are different things. A tight tolerance removes the first; the second belongs to the scene, whatever the
method: a contact or a yielding storey that only just happens, or just does not, amplifies the last digit of the
record."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np

from pounding_cli.methods import METHODS
from pounding_cli.model.condense import condensed
from pounding_cli.model.scene import Scene
from pounding_cli.records.motion import Motion
from pounding_cli.solve.response import BOUNDED, DONE, MEASURED, Response
from pounding_cli.solve.run import solve
from pounding_cli.solve.tangent import FINEST_BOUNDED, HARMLESS, ILL_CONDITIONED, MOST_SENSITIVE

NUDGE = 1e-6
"""Relative change of the motion's amplitude, growing from nothing at its start to this at its end. The same factor
throughout would say little: elastic buildings in touch answer a motion twice as strong by a response twice as large,
however chaotic."""

LITTLE = 1e-2
"""The nudge of the run that tells error and sensitivity at once, over the accuracy asked: what it moves by itself is
far below that accuracy, and far above the finer run's error."""

FINEST_AT_ONCE = 1e-9
"""Accuracy asked below which one run does not tell both: the nudge would come near rounding."""

TIGHTER = 1e-3
"""Accuracy of the second run over that of the first."""

FINEST = 1e-14
"""No run is asked for more than this: doubles hold little more."""

SCATTER = (2.0, 4.0)
"""Accuracies of two more runs over that of the finer one, where rounding may decide: their only use is that they round
otherwise. Two runs of an ill-conditioned scene may agree by chance, four hardly do."""

GRAZING = 1e-10
"""What rounding may come to, over the sensitivity: a contact that grazes changes by the root of a small change, so that
what makes S x 1e-6 of 1e-6 makes S x 1e-10 of rounding, 1e-14."""

DECIDES = 1e-2
"""Part of the accuracy asked above which estimate and rounding are looked at again."""

BESIDE_FIXED_STEPS = 1e-9
"""Accuracy of the Taylor run that a fixed-step method is judged by."""


def finer(accuracy: float) -> float:
    """Accuracy of the run that one at `accuracy` is judged by [-]."""
    return max(accuracy * TIGHTER, FINEST)


@functools.lru_cache(maxsize=16)
def nudged_motion(motion: Motion, nudge: float = NUDGE) -> Motion:
    """The motion, stronger by `nudge` [-] at its end and by less before."""
    growth = 1 + nudge * np.linspace(0.0, 1.0, motion.acceleration.size)
    return Motion(motion.name, motion.dt, motion.acceleration * growth, motion.source)


def change(first: Response, second: Response) -> float:
    """Largest relative change of any storey's peak shear or drift between two responses of the same buildings [-].

    Storeys at rest in both do not count; nan when either run did not end, inf where only one collapses, or another
    storey does.
    """
    if not (first.has_result and second.has_result):
        return float("nan")
    if not _end_alike(first, second):
        return float("inf")
    pairs = zip(first.buildings, second.buildings, strict=True)
    return _largest([(x, y, x) for a, b in pairs for x, y in ((a.shear, b.shear), (a.drift, b.drift))])


def difference(first: Response, second: Response) -> float:
    """Largest relative difference of any number of two responses of the same scene [-]; nan when either run did not
    end, inf where only one collapses, or another storey does.

    Shears, drifts (and with them ductilities), accelerations, sways and rockings are relative to themselves,
    displacements to the floor's largest either way, drifts at the end to the storey's largest, and the forces,
    closings, impulses and contact times of links to the largest of their kind in the scene. Counts are left out, and
    so are energies, whose error is the ledger's residual.
    """
    if not (first.has_result and second.has_result):
        return float("nan")
    if not _end_alike(first, second):
        return float("inf")
    triples = []
    if first.collapse_storey:
        one, other = np.array([first.collapse_time]), np.array([second.collapse_time])
        triples.append((one, other, one))
    for a, b in zip(first.buildings, second.buildings, strict=True):
        reach = np.maximum(a.displacement_max, -a.displacement_min)
        ground, other = np.array([a.sway, a.rocking]), np.array([b.sway, b.rocking])
        triples += [
            (a.shear, b.shear, a.shear),
            (a.drift, b.drift, a.drift),
            (a.acceleration, b.acceleration, a.acceleration),
            (a.displacement_max, b.displacement_max, reach),
            (a.displacement_min, b.displacement_min, reach),
            (a.residual_drift, b.residual_drift, a.drift),
            (ground, other, ground),
        ]
    for name in ("peak_force", "max_closing", "impulse", "contact_time"):
        x, y = getattr(first.links, name), getattr(second.links, name)
        triples.append((x, y, np.full(x.shape, np.abs(x).max(initial=0.0))))
    for name in ("shear_below", "shear_above"):
        x, y = getattr(first.columns, name), getattr(second.columns, name)
        triples.append((x, y, x))
    return _largest(triples)


def _end_alike(first: Response, second: Response) -> bool:
    """Whether both runs came to the end of the motion, or in both the same storey collapsed."""
    return (first.collapse_building, first.collapse_storey) == (second.collapse_building, second.collapse_storey)


def _largest(triples: list[tuple[np.ndarray, np.ndarray, np.ndarray]]) -> float:
    """Largest |x - y| over the largest of |x|, |y| and |scale|, of triples of these; 0 where all three are."""
    x, y, scale = (np.concatenate(each) for each in zip(*triples, strict=True))
    size = np.maximum(np.maximum(np.abs(x), np.abs(y)), np.abs(scale))
    return float(np.max(np.abs(x - y) / np.where(size > 0, size, 1.0), initial=0.0))


Asked = tuple[Scene, dict[str, Any]]
"""A run: its scene and settings of `solve`."""


def judging(scene: Scene, method: str, accuracy: float, all_effects: bool = False) -> tuple[Asked, ...]:
    """The run by which a response by a method is judged, finer and with the motion nudged a little; of a method of
    fixed steps, or of a very fine accuracy, a finer one and another with the motion nudged besides."""
    finer_run = _finer_run(scene, method, accuracy, all_effects)
    if _at_once(method, accuracy):
        nudged, settings = _with_nudge(finer_run, LITTLE * accuracy)
        return ((nudged, settings | {"ledger": False}),)  # it is compared and left: its energies tell nobody anything
    return finer_run, _with_nudge(finer_run, NUDGE)


def judging_bounded(
    scene: Scene, method: str, accuracy: float, sensitivity: float, all_effects: bool = False
) -> tuple[Asked, ...]:
    """The run by which a response is judged whose tangent tells this sensitivity [-] and a bound above the accuracy;
    none where the sensitivity is to be measured too."""
    if not (accuracy >= FINEST_BOUNDED and sensitivity <= MOST_SENSITIVE):
        return ()
    finer_scene, settings = _finer_run(scene, method, accuracy, all_effects)
    return ((finer_scene, settings | {"ledger": False}),)


def _at_once(method: str, accuracy: float) -> bool:
    """Whether one run may tell both error and sensitivity."""
    return not METHODS[method].takes_step and accuracy >= FINEST_AT_ONCE


def _finer_run(scene: Scene, method: str, accuracy: float, all_effects: bool) -> Asked:
    fixed_steps = METHODS[method].takes_step
    settings: dict[str, Any] = {"accuracy": BESIDE_FIXED_STEPS if fixed_steps else finer(accuracy)}
    settings["method"] = "taylor" if fixed_steps else method
    if all_effects:
        settings["all_effects"] = True
    elif not fixed_steps:
        scene, _ = condensed(scene, accuracy)
    return scene, settings


def _with_nudge(asked: Asked, nudge: float) -> Asked:
    scene, settings = asked
    return dataclasses.replace(scene, motion=nudged_motion(scene.motion, min(nudge, NUDGE))), settings


def assess(
    scene: Scene,
    response: Response,
    accuracy: float,
    run: Callable[..., Response] = solve,
    all_effects: bool = False,
    judges: Sequence[Response] = (),
) -> Response:
    """The response with its estimated error [-], its sensitivity [-] and flags that say so where either is too large.

    A response that has carried its tangent tells both itself (`tangent.bounds`). Where the bound is above the accuracy,
    a finer run measures the error; where the sensitivity is above a tenth of what is flagged, a nudged run measures it.

    Of others one run tells both, at an accuracy a thousand times finer and with a motion that grows by a hundredth of
    the accuracy on its way: the difference is what the error is at most, and over the nudge what the sensitivity is at
    most. Where one is above a tenth of what would be flagged, or the accuracy is finer than 1e-9, each is told by a run
    of its own:

    error_estimate : difference against a run at an accuracy a thousand times finer; of a fixed-step method, against
        Taylor
    sensitivity : change when the motion grows by 1e-6 on its way, over 1e-6; at most about 1 for a linear scene

    A finer run replaces a response that misses the accuracy asked by its own estimate, and is then assessed by a still
    finer one, until the estimate meets the accuracy or double precision is not enough. In that case, or if rounding may
    be near the accuracy, two more runs show the scatter of the numbers.

    Foundation motions that the accuracy asked lets be held fixed are held in the finer runs too, unless the response is
    of `all_effects`: what that may cost is bounded beforehand (`model.condense`), and resolving them costs most where
    they matter least. The sway and rocking of such a base are 0, and the response says so.

    judges : the responses of the runs of `judging`, or of `judging_bounded`, where they are at hand
    """
    if not response.has_result:
        return response
    if not _at_once(response.method, accuracy):
        return _told_apart(scene, response, accuracy, run, all_effects, judges)
    if response.estimated == BOUNDED and response.error_estimate <= accuracy:
        return response
    if response.moved and response.status == DONE and accuracy >= FINEST_BOUNDED:
        known, *_ = response.moved
        asked = judging_bounded(scene, response.method, accuracy, known, all_effects)
        for finer_scene, settings in asked:
            error = difference(response, judges[0] if judges else run(finer_scene, **settings))
            if error <= accuracy and known * GRAZING <= DECIDES * accuracy:
                return dataclasses.replace(response, error_estimate=error, sensitivity=known, estimated=MEASURED)
        return _told_apart(scene, response, accuracy, run, all_effects, known=known if asked else None)
    ((nudged, settings),) = judging(scene, response.method, accuracy, all_effects)
    judge = judges[0] if judges else run(nudged, **settings)
    error, sensitivity = difference(response, judge), change(response, judge) / min(LITTLE * accuracy, NUDGE)
    if not (error <= HARMLESS * accuracy and sensitivity <= HARMLESS * ILL_CONDITIONED):
        return _told_apart(scene, response, accuracy, run, all_effects)
    return dataclasses.replace(response, error_estimate=error, sensitivity=sensitivity, estimated=MEASURED)


def _told_apart(
    scene: Scene,
    response: Response,
    accuracy: float,
    run: Callable[..., Response],
    all_effects: bool,
    judges: Sequence[Response] = (),
    known: float | None = None,
) -> Response:
    """`assess` by a finer run for the error and, unless it is `known`, a nudged one for the sensitivity."""
    fixed_steps = METHODS[response.method].takes_step
    asked = _finer_run(scene, response.method, accuracy, all_effects)
    if response.samples:
        run = partial(run, watch=True)
    wanted = [asked] if known is not None else [asked, _with_nudge(asked, NUDGE)]
    second, *nudged = judges or [run(each, **settings) for each, settings in wanted]
    scene, settings = asked[0], dict(asked[1])
    tight = settings.pop("accuracy")
    run = partial(run, **settings)
    error = difference(response, second)
    sensitivity = known if known is not None else change(second, *nudged) / NUDGE
    seconds = response.seconds
    while not fixed_steps and error > accuracy and second.has_result:
        second = dataclasses.replace(second, dropped=response.dropped)
        response = second
        seconds += second.seconds
        if tight <= FINEST:
            break
        tight = finer(tight)
        second = run(scene, accuracy=tight)
        error = difference(response, second) if second.has_result else error
    if not fixed_steps and (error > accuracy or min(error, sensitivity * GRAZING) > DECIDES * accuracy):
        others = (run(scene, accuracy=tight * times) for times in SCATTER)
        error = np.nanmax([error, *(difference(response, other) for other in others)])
    flags = response.flags
    if sensitivity > ILL_CONDITIONED:
        moved = f"changes a peak by {sensitivity * NUDGE:.1e}"
        if sensitivity == np.inf:
            moved = "decides which storey collapses, or whether one does"
        flags = (*flags, f"ill-conditioned: a motion that grows gradually by 1e-6 {moved}")
    if np.isnan(error):
        flags = (
            *flags,
            f"no error estimate: the run at {tight:.0e} for the estimate ended with: {second.status}",
        )
    if not fixed_steps and error > accuracy:
        left = "which storey collapses, or whether one does, is open"
        left = left if error == np.inf else f"an error of about {error:.1e} is left"
        flags = (*flags, f"less accurate than asked: {left}, {accuracy:.0e} was asked")
    return dataclasses.replace(
        response,
        accuracy=response.accuracy if fixed_steps else accuracy,
        seconds=seconds,
        error_estimate=float(error),
        sensitivity=sensitivity,
        estimated=MEASURED,
        flags=flags,
    )
