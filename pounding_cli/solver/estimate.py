"""The numerical error of a response, and its sensitivity: how much a small change of the motion moves it.

The two are different things. A tight tolerance removes the first; the second belongs to the scene, whatever the
method: a contact or a yielding storey that only just happens, or just does not, amplifies the last digit of the
record."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Iterable, Sequence

import numpy as np

from pounding_cli.methods import METHODS
from pounding_cli.model.scene import Scene
from pounding_cli.records.motion import Motion
from pounding_cli.solver import solve as solver
from pounding_cli.solver.response import TURNS, Flag, Response, count_lines

NUDGE = 1e-6
"""Relative change of the motion's amplitude, growing from nothing at its start to this at its end. The same factor
throughout would say little: elastic buildings in touch answer a motion twice as strong by a response twice as large,
however chaotic."""

LITTLE = 1e-2
"""The nudge of the run that tells error and sensitivity at once, over the accuracy asked: what it moves by itself is
far below that accuracy, and far above the finer run's error."""

FINEST_AT_ONCE = 1e-9
"""Accuracy asked below which one run does not tell both: the nudge would come near rounding."""

HARMLESS = 0.1
"""Error and sensitivity that one run tells are looked at again where they are above this part of what is flagged."""

ILL_CONDITIONED = 100.0
"""Sensitivity above which a scene is flagged: six digits of the record then give four of the response."""

TIGHTER = 1e-3
"""Accuracy of the second run over that of the first."""

FINEST = 1e-12
"""No run judges another at a finer accuracy: below it rounding makes finer runs worse."""

PRICE = 100
"""Most steps, and most events, of all runs together that assess a response, over those of its own run [-]. Twenty are
usual where accuracies are fine and a force is smooth."""

LEAST_PRICE = 10_000
"""Steps, and events, that they may take in any case."""

SCATTER = ((2.0, 2), (4.0, 3))
"""Of two more runs, where rounding may decide: accuracy over that of the finer one, and steps in a time step of the
motion at least. Their only use is that they round otherwise. Two runs of an ill-conditioned scene may agree by chance,
four hardly do."""

OTHER_STEPS = 2
"""Steps in a time step of the motion, at least, of a run that would else be the one it judges, to the last digit."""

NOTHING = 1e-8
"""Part of the scene's size below which a number counts as zero [-]."""

ROUNDING = 1e-10
"""Part of the largest force below which a link that presses does so by rounding, a thousand times stiffer than the
storeys [-]."""

GRAZING = 1e-10
"""What rounding may come to, over the sensitivity: a contact that grazes changes by the root of a small change, so that
what makes S x 1e-6 of 1e-6 makes S x 1e-10 of rounding, 1e-14."""

DECIDES = 1e-2
"""Part of the accuracy asked above which estimate and rounding are looked at again."""

BESIDE_FIXED_STEPS = 1e-9
"""Accuracy of the Taylor run that a fixed-step method is judged by."""


ARM = 1.0
"""Distance from the centres of mass at which a twist is told from nothing by what it moves [m]."""

LENGTHS = ("drift", "displacement_max", "displacement_min", "residual_drift", "sway", "max_closing")
"""Numbers of a response in m."""

LENGTHS_OF_LINES = ("line_drift", "line_residual_drift", "edge_drift_low", "edge_drift_high")
"""Those where floors twist."""

FORCES = ("shear", "shear_below", "shear_above", "peak_force")
"""Numbers of a response in N."""

