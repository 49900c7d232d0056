"""What floors that twist cost: a pair of five storeys in touch, with and without plans."""

from __future__ import annotations

import time

from pounding_cli import load_study
from pounding_cli.model.scene import Scene
from pounding_cli.solver.solve import solve
from pounding_cli.study import make_plan

PLAN = {
    "width": "20 m",
    "depth": "14 m",
    "lines": [{"y": "-8 m", "stiffness": "60 %"}, {"y": "8 m", "stiffness": "40 %"}],
    "torsional_stiffness": "3e9 N m",
}
ROUNDS = 12
"""Runs of each scene in turns, of which the shortest counts."""


def measure_twist() -> str:
    """Return processor times, steps and events of the pair without and with two lines a building, in lines of text."""
    scenes = {"plain": _build_scenes(None), "two lines each": _build_scenes(PLAN)}
    shortest: dict[tuple[str, str], float] = {}
    for _ in range(ROUNDS + 1):  # the first compiles
        for name, of_name in scenes.items():
            for scene in of_name:
                begin = time.process_time()
                solve(scene)
                key = (name, str(scene.analysis))
                shortest[key] = min(shortest.get(key, float("inf")), time.process_time() - begin)
    lines = []
    for name, of_name in scenes.items():
        for scene in of_name:
            run = solve(scene)
            seconds = shortest[name, str(scene.analysis)]
            ratio = seconds / shortest["plain", str(scene.analysis)]
            cost = f"{1e3 * seconds:.1f} ms, {ratio:.2f} times the plain pair"
            lines.append(f"{name}, {scene.analysis}: {cost}; {run.steps} steps, {run.events} events")
    return "\n".join(lines)


def _build_scenes(plan: dict[str, object] | None) -> list[Scene]:
    """Return the elastic and the inelastic scene of the pair; plan : of both buildings."""
    more = {} if plan is None else {"plan": plan}
    study = {
        "buildings": {
            "stiff": {"storeys": 5, "period": "0.36 s", **more},
            "soft": {"storeys": 5, "period": "0.60 s", **more},
        },
        "group": ["stiff", "soft"],
        "cases": {"touching": {"link": "pounding", "gap": "0 cm"}},
        "records": {"use": ["elcentro"]},
    }
    pair = make_plan(load_study(study))
    return [pair.build(row) for row in range(len(pair.analyses))]
