"""An isolated storey in a narrow moat beside a paper's."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from comparison import Entry, Row, compare
from scipy.constants import g as GRAVITY

REPOSITORY = "naseefo/mhps"
FOLDER = "validation/02torsionNZ/01TorsionallyCoupledMatsagar/FORTRANprogrammes/2BiD"
MOTIONS = ("Lgpc_acc_00.txt", "Lgpc_acc_90.txt", "Sylmar90.txt", "Sylmar360.txt", "KobeEW.txt", "KobeNS.txt")

PUBLISHED = {
    "Loma Prieta x": (53.61, 0.547, 21.95, 0.727),
    "Loma Prieta y": (19.28, 0.204, 13.50, 0.426),
    "Northridge x": (34.26, 0.352, 17.61, 0.500),
    "Northridge y": (49.42, 0.498, 29.20, 0.836),
    "Kobe x": (16.59, 0.177, 14.53, 0.531),
    "Kobe y": (32.30, 0.345, 22.28, 0.752),
}
"""Motion -> displacement of the base [cm] and acceleration of the roof [g], first without, then with the moat."""


def compare_isolated_moat(solved: Any) -> Iterator[Row]:
    """Yield the displacement of the base and the acceleration of the roof without and with the moat."""
    bases = solved.table("base").query("building == 'isolated'")
    displacements = 100 * bases.set_index(["case", "record"])["isolator_displacement"]
    roofs = solved.table("floor").query("building == 'isolated' and floor == 1")
    accelerations = roofs.set_index(["case", "record"])["acceleration"]
    for motion, (free_base, free_roof, base, roof) in PUBLISHED.items():
        alone, narrow, printed = (displacements[case, motion] for case in ("free", "moat", "printed"))
        why = "isolators and storey are linear"
        yield compare(f"base without the moat [cm], {motion}", free_base, alone, ".2f", why)
        why = f"with a twentieth of the stiffness of the storey; {printed:.2f} with the printed 5e-4"
        yield compare(f"base in the moat [cm], {motion}", base, narrow, ".2f", why)
        for case, published, place in (("free", free_roof, "without the moat"), ("moat", roof, "in the moat")):
            ours = accelerations[case, motion]
            why = f"with g = 10 m/s2 ours is {ours / 10:.3f}"
            yield compare(f"roof {place} [g], {motion}", published, ours / GRAVITY, ".3f", why)


ENTRY = Entry(compare_isolated_moat, motions=tuple(f"{FOLDER}/{each}" for each in MOTIONS), repository=REPOSITORY)
