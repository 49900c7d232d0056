"""What every scene owes its user: finite numbers and a closed energy balance, or a named outcome with advice."""

from __future__ import annotations

import warnings
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

import pounding_cli as pound
from pounding_cli.model.effects import RESIDUAL_DRIFTS
from tests.adapter import FLOORS, LINKS, Run, UnstableError, scenes, solve
from tests.hard.twisted import twist_scene

BOUNDS = (2_000, 2_000)
"""Most steps and events of a fuzzed scene: it may end at a bound, but has to end."""

UNBALANCED, FAR_OFF = "energy does not close", 100.0
"""An outcome that a scene may have, but not by so many times what its accuracy allows."""

PATIENCE = 5.0
"""Longest time for one scene within these bounds, compiling apart [s]."""


@dataclass
class Tally:
    """What came of the scenes so far: outcomes by name, refusals, those with floors that twist, the worst energy
    balance."""

    scenes: int = 0
    studies: int = 0
    refused: int = 0
    twisting: int = 0
    outcomes: Counter[str] = field(default_factory=Counter)
    worst_residual: float = 0.0
    over: int = 0
    slowest: float = 0.0


OF_LINES = "line_shear", "line_drift", "line_ductility", "line_residual_drift"
EDGES = "twist", "edge_drift_low", "edge_drift_high"

TWIST = "# twist: "
"""First line of a study whose scenes get plans and places of links by the seed behind it (`twisted.twist_scene`)."""


def closes_to(accuracy: float) -> float:
    """The energy residual a run of this accuracy may leave, relative to the input [-]."""
    return max(1e-8, accuracy)


def has_result(run: Run) -> bool:
    return run.status in ("done", "collapsed")


def fault_of(run: Run, accuracy: float) -> str:
    """What is wrong with a run, in a word or two; empty where nothing is."""
    residual = run.energy["residual"]
    if not has_result(run):
        far_off = run.status == UNBALANCED and abs(residual) > FAR_OFF * closes_to(accuracy)
        named = run.status if run.status in ("stalled", "not finite") or far_off else ""
        return named or ("" if run.advice else "an outcome without advice")
    if run.status == "collapsed" and not (run.time >= 0 and run.place[1] >= 1):
        return "a collapse without time and place"
    of_lines = [name for name in (*OF_LINES, *EDGES) if name in run.numbers]
    for name in (*FLOORS, *LINKS, *of_lines, "shear_below", "shear_above", "end"):
        values = getattr(run, name)
        if name in EDGES:
            values = values[~np.isnan(getattr(run, EDGES[0]))]  # floors that do not twist have none
        if not np.isfinite(values).all() and not ("residual_drift" in name and may_lack_rest(run)):
            return f"{name} is not finite"
    return "" if abs(residual) <= closes_to(accuracy) else f"energy residual {residual:.1e}"


def may_lack_rest(run: Run) -> bool:
    """Return whether a run may lack residual drifts: they are not asked for, or a flag says why there are none."""
    is_asked = RESIDUAL_DRIFTS in run.effects
    return not is_asked or any(flag.startswith("no residual drift") for flag in run.flags)


def faults_in(path: Path, tally: Tally) -> list[str]:
    """Run a study; what is wrong with its scenes, one line each."""
    found: list[str] = []
    tally.studies += 1
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        try:
            first_line = path.read_text(encoding="utf-8").partition("\n")[0]
            for number, (where, scene, accuracy) in enumerate(scenes(path)):
                tally.scenes += 1
                if first_line.startswith(TWIST):
                    try:
                        scene = twist_scene(scene, int(first_line.removeprefix(TWIST)) + number)
                    except UnstableError:
                        tally.refused += 1
                        continue
                    tally.twisting += 1
                run = solve(scene, accuracy, bounds=BOUNDS)
                tally.outcomes[run.status] += 1
                tally.slowest = max(tally.slowest, run.seconds)
                if run.seconds > PATIENCE:
                    found.append(f"{where}: slow, {run.seconds:.1f} s")
                if has_result(run):
                    tally.worst_residual = max(tally.worst_residual, abs(run.energy["residual"]))
                    tally.over += abs(run.energy["residual"]) > 1e-8
                if fault := fault_of(run, accuracy):
                    found.append(f"{where}: {fault}")
        except pound.InputError as refused:
            tally.refused += 1
            if not all(problem.message for problem in refused.issues):
                found.append("refused without a word")
        except Exception as error:  # a traceback is what is looked for
            found.append(f"{type(error).__name__}: {error}")
    return found
