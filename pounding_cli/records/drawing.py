"""A picture of one motion: acceleration, velocity, displacement, Husid curve and response spectrum."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from pounding_cli.errors import InputError, Problem
from pounding_cli.records.intensity import displacement, husid, spectrum, velocity
from pounding_cli.records.motion import GRAVITY, Motion

FORMATS = (".png", ".svg", ".pdf")


def draw(motion: Motion, title: str, path: Path) -> None:
    """Draw `motion` into `path` (png, svg or pdf by its ending), whole or not at all.

    Raises `InputError` for another ending.
    """
    if path.suffix.lower() not in FORMATS:
        raise InputError(
            Problem(f"cannot draw a '{path.suffix}' file", f"end the name with {', '.join(FORMATS)}", str(path))
        )
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.0, 9.0), layout="constrained")
    times = motion.dt * np.arange(motion.acceleration.size)
    axes = figure.subplots(5, 1, gridspec_kw={"height_ratios": [1, 1, 1, 1, 1.6]})
    for axis, values, label in (
        (axes[0], motion.acceleration / GRAVITY, "acceleration [g]"),
        (axes[1], velocity(motion), "velocity [m/s]"),
        (axes[2], displacement(motion), "displacement [m]"),
        (axes[3], husid(motion), "Husid [-]"),
    ):
        axis.plot(times, values, color="black", linewidth=0.8)
        axis.set_ylabel(label)
        axis.set_xlim(0.0, motion.duration)
        axis.grid(alpha=0.3)
    axes[3].axhline(0.05, color="grey", linewidth=0.6, linestyle="--")
    axes[3].axhline(0.95, color="grey", linewidth=0.6, linestyle="--")
    axes[3].set_xlabel("time [s]")
    periods = np.geomspace(0.05, 4.0, 200)
    axes[4].semilogx(periods, spectrum(motion, periods) / GRAVITY, color="black", linewidth=1.0)
    axes[4].set_xlabel("period [s]")
    axes[4].set_ylabel("Sa, 5 % damped [g]")
    axes[4].set_ylim(bottom=0.0)
    axes[4].grid(alpha=0.3, which="both")
    figure.suptitle(f"{title} ({motion.source})")
    path.parent.mkdir(parents=True, exist_ok=True)
    draft = path.with_name(f".{path.name}.{os.getpid()}{path.suffix}")
    try:
        figure.savefig(draft, dpi=150)
        os.replace(draft, path)
    finally:
        draft.unlink(missing_ok=True)
