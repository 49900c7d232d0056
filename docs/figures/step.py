"""The drawing and the numbers of docs/a-step.md: four steps of the Taylor integrator, read from the records of a run.

`python docs/figures/step.py` runs a pair of buildings up to the first contact, writes `step.svg` and puts the numbers
into the page."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

import pounding_cli as pound
from pounding_cli.solver.energy import PLACES
from pounding_cli.solver.solve import prepare

FOLDER = Path(__file__).parent
PAGE = FOLDER.parent / "a-step.md"
BEGIN, END = "<!-- step: begin (python docs/figures/step.py) -->", "<!-- step: end -->"
ACCURACY = 1e-9


def scene():
    """Two buildings of two storeys, 1 cm apart, in four seconds of El Centro."""
    stiff, soft = (pound.building(name, storeys=2, period=T) for name, T in (("stiff", 0.3), ("soft", 0.5)))
    return pound.scene(
        [stiff, soft], pound.motion("elcentro", duration=4), link="pounding", gap=0.01, analysis="elastic"
    )


@dataclass(frozen=True)
class Step:
    """One step as the solver left it.

    h, end : its length [s], the part of it that counts [-]
    order : of the series
    closing : coefficients in s of the closing of the link [m], less the gap
    deviation : its chord deviation [m]
    terms : the largest term of the accelerations over what may be left out, by order [-]
    force : coefficients of the force of the link [N]; empty where it is open
    peak : largest force so far [N]
    points : where the energies look at the step [-]
    work : done on the link in this step [J]
    """

    h: float
    end: float
    order: int
    closing: np.ndarray
    deviation: float
    terms: np.ndarray
    force: np.ndarray
    peak: float
    points: np.ndarray
    work: float


class Steps:
    """Steps of a scene by number, from 1. A run that may take n steps leaves the n-th in its records."""

    def __init__(self, scene, link: int) -> None:
        self.scene, self.link = scene, link

    def _run(self, n: int):
        run = prepare(self.scene, ACCURACY, bounds=(n - 1, 10**6))
        run.integrate()
        return run.data, run.data.run[0], run.data.elements[run.layout.of_links][self.link]

    def first_event(self) -> int:
        """Number of the first step that ends at an event."""
        low, high = 1, 2
        while self._run(high)[1]["events"] == 0:
            low, high = high, 2 * high
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (middle, high) if self._run(middle)[1]["events"] == 0 else (low, middle)
        return high

    def __getitem__(self, n: int) -> Step:
        before, _, began = self._run(n - 1)
        data, r, link = self._run(n)
        h, end, order, q = float(r["h"]), float(r["end"]), int(r["order"]), int(r["points"])
        velocities = data.dofs["w"][:, : order + 1].copy()
        velocities[:, 0] = before.dofs["w"][:, 0]  # the records have gone on to the step's end by now
        k = np.arange(1, order + 1)
        left, right = int(link["left"]), int(link["right"])
        closing = np.concatenate(([began["v0"]], h / k * (velocities[left, :-1] - velocities[right, :-1])))
        terms = np.abs(velocities[:, 1:]) * k / h * data.dofs["allowed"][:, None]
        force = data.series["f"][int(began["row"])][:order].copy() if began["closed"] else np.empty(0)
        points = np.concatenate(([0.0], PLACES[q, :q], [1.0])) * end
        return Step(
            h, end, order, closing, float(link["dv"]), terms.max(axis=0), force, float(link["peak_f"]), points,
            float(link["work"] - began["work"]),
        )  # fmt: skip


def four_steps() -> tuple[int, list[Step]]:
    """Number of the first step that ends at an event; the steps from the one before it to the end of the contact."""
    steps = Steps(scene(), link=1)
    first = steps.first_event()
    return first, [steps[first + k] for k in range(-1, 3)]


def at(coefficients: np.ndarray, s):
    """A polynomial at s."""
    return np.polyval(coefficients[::-1], s)


def rate(step: Step) -> np.ndarray:
    """Coefficients of the rate of the closing [m/s]."""
    return step.closing[1:] * np.arange(1, step.order + 1) / step.h


def table(first: int, steps: list[Step]) -> str:
    """The numbers of the page."""
    rows = [
        ("length h [ms]", [f"{1e3 * s.h:.3f}" for s in steps]),
        ("order of the series", [f"{s.order}" for s in steps]),
        ("v at the start [mm]", [f"{1e3 * s.closing[0]:.4f}" for s in steps]),
        ("v at s = 1 [mm]", [f"{1e3 * at(s.closing, 1.0):.4f}" for s in steps]),
        ("chord deviation of v [mm]", [f"{1e3 * s.deviation:.4f}" for s in steps]),
        ("the step ends at s =", [f"{s.end:.4f}" for s in steps]),
        ("largest force so far [kN]", [f"{1e-3 * s.peak:.1f}" for s in steps]),
        ("work done on the link [J]", [f"{s.work:.2f}" for s in steps]),
    ]
    head = ["", *(f"step {first + k - 1}" for k in range(len(steps)))]
    lines = [f"| {' | '.join(head)} |", "|---" * len(head) + "|"]
    return "\n".join([*lines, *(f"| {name} | {' | '.join(values)} |" for name, values in rows)])


def draw(first: int, steps: list[Step], path: Path) -> None:
    """The drawing."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    matplotlib.rcParams.update({"svg.hashsalt": "step", "svg.fonttype": "none", "font.size": 9})
    figure, axes = plt.subplots(2, 2, figsize=(9.5, 6.4), layout="constrained")
    for axis, step, number in zip(axes[0], steps, (first - 1, first), strict=False):
        _closing(axis, step, number)
    _terms(axes[1, 0], steps[1:3], (first, first + 1))
    _contact(axes[1, 1], steps[2:], (first + 1, first + 2))
    figure.savefig(path, metadata={"Date": None})
    plt.close(figure)


