"""The figure and the numbers of docs/contact.md: restitution asked for against restitution that comes out.

`python docs/figures/restitution.py` lets two all but free masses strike each other under every law and formula, writes
`restitution.svg` and puts the table into the page."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np

from pounding_cli.laws.bilinear_contact import BilinearContact, BilinearDamping
from pounding_cli.laws.hertz import HertzDamp, HertzDamping, Jankowski, JankowskiDamping
from pounding_cli.laws.law import LinkLaw
from pounding_cli.laws.pounding import Pounding, damping_ratio
from pounding_cli.model.building import Building
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Analysis, Scene
from pounding_cli.records.motion import Motion
from pounding_cli.solver.solve import solve

FOLDER = Path(__file__).parent
PAGE = FOLDER.parent / "contact.md"
BEGIN, END = "<!-- restitution: begin (python docs/figures/restitution.py) -->", "<!-- restitution: end -->"
ASKED = (0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9)
MASS, STIFFNESS, SPEED, DEPTH = 2e5, 2e9, 0.6, 0.005
"""Of each floor [kg], k_h [N/m^1.5], approach [m/s], d_m [m]: no restitution depends on the first three."""

LAWS: dict[str, Callable[[float], LinkLaw]] = {
    "pounding": lambda e: Pounding(0.0, 2e9, damping_ratio(e)),
    "pounding, tension cut": lambda e: Pounding(0.0, 2e9, damping_ratio(e), tension_cut=True),
    "hertz-damp": lambda e: HertzDamp(0.0, STIFFNESS, e),
    "hertz-damp, ye": lambda e: HertzDamp(0.0, STIFFNESS, e, HertzDamping.YE),
    "hertz-damp, muthukumar": lambda e: HertzDamp(0.0, STIFFNESS, e, HertzDamping.MUTHUKUMAR),
    "jankowski": lambda e: Jankowski(0.0, STIFFNESS, e),
    "jankowski, jankowski": lambda e: Jankowski(0.0, STIFFNESS, e, JankowskiDamping.JANKOWSKI),
    "bilinear": lambda e: BilinearContact(0.0, STIFFNESS, DEPTH, e),
    "bilinear, muthukumar": lambda e: BilinearContact(0.0, STIFFNESS, DEPTH, e, 0.1, BilinearDamping.MUTHUKUMAR),
}
"""Every law of contact that takes a restitution, and every formula by its name."""


def speed_of(law: LinkLaw) -> float:
    """Speed of the blow [m/s]: of a bilinear contact the one that it is laid out for."""
    if not isinstance(law, BilinearContact):
        return SPEED
    k1, k2, limit = law.element_parameters(1.0, 1.0)
    beyond = law.penetration - limit
    return math.sqrt((k1 * limit**2 + 2 * k1 * limit * beyond + k2 * beyond**2) / (MASS / 2))


def obtained(law: LinkLaw) -> float:
    """Speed at which two floors part over the speed at which they met [-]; their storeys are next to nothing."""
    floors = tuple(Building(name, [MASS], [3.0], [1e-9], [math.inf], [0.0], 0.0, 0.0) for name in ("left", "right"))
    scene = Scene(floors, (Link(0, 1, 1, law),), Motion("still", 0.02, np.zeros(11)), Analysis.ELASTIC)
    speed = speed_of(law)
    run = solve(scene, 1e-12, initial=([[0.0], [0.0]], [[speed], [0.0]]))
    assert run.status == "done"
    (_, (left,)), (_, (right,)) = run.final
    return (right - left) / speed


def curves() -> dict[str, list[float]]:
    """Restitution obtained, law by law, one for each of `ASKED`."""
    return {name: [obtained(law(e)) for e in ASKED] for name, law in LAWS.items()}


def table(found: dict[str, list[float]]) -> str:
    """As the page has it."""
    head = "| law, formula | " + " | ".join(f"{e:g}" for e in ASKED) + " |"
    rows = [f"| {name} | " + " | ".join(f"{e:.4f}" for e in values) + " |" for name, values in found.items()]
    return "\n".join([head, "|" + "---|" * (len(ASKED) + 1), *rows])


def draw(found: dict[str, list[float]]) -> None:
    """`restitution.svg`."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    from pounding_cli.report.style import RC

    published = [name for name, values in found.items() if max(np.abs(np.subtract(values, ASKED))) > 1e-6]
    with mpl.rc_context(RC):
        figure = Figure(figsize=(5.2, 3.6), layout="constrained")
        ax = figure.add_subplot()
        ax.plot(ASKED, ASKED, "k-", lw=1.6, label="what is asked for: all laws by default")
        looks = zip(published, "sv^Do", ("#AA2211", "#0072B2", "#009E73", "#E69F00", "#CC79A7"), strict=True)
        for name, marker, color in looks:
            ax.plot(ASKED, found[name], marker=marker, ms=4, lw=1, color=color, label=name)
        ax.set(xlabel="coefficient of restitution asked for", ylabel="that comes out")
        ax.legend(fontsize=7.5)
        figure.savefig(FOLDER / "restitution.svg", metadata={"Date": None})


if __name__ == "__main__":
    numbers = curves()
    draw(numbers)
    before, rest = PAGE.read_text(encoding="utf-8").split(BEGIN)
    PAGE.write_text(f"{before}{BEGIN}\n\n{table(numbers)}\n\n{END}{rest.split(END)[1]}", encoding="utf-8")
