"""The drawings of docs/theory.md: `python docs/figures/model.py` writes `model.svg`, `links.svg` and `storeys.svg`.
The pages of the laws draw the loops one by one (docs/hooks/laws.py).

The first is a schematic. The loops of the others are runs of the solver: two floors that meet once under every law of a
link, and one storey under every law of a storey."""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from pounding_cli.api.scenes import history
from pounding_cli.laws import storey_laws
from pounding_cli.laws.bilinear_contact import BilinearContact
from pounding_cli.laws.hertz import Hertz, HertzDamp, Jankowski
from pounding_cli.laws.infill import Infill
from pounding_cli.laws.joints import Connector, Damper, Friction, Maxwell, Viscous
from pounding_cli.laws.law import LinkLaw
from pounding_cli.laws.pounding import Pounding
from pounding_cli.laws.storey import StoreyLaw
from pounding_cli.model.building import Building
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Analysis, Scene
from pounding_cli.records.motion import Motion
from pounding_cli.report.style import RC

FOLDER = Path(__file__).parent
BLUE, RED, GREY = "#0072B2", "#AA2211", "#777777"
MASS, GAP, XI, E = 2e5, 0.01, 0.215, 0.5
"""Of each floor [kg]; gap [m]; damping ratio and coefficient of restitution of the links [-]."""

LINKS: dict[str, LinkLaw] = {
    "pounding": Pounding(GAP, 2e8, XI),
    "pounding, tension cut": Pounding(GAP, 2e8, XI, tension_cut=True),
    "hertz": Hertz(GAP, 2e9),
    "hertz-damp": HertzDamp(GAP, 2e9, E),
    "jankowski": Jankowski(GAP, 2e9, E),
    "bilinear": BilinearContact(GAP, 2e9, 0.006, E),
    "infill": Infill(GAP, 1e6, 2e8, XI),
    "connector": Connector(GAP, 2e7, XI),
    "damper": Damper(GAP, 5e5),
    "viscous": Viscous(GAP, 3e5, 0.4),
    "maxwell": Maxwell(GAP, 2e7, 2e6),
    "friction": Friction(GAP, 4e7, 3e5),
}
STOREYS = {
    "capping_ductility": 3.0,
    "post_capping_slope": 0.08,
    "residual_strength": 0.2,
    "strength_capacity": 60.0,
    "capping_capacity": 60.0,
    "unloading_capacity": 120.0,
    "reloading_capacity": 60.0,
    "pinching_force": 0.3,
    "pinching_drift": 0.6,
}
"""Parameters of the laws of storeys that have them."""

ALWAYS = ("connector", "damper", "viscous", "maxwell", "friction")
"""Laws that act whatever the closing: drawn from the start of the pulse to its end."""

WITHIN_THE_GAP = (*ALWAYS, "infill")
"""Laws that act before the gap has closed: drawn over the closing itself."""


def pulse(size: float, duration: float, cycles: float = 0.5) -> Motion:
    """A sine that grows with the time, and as long a rest."""
    time = np.linspace(0.0, 1.0, 101)
    wave = size * np.sin(2 * np.pi * cycles * time) * (0.4 + 0.6 * time)
    return Motion("pulse", duration / 100, np.concatenate((wave, np.zeros(100))))


def loop_of_link(law: LinkLaw) -> tuple[np.ndarray, np.ndarray]:
    """Closing, less the gap where the law acts beyond it [m], and force [N], from the start to the end of contact."""
    stiffness = MASS * (2 * np.pi / np.array([1.2, 0.4])) ** 2
    floors = tuple(
        Building(name, [MASS], [3.0], [k], [np.inf], [0.0], 0.0, 0.0)
        for name, k in zip(("soft", "stiff"), stiffness, strict=True)
    )
    scene = Scene(floors, (Link(0, 1, 1, law),), pulse(-4.0, 0.4), Analysis.ELASTIC)
    kept = history(scene, 2e-5, 1e-9)
    force = kept.link_force[:, 0]
    closing = kept.displacement[:, 0, 0] - kept.displacement[:, 1, 0] - (0.0 if law.name in WITHIN_THE_GAP else GAP)
    if law.name in ALWAYS:
        return closing, force
    begin = int(np.argmax(force != 0.0))
    end = begin + int(np.argmax(force[begin:] == 0.0)) or force.size
    return closing[begin - 1 : end + 1], force[begin - 1 : end + 1]


def loop_of_storey(law: type[StoreyLaw]) -> tuple[np.ndarray, np.ndarray]:
    """Drift over yield drift and shear over yield shear of a storey of 0.5 s."""
    stiffness = MASS * (2 * np.pi / 0.5) ** 2
    parameters = tuple((name, value) for name, value in STOREYS.items() if name in law.parameters())
    building = Building(
        "one", [MASS], [3.0], [stiffness], [6e5], [0.05], 0.5, 0.0,
        storey_law=law, law_parameters=parameters, collapse=np.inf,
    )  # fmt: skip
    kept = history(Scene((building,), (), pulse(4.5, 2.0, 3.0), Analysis.INELASTIC), 1e-3, 1e-9)
    moving = kept.time <= 2.0
    return kept.drift[moving, 0, 0] * stiffness / 6e5, kept.shear[moving, 0, 0] / 6e5


def spring(ax: Axes, x: tuple[float, float], y: float, color: str = "k") -> None:
    """A zigzag between two abscissas."""
    at = np.linspace(*x, 13)
    ax.plot(at, y + 0.07 * np.array([0, 0, 0, *([1, -1] * 3), 0, 0, 0, 0]), color=color, lw=1)