Triple = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Values of two responses, and what their difference is relative to."""


def refine_accuracy(accuracy: float) -> float:
    """Return the accuracy of the run by which one at `accuracy` is judged [-]."""
    return min(accuracy, max(accuracy * TIGHTER, FINEST))


@functools.lru_cache(maxsize=16)
def nudge_motion(motion: Motion, nudge: float = NUDGE) -> Motion:
    """Return the motion, stronger by `nudge` [-] at its end and by less before."""
    growth = 1 + nudge * np.linspace(0.0, 1.0, motion.acceleration.size)
    return Motion(motion.name, motion.dt, motion.acceleration * growth, motion.source)


def find_change(first: Response, second: Response) -> float:
    """Return the largest relative change of the peak shear or drift of any storey or frame line [-].

    It is between two responses of the same buildings, and as of `find_difference`.
    """
    peaks = first.peaks
    other_peaks = second.peaks
    sizes = find_scene_sizes(first, second)
    names = ("shear", "drift", "line_shear", "line_drift") if count_lines(peaks) else ("shear", "drift")
    triples = [_build_triple(peaks[name], other_peaks[name], peaks[name], sizes[name]) for name in names]
    return _find_largest_difference(first, second, triples)


def find_difference(first: Response, second: Response) -> float:
    """Return the largest relative difference of any number of two responses of the same scene [-].

    It is nan when either run did not end, and inf where only one collapses, or another storey does.

    Shears and drifts of storeys, lines and edges (and with them ductilities), accelerations, sways, rockings and twists
    are relative to themselves, displacements to the floor's largest either way, drifts at the end to the storey's
    largest, and the forces, closings, impulses and contact times of links to the largest of their kind in the scene. A
    number below 1e-8 of the scene's size, `find_scene_sizes`, counts as zero, and a link that presses by rounding as
    one that does not. Counts are left out, and so are energies, whose error is the ledger's residual.
    """
    peaks = first.peaks
    other_peaks = second.peaks
    sizes = find_scene_sizes(first, second)
    reach = np.maximum(peaks["displacement_max"], -peaks["displacement_min"])
    scales = {"displacement_max": reach, "displacement_min": reach, "residual_drift": peaks["drift"]}
    for name in ("peak_force", "max_closing", "impulse"):
        scales[name] = np.full_like(peaks[name], np.abs(peaks[name]).max(initial=0.0))
    for name in ("shear", "drift", "acceleration", "sway", "rocking", "shear_below", "shear_above"):
        scales[name] = peaks[name]
    if count_lines(peaks):
        scales |= {name: peaks[name] for name in ("line_shear", "line_drift", *TURNS)}
        scales["line_residual_drift"] = peaks["line_drift"]
    triples = [_build_triple(peaks[name], other_peaks[name], scale, sizes[name]) for name, scale in scales.items()]
    presses = np.maximum(peaks["peak_force"], other_peaks["peak_force"]) > ROUNDING * sizes["peak_force"]
    time, other_time = (np.where(presses, each["contact_time"], 0.0) for each in (peaks, other_peaks))
    triples.append((time, other_time, np.full_like(time, time.max(initial=0.0))))
    triples.append((peaks["collapse_time"], other_peaks["collapse_time"], peaks["collapse_time"]))
    return _find_largest_difference(first, second, triples)


def find_scene_sizes(first: Response, second: Response) -> dict[str, float]:
    """Return the size of the scene of two responses for each of its numbers, in the number's unit.

    It is the largest length, force, acceleration and rotation in either, and the impulse of the largest force over the
    longest contact.
    """
    both = first.peaks, second.peaks
    has_lines = count_lines(first.peaks) > 0
    lengths = (*LENGTHS, *LENGTHS_OF_LINES) if has_lines else LENGTHS
    forces = (*FORCES, "line_shear") if has_lines else FORCES
    largest = {
        name: _find_largest(both, name) for name in (*lengths, *forces, "acceleration", "rocking", "contact_time")
    }
    length = max(largest[name] for name in lengths)
    force = max(largest[name] for name in forces)
    sizes = dict.fromkeys(lengths, length) | dict.fromkeys(forces, force)
    sizes["twist"] = length / ARM
    sizes["acceleration"] = largest["acceleration"]
    sizes["rocking"] = largest["rocking"]
    sizes["impulse"] = force * largest["contact_time"]
    return sizes


def _find_largest(both: Iterable[np.void], name: str) -> float:
    """Return the largest absolute value of a number in two responses; walls that move as the ground does have none."""
    return max(float(np.fmax.reduce(np.abs(peaks[name]).ravel(), initial=0.0)) for peaks in both)


def _build_triple(first: np.ndarray, second: np.ndarray, scale: np.ndarray, size: float) -> Triple:
    """Return values of two responses with their scale, zero where all three are below 1e-8 of the scene's size."""
    largest = np.maximum(np.maximum(np.abs(first), np.abs(second)), np.abs(scale))
    is_nothing = largest < NOTHING * size
    one, other, relative_to = (np.where(is_nothing, 0.0, each) for each in (first, second, scale))
    return one, other, relative_to


