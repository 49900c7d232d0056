"""Runs of the table, and of hard scenes, by the independent integrator of tests/reference, kept in `references.npz`.

`python -m tests.physics.references` renews them (some minutes); with `--check` it compares them with what is kept, and
ends with exit code 1 where one differs; with words, only those whose key holds one of them.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np

import pounding_cli as pound
from tests.adapter import scenes
from tests.hard.catalogue import studies
from tests.physics.cases import referenced, variant
from tests.physics.twisting import referenced_scenes
from tests.reference.events import integrate

KEPT = Path(__file__).with_name("references.npz")

FIELDS = (
    "shear", "drift", "acceleration", "displacement_max", "displacement_min", "end", "end_velocity",
    "peak_force", "max_closing", "impulse", "contact_time", "impacts", "columns", "work",
)  # fmt: skip
"""What is kept of a run; "columns" below and above each struck column in turn, "work" of ground and dashpots [J]."""


TWISTING = "line_shear", "line_drift", "edge_drift", "twist", "turns", "turn_rate"
"""What is kept beside it of scenes whose floors twist."""


def hard_scenes() -> dict[str, pound.Scene]:
    """The scenes of the catalogue of hard ones that the integrator can afford: study, case and analysis."""
    return {
        f"{study.name}; {where}": scene
        for study in studies()
        if study.expect.independent
        for where, scene, _ in scenes(study.path)
        if scene.links
    }


def run(scene: pound.Scene) -> np.ndarray:
    """One run: FIELDS behind one another, each with its length before it; then TWISTING, where floors twist."""
    found = integrate(scene, per_radian=0.1 if any(b.plan is not None for b in scene.buildings) else 0.25)
    values = {"end": found.displacement, "end_velocity": found.velocity}
    values["work"] = np.array([found.energy["input"], found.energy["damping"]])
    parts = [
        np.asarray(values[name] if name in values else getattr(found, name), float)
        for name in (*FIELDS, *(TWISTING if found.twist.size else ()))
    ]
    return np.concatenate([np.concatenate(([part.size], part)) for part in parts])


def read(key: str) -> dict[str, np.ndarray]:
    """What is kept of the run of a key, by FIELDS and TWISTING."""
    with np.load(KEPT) as kept:
        values, found = kept[key], {}
    for name in (*FIELDS, *TWISTING):
        if not values.size:
            break
        size = int(values[0])
        found[name], values = values[1 : 1 + size], values[1 + size :]
    return found


def main(*words: str) -> int:
    check, words = "--check" in words, tuple(word for word in words if word != "--check")
    kept = dict(np.load(KEPT)) if KEPT.exists() else {}
    wrong = 0
    jobs = {key: variant(*each).built for key, each in referenced().items()} | hard_scenes()
    jobs |= {f"twist; {name}": make() for name, make in referenced_scenes().items()}
    for key, scene in jobs.items():
        if words and not any(word in key for word in words):
            continue
        begin = time.perf_counter()
        found = run(scene)
        old = kept.get(key, np.zeros(0))
        same = old.shape == found.shape and np.allclose(old, found, rtol=1e-7, atol=1e-12)
        wrong += not same
        print(f"{key}: {time.perf_counter() - begin:.1f} s, {'as before' if same else 'changed'}", flush=True)
        kept[key] = found
        if not check:
            np.savez_compressed(KEPT, **{each: kept[each] for each in jobs if each in kept})
    return wrong if check else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