def _closing(axis, step: Step, number: int) -> None:
    s = np.linspace(0, 1, 51)
    chord = 1e3 * (step.closing[0] + (at(step.closing, 1.0) - step.closing[0]) * s)
    reach = 1e3 * step.deviation
    axis.fill_between(s, chord - reach, chord + reach, color="0.88", label="chord ± chord deviation")
    axis.plot(s, chord, color="0.6", lw=0.8, label="chord")
    axis.axhline(0, color="tab:red", lw=1, label="guard: v = 0")
    kept = s <= step.end
    axis.plot(s[kept], 1e3 * at(step.closing, s[kept]), color="tab:blue", label="series of the closing v")
    axis.plot(s[~kept], 1e3 * at(step.closing, s[~kept]), ":", color="tab:blue")
    if step.end < 1:
        axis.plot(step.end, 0, "o", color="tab:red", label=f"root: s = {step.end:.4f}")
    what = "the bound reaches the guard" if step.end < 1 else "the bound excludes an event"
    axis.set(title=f"step {number}: {what}", xlabel="s [-]", ylabel="closing less the gap, v [mm]", xlim=(0, 1))
    axis.legend(loc="lower right", fontsize=7.5)


def _terms(axis, steps: list[Step], numbers: tuple[int, ...]) -> None:
    for step, number, mark in zip(steps, numbers, ("o", "s"), strict=True):
        where = "open" if not step.force.size else "in contact"
        axis.semilogy(np.arange(step.order), step.terms, mark, ms=4, label=f"step {number}, {where}")
    axis.axhline(1, color="tab:red", lw=1, label="what may be left out")
    axis.set(title="the series end after two terms below", xlabel="order [-]")
    axis.set_ylabel("largest term over what may be left out [-]")
    axis.legend(loc="upper right", fontsize=7.5)


def _contact(axis, steps: list[Step], numbers: tuple[int, ...]) -> None:
    begin = 0.0
    for step, number in zip(steps, numbers, strict=True):
        s = np.linspace(0, step.end, 51)
        time = lambda part, b=begin, h=step.h: 1e3 * (b + part * h)  # noqa: E731
        axis.plot(time(s), 1e-3 * at(step.force, s), label=f"force of step {number}")
        axis.plot(time(step.points), 1e-3 * at(step.force, step.points), "|", color="black", ms=9)
        begin += step.h * step.end
        axis.axvline(1e3 * begin, color="0.6", lw=0.8)
    axis.plot([], [], "|", color="black", label="points of the energies")
    axis.axhline(1e-3 * steps[-1].peak, ls="--", color="tab:red", lw=1, label="largest force")
    axis.set(title="the contact, over a sample of the motion", xlabel="time since contact [ms]", ylabel="force F [kN]")
    axis.legend(loc="lower center", fontsize=7.5)


if __name__ == "__main__":
    found = four_steps()
    draw(*found, FOLDER / "step.svg")
    before, _, rest = PAGE.read_text().partition(BEGIN)
    PAGE.write_text(f"{before}{BEGIN}\n{table(*found)}\n{END}{rest.partition(END)[2]}")