def _find_largest_difference(first: Response, second: Response, triples: Iterable[Triple]) -> float:
    """Return the largest |x - y| over the largest of |x|, |y| and |scale|, of triples of these; 0 where all are [-].

    Walls that move as the ground does have no numbers.
    """
    if not (first.has_result and second.has_result):
        return float("nan")
    fallen, other_fallen = (np.nan_to_num(each.peaks["collapse_storey"]) for each in (first, second))
    if not np.array_equal(fallen, other_fallen):
        return float("inf")
    x, y, scale = (np.concatenate([part.ravel() for part in each]) for each in zip(*triples, strict=True))
    size = np.maximum(np.maximum(np.abs(x), np.abs(y)), np.abs(scale))
    return float(np.fmax.reduce(np.abs(x - y) / np.where(size > 0, size, 1.0), initial=0.0))


def assess(scenes: Sequence[Scene], responses: Sequence[Response], accuracy: float) -> list[Response]:
    """Return responses with their estimated errors and sensitivities, and flags where either is too large.

    All are of one method.

    One run tells both, at an accuracy a thousand times finer and with a motion that grows by a hundredth of the
    accuracy on its way: the difference is what the error is at most, and over the nudge what the sensitivity is at
    most. Where one is above a tenth of what would be flagged, the accuracy is finer than 1e-9, or the method takes
    fixed steps, each is told by a run of its own:

    error_estimate : difference against a run at an accuracy a thousand times finer; of a fixed-step method, against
        Taylor [-]
    sensitivity : change when the motion grows by 1e-6 on its way, over 1e-6; at most about 1 for a linear scene [-]

    A response that misses the accuracy asked by its own estimate is judged by still finer runs, until one meets the
    accuracy or double precision is not enough. In that case, or if rounding may be near the accuracy, two more runs
    show the scatter of the numbers. The answer is the first run that meets the accuracy, or else the best of them.

    All these runs together take at most `PRICE` times the steps of the response, or `LEAST_PRICE`. A flag says where
    they were stopped, and the error may be larger than the estimate.
    """
    assessed = list(responses)
    unsettled = [number for number, response in enumerate(responses) if response.has_result]
    method = responses[0].method if responses else "taylor"
    prices = [find_price(response) for response in responses]
    if accuracy >= FINEST_AT_ONCE and not METHODS[method].takes_step:
        nudge = min(LITTLE * accuracy, NUDGE)
        nudged = [_nudge_scene(scenes[number], nudge) for number in unsettled]
        bounds = [(prices[number], prices[number]) for number in unsettled]
        judges = solver.solve_all(nudged, refine_accuracy(accuracy), method, bounds=bounds)
        for number, judge in zip(tuple(unsettled), judges, strict=True):
            response = responses[number]
            error = find_difference(response, judge)
            sensitivity = find_change(response, judge) / nudge
            if error <= HARMLESS * accuracy and sensitivity <= HARMLESS * ILL_CONDITIONED:
                assessed[number] = _put_doubts(response, accuracy, error, sensitivity)
                unsettled.remove(number)
            else:
                prices[number] -= _count_effort(judge)
    for number in unsettled:
        assessed[number] = _assess_closely(scenes[number], responses[number], accuracy, prices[number])
    return assessed


def _nudge_scene(scene: Scene, nudge: float) -> Scene:
    """Return the scene with its motion nudged."""
    return dataclasses.replace(scene, motion=nudge_motion(scene.motion, nudge))


def find_price(response: Response) -> int:
    """Return how many steps, and how many events, all runs together may take that assess a response."""
    return max(PRICE * _count_effort(response), LEAST_PRICE)


def _count_effort(response: Response) -> int:
    """Return the steps of a run, or its events where they are more."""
    return max(response.steps, response.events)


class _Judges:
    """The runs that judge a response, within its price.

    left : steps, and events, that they may still take; below zero where the last run was stopped for them
    """

    def __init__(self, method: str, left: int) -> None:
        self.method = method
        self.left = left

    def solve(self, scene: Scene, accuracy: float, least_steps: int = 1) -> Response:
        """Return the response of a scene; without numbers where it would take more than is left."""
        bounds = (max(self.left, 0), max(self.left, 0))
        response = solver.solve(scene, accuracy, self.method, bounds=bounds, least_steps=least_steps)
        self.left -= _count_effort(response)
        return response


