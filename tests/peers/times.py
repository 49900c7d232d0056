"""Times side by side on one core: the paper's pair of Fig. 6, elastic and touching, under the El Centro motion.

`python tests/peers/times.py` prints, for every solver and setting, the largest relative error of a storey's peak shear
and the least time of several runs. pound and OpenSees give peaks and link results; heyoka the states alone, and its
ground motion and contact switches are handled in Python."""

from __future__ import annotations

import os
import platform
from pathlib import Path

import heyoka_scene
import numpy as np
import opensees

from pounding_cli.model.scene import Scene
from pounding_cli.solve import solve
from pounding_cli.study import expand, load_study

STUDY = Path(__file__).parents[2] / "configs" / "fig6.yaml"


def touching() -> Scene:
    """The scene of the study's case `touching`, elastic, under its first record."""
    plan = expand(load_study(STUDY))
    row = next(r for r in plan.rows if (r.case, r.analysis, r.record) == ("touching", "elastic", "elcentro"))
    return plan.scenes[row.scene]


def shears(response) -> np.ndarray:
    """Peak storey shears [N] of all buildings."""
    return np.concatenate([b.shear for b in response.buildings])


def table(scene: Scene) -> list[tuple[str, str, float, float]]:
    """Rows of (solver, setting, error [-], seconds)."""
    expected = shears(solve(scene, 1e-14))
    rows = []
    for accuracy in (1e-6, 1e-9, 1e-12):
        runs = [solve(scene, accuracy) for _ in range(20)]
        error = np.abs(shears(runs[0]) / expected - 1).max()
        rows.append(("pound", f"accuracy {accuracy:g}", error, min(r.seconds for r in runs)))
    for tolerance in (1e-9, 0.0):
        peaks = heyoka_scene.ElasticScene(scene, tolerance).run().shear
        plain = heyoka_scene.ElasticScene(scene, tolerance, peaks=False)
        seconds = min(plain.run().seconds for _ in range(20))
        rows.append(("heyoka", f"tol {tolerance or 2.2e-16:g}", np.abs(peaks / expected - 1).max(), seconds))
    for dt in (2e-4, 1e-4, 5e-5, 2e-5, 1e-5):
        try:
            runs = [opensees.march(scene, dt) for _ in range(3)]
        except RuntimeError as failure:
            print(f"OpenSees at {dt:g} s: {failure}")
            continue
        error = np.abs(runs[0].shear / expected - 1).max()
        rows.append(("OpenSees", f"Newmark, Newton, {dt:g} s", error, min(r.seconds for r in runs)))
    return rows


if __name__ == "__main__":
    os.sched_setaffinity(0, {0})
    print("| solver | setting | error of peak storey shears | time [ms] |\n|---|---|---|---|")
    for solver, setting, error, seconds in table(touching()):
        print(f"| {solver} | {setting} | {error:.1e} | {1000 * seconds:.3g} |")
    print(f"\n{platform.processor() or platform.machine()}, Python {platform.python_version()}")