def dashpot(ax: Axes, x: tuple[float, float], y: float, color: str = "k") -> None:
    """A piston in a cylinder between two abscissas."""
    low, high = x
    middle = (low + high) / 2
    ax.plot([low, middle - 0.08], [y, y], color=color, lw=1)
    ax.plot(
        [middle + 0.08, middle - 0.08, middle - 0.08, middle + 0.08],
        y + 0.07 * np.array([1, 1, -1, -1]),
        color=color,
        lw=1,
    )
    ax.plot([middle, middle], [y - 0.05, y + 0.05], color=color, lw=1)
    ax.plot([middle, high], [y, y], color=color, lw=1)


def draw_model() -> None:
    """Two buildings, a link between floors that face each other, and a foundation."""
    figure = Figure(figsize=(6.4, 4.0), layout="constrained")
    ax = figure.add_subplot()
    for left, floors, name in ((0.0, 3, "i"), (3.2, 2, "i+1")):
        for floor in range(floors + 1):
            height = 0.12 if floor else 0.2
            ax.add_patch(Rectangle((left, floor - height / 2), 2.0, height, color="#DDDDDD" if floor else GREY))
            if floor:
                ax.plot([left + 0.15] * 2, [floor - 0.94, floor - 0.06], "k", lw=2)
                ax.plot([left + 1.85] * 2, [floor - 0.94, floor - 0.06], "k", lw=2)
                ax.text(left + 1.0, floor, f"$m_{floor}$", ha="center", va="center", fontsize=8)
                ax.text(
                    left + 1.0,
                    floor - 0.5,
                    f"$k_{floor},\\ V_{{y{floor}}},\\ h_{floor}$",
                    ha="center",
                    va="center",
                    fontsize=8,
                )
        ax.text(left + 1.0, floors + 0.25, f"building ${name}$", ha="center", fontsize=9)
    for floor in (1, 2):
        spring(ax, (2.0, 3.2), floor + 0.12, BLUE)
        dashpot(ax, (2.0, 3.2), floor - 0.12, BLUE)
    ax.text(2.6, 2.32, "link: law $F(v, \\dot{v})$", ha="center", fontsize=8, color=BLUE)
    ax.annotate("", (2.0, 0.5), (3.2, 0.5), arrowprops={"arrowstyle": "<->", "lw": 0.8})
    ax.text(2.6, 0.56, "gap $d$", ha="center", fontsize=8)
    ax.annotate("", (-0.05, 3.0), (-0.75, 3.0), arrowprops={"arrowstyle": "->", "lw": 0.8})
    ax.text(-0.4, 3.07, "$u_3$", ha="center", fontsize=9)
    spring(ax, (-0.9, 0.0), 0.07, RED)
    dashpot(ax, (-0.9, 0.0), -0.12, RED)
    ax.plot([-0.9, -0.9], [-0.25, 0.25], color=RED, lw=1.5)
    ax.text(-0.95, 0.0, "$k_h, c_h$", ha="right", va="center", fontsize=8, color=RED)
    ax.text(
        1.0,
        -0.37,
        "foundation $m_b, I_b$: sway $u_b$, rocking $\\varphi_b$ ($k_r, c_r$)",
        ha="center",
        fontsize=8,
        color=RED,
    )
    ax.annotate("", (5.0, -0.55), (-0.4, -0.55), arrowprops={"arrowstyle": "->", "lw": 1.2})
    ax.text(2.4, -0.75, "ground acceleration $a_g$: a straight line between samples", ha="center", fontsize=8)
    ax.set(xlim=(-1.8, 5.4), ylim=(-0.9, 3.5), aspect="equal")
    ax.axis("off")
    figure.savefig(FOLDER / "model.svg", metadata={"Date": None})


def draw_links() -> None:
    """Force over closing, law by law."""
    figure = Figure(figsize=(6.8, 7.2), layout="constrained")
    for ax, (name, law) in zip(figure.subplots(4, 3).flat, LINKS.items(), strict=True):
        closing, force = loop_of_link(law)
        ax.plot(1e3 * closing, 1e-6 * force, color=BLUE, lw=1.2)
        ax.axhline(0.0, color=GREY, lw=0.5)
        ax.axvline(0.0, color=GREY, lw=0.5)
        ax.set_title(name, fontsize=8)
        ax.tick_params(labelsize=7)
    figure.supxlabel("closing v, of contacts less the gap [mm]", fontsize=8)
    figure.supylabel("force F, positive where it pushes the floors apart [MN]", fontsize=8)
    figure.savefig(FOLDER / "links.svg", metadata={"Date": None})


def draw_storeys() -> None:
    """Shear over drift, law by law."""
    laws = storey_laws()
    rows = -(-len(laws) // 2)
    figure = Figure(figsize=(6.4, 2.6 * rows), layout="constrained")
    axes = figure.subplots(rows, 2, sharey=True).flatten()
    for ax in axes[len(laws) :]:
        ax.set_axis_off()
    for ax, (name, law) in zip(axes[: len(laws)], laws.items(), strict=True):
        drift, shear = loop_of_storey(law)
        ax.plot(drift, shear, color=BLUE, lw=1.2)
        ax.axhline(0.0, color=GREY, lw=0.5)
        ax.axvline(0.0, color=GREY, lw=0.5)
        ax.set_title(name, fontsize=8)
        ax.set_xlabel("drift over yield drift", fontsize=8)
        ax.tick_params(labelsize=7)
    for ax in figure.axes[::2]:
        ax.set_ylabel("shear over yield shear", fontsize=8)
    figure.savefig(FOLDER / "storeys.svg", metadata={"Date": None})


if __name__ == "__main__":
    with mpl.rc_context({**RC, "svg.hashsalt": "model"}):
        draw_model()
        draw_links()
        draw_storeys()