def _assess_closely(scene: Scene, response: Response, accuracy: float, left: int) -> Response:
    """Return a response that is assessed by runs of its own, or the best of these where it misses the accuracy.

    left : steps, and events, that these runs may take
    """
    takes_step = METHODS[response.method].takes_step
    judges = _Judges("taylor" if takes_step else response.method, left)
    fine = BESIDE_FIXED_STEPS if takes_step else refine_accuracy(accuracy)
    judge = judges.solve(scene, fine)
    sensitivity = find_change(judge, judges.solve(_nudge_scene(scene, NUDGE), fine)) / NUDGE
    error = find_difference(response, judge)
    seconds = response.seconds
    if not takes_step:
        runs = [response, judge]
        while error > accuracy and judge.has_result and fine > FINEST:
            fine = refine_accuracy(fine)
            judge = judges.solve(scene, fine)
            error = find_difference(runs[-1], judge)
            runs.append(judge)
        others = [judges.solve(scene, fine, OTHER_STEPS)] if error == 0.0 else []
        if others:
            error = find_difference(response, others[0])
        if error > accuracy or min(error, sensitivity * GRAZING) > DECIDES * accuracy:
            others += [judges.solve(scene, fine * times, steps) for times, steps in SCATTER]
        place, error = _find_best(runs, others, accuracy)
        response = runs[place]
        seconds = sum(run.seconds for run in runs[: place + 1])
    response = dataclasses.replace(response, accuracy=response.accuracy if takes_step else accuracy, seconds=seconds)
    limit = ""
    if judges.left < 0:
        limit = f"its runs may take {PRICE} times the steps of the run itself, or {LEAST_PRICE:,}"
    end = limit or f"the run at {fine:.0e} for the estimate ended with: {judge.status}"
    return _put_doubts(response, accuracy, error, sensitivity, end, limit)


def _find_best(runs: Sequence[Response], others: Sequence[Response], accuracy: float) -> tuple[int, float]:
    """Return the place of the first run that meets the accuracy, or of the best, and its error [-]; nan if not known.

    The error of a run is its largest difference from all finer ones, and from the others. Where rounding makes finer
    runs worse, that is least for a coarse one.

    Parameters
    ----------
    runs : each finer than the one before
    others : as fine as the last of them
    """
    errors = []
    for place, run in enumerate(runs):
        differences = [find_difference(run, judge) for judge in (*runs[place + 1 :], *others)]
        errors.append(float(np.fmax.reduce(differences, initial=-np.inf)))
    known = [(error, place) for place, error in enumerate(errors) if error >= 0.0]
    if not known:
        return 0, float("nan")
    error, place = next((each for each in known if each[0] <= accuracy), min(known))
    return place, error


def _put_doubts(
    response: Response, accuracy: float, error: float, sensitivity: float, end: str = "", limit: str = ""
) -> Response:
    """Return a response with its error and sensitivity [-], and a flag for each that is too large or not known.

    error : by other runs; that of the drifts at rest, which all runs share, comes beside it
    end : why there is no error
    limit : what stopped the runs for the estimate, "" where nothing did
    """
    error = max(error, response.rest_error)
    flags = list(response.flags)
    if sensitivity > ILL_CONDITIONED:
        flags.append(_flag_sensitivity(sensitivity))
    if np.isnan(error):
        flags.append(Flag("no-error", end))
    elif limit:
        flags.append(Flag("cut-short", f"{limit}; the error, about {error:.1e}, may be larger", error))
    if not METHODS[response.method].takes_step and error > accuracy:
        flags.append(_flag_error(error, accuracy))
    return dataclasses.replace(response, error_estimate=error, sensitivity=sensitivity, flags=tuple(flags))


def _flag_sensitivity(sensitivity: float) -> Flag:
    """Return the flag of an ill-conditioned scene; its sensitivity [-] is inf where the nudge decides a collapse."""
    effect = f"changes a peak by {sensitivity * NUDGE:.1e}" if sensitivity < np.inf else "decides what collapses"
    return Flag("sensitive", f"a motion that grows gradually by 1e-6 {effect}", sensitivity)


def _flag_error(error: float, accuracy: float) -> Flag:
    """Return the flag of a response whose error [-] exceeds the accuracy asked [-]; inf where a collapse is open."""
    rest = f"an error of about {error:.1e} is left" if error < np.inf else "what collapses is open"
    return Flag("error", f"{rest}, {accuracy:.0e} was asked", error)
