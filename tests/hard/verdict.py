"""What every scene owes its user: finite numbers and a closed ledger, or a named outcome with advice; and where it is
answered by proof, the answer that simulating it gives."""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from pounding_cli.errors import InputError
from pounding_cli.model.scene import Scene
from pounding_cli.solve import Response, solve
from pounding_cli.solve.groups import GroupSolver
from pounding_cli.solve.response import COLLAPSED
from pounding_cli.study import expand, load_study

BOUNDS = (2_000, 2_000)
"""Most steps and events of a fuzzed scene: it may end at a bound, but has to end."""

UNBALANCED, FAR_OFF = "energy does not close", 100.0
"""An outcome that a scene may have, but not by so many times what its accuracy allows."""

DIGITS = 1e-12
"""Part of a displacement that is rounding."""

PATIENCE = 5.0
"""Longest time for one scene within these bounds, compiling apart [s]."""

PEAKS = ("shear", "drift", "ductility", "acceleration", "displacement_max", "displacement_min", "residual_drift")
LINK_PEAKS = ("peak_force", "max_closing", "impulse", "contact_time")


@dataclass
class Tally:
    """What came of the scenes so far: outcomes by name, refusals, the worst ledger."""

    scenes: int = 0
    studies: int = 0
    refused: int = 0
    not_simulated: int = 0
    outcomes: Counter[str] = field(default_factory=Counter)
    worst_residual: float = 0.0
    over: int = 0
    slowest: float = 0.0


def closes_to(accuracy: float) -> float:
    """The energy residual a run of this accuracy may leave, relative to the input [-]."""
    return max(1e-8, accuracy)


def fault_of(response: Response) -> str:
    """What is wrong with a response, in a word or two; empty where nothing is."""
    if not response.has_result:
        return "" if response.advice else "an outcome without advice"
    if response.status == COLLAPSED and not (response.collapse_time >= 0 and response.collapse_storey >= 1):
        return "a collapse without time and place"
    for building in response.buildings:
        for name in PEAKS:
            if not np.isfinite(getattr(building, name)).all():
                return f"{name} is not finite"
    for name in LINK_PEAKS:
        if not np.isfinite(getattr(response.links, name)).all():
            return f"{name} is not finite"
    if not np.isfinite((response.columns.shear_below, response.columns.shear_above)).all():
        return "shear of struck columns is not finite"
    residual = response.energy["residual"]
    if not abs(residual) <= closes_to(response.accuracy):
        return f"energy residual {residual:.1e}"
    return ""


def _grouped(accuracy: float) -> GroupSolver:
    return GroupSolver(
        lambda scene, watch: solve(scene, accuracy, bounds=BOUNDS, watch=watch),
        lambda scene, finer: solve(scene, finer, bounds=BOUNDS),
        accuracy,
    )


def unlike_the_whole(scene: Scene, parted: Response) -> str:
    """What a row that was answered by its groups has otherwise than the row simulated whole; empty if nothing, or if
    chance decides: at a finer accuracy one of the two is no longer like itself."""
    whole = solve(scene, parted.accuracy, bounds=BOUNDS)
    if whole.status != "done":
        return ""
    if np.any((parted.links.impacts == 0) & (whole.links.impacts > 0)):
        return "a gap that closes was called open"
    found = _difference(parted, whole)
    if found:
        finer = 1e-2 * parted.accuracy
        if _difference(whole, solve(scene, finer, bounds=BOUNDS)) or _difference(parted, _grouped(finer)(scene)):
            return ""
    return found and f"groups and whole differ {found}"


def _difference(a: Response, b: Response) -> str:
    """In what two responses to a scene differ by more than their accuracy."""
    if not np.array_equal(a.links.impacts, b.links.impacts):
        return "in impacts"
    share = max(1e-6, 10 * a.accuracy)
    for mine, other in zip(a.buildings, b.buildings, strict=True):
        # a drift is a difference of displacements and has no digits below the last of theirs
        last = DIGITS * max(np.max(other.displacement_max), -np.min(other.displacement_min))
        if not (np.abs(mine.drift - other.drift) <= share * other.drift + last).all():
            return f"by {np.max(np.abs(mine.drift - other.drift)):.1e} m"
    return ""


def scenes_of(path: Path) -> Iterator[tuple[str, Scene, float]]:
    """(where it stands, scene, accuracy) of every scene of a study, each once.  Raises `InputError`."""
    plan = expand(load_study(path))
    seen = set()
    for row in plan.rows:
        for key, where in ((row.scene, row.case), *((b, f"{row.case}, alone") for b in row.baselines)):
            if key not in seen:
                seen.add(key)
                yield f"{row.point or ''}{where}, {row.analysis}", plan.scenes[key], plan.accuracy


def faults_in(path: Path, tally: Tally) -> list[str]:
    """Run a study; what is wrong with its scenes, one line each."""
    found: list[str] = []
    tally.studies += 1
    solvers: dict[float, GroupSolver] = {}
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        try:
            for where, scene, accuracy in scenes_of(path):
                tally.scenes += 1
                response = solvers.setdefault(accuracy, _grouped(accuracy))(scene)
                tally.outcomes[response.status] += 1
                tally.slowest = max(tally.slowest, response.seconds)
                if response.seconds > PATIENCE:
                    found.append(f"{where}: slow, {response.seconds:.1f} s")
                if response.has_result:
                    tally.worst_residual = max(tally.worst_residual, abs(response.energy["residual"]))
                    tally.over += abs(response.energy["residual"]) > 1e-8
                fault = fault_of(response)
                far_off = abs(response.energy["residual"]) > FAR_OFF * closes_to(accuracy)
                if response.status in ("stalled", "not finite") or (response.status == UNBALANCED and far_off):
                    fault = response.status
                if not fault and response.steps == 0 and response.status == "done":
                    tally.not_simulated += 1
                    fault = unlike_the_whole(scene, response)
                if fault:
                    found.append(f"{where}: {fault}")
        except InputError as refused:
            tally.refused += 1
            if not all(problem.message for problem in refused.problems):
                found.append("refused without a word")
        except Exception as error:  # a traceback is what is looked for
            found.append(f"{type(error).__name__}: {error}")
    return found
