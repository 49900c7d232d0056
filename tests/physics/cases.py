"""The table of cases: one row for each law of links, storeys, foundations and struck columns.

A row is what it changes of the same two buildings, 0.36 s and 0.60 s, three storeys each, with pounding between all
floors: a new law needs one row here, and `make reference` for the independent runs that go with it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from tests.adapter import Scene

GAP = 0.004
IMPACT = {"stiffness": 2e10, "restitution": 0.5}
PERIODS = 0.36, 0.60


def shake(duration: float, peak: float = 4.0, seed: int = 1, dt: float = 0.02) -> np.ndarray:
    """Smoothed noise that begins at zero, of a peak acceleration [m/s2], at steps of `dt` [s]."""
    noise = np.random.default_rng(seed).normal(size=round(duration / dt) + 7)
    smooth = np.convolve(noise, np.hanning(9)[1:-1], "valid")
    smooth[0] = 0.0
    return smooth * peak / np.abs(smooth).max()


@dataclass(frozen=True)
class Row:
    """One law.

    Parameters
    ----------
    name : what tests call it
    case : keys of a study's case; `gap` is added
    building : keys of both buildings beside period and storeys
    right : keys of the right one alone
    more : sections of the study: impact, laws
    like : the row that the independent integrator runs in its place, where it does not know the law
    contact : whether its links strike, so that a gap may just not close
    gap : of all its runs, where it cannot be zero: the thickness of an infill; floors in touch that a viscous damper
        holds together part too gently to agree on when [m]
    touching : analysis of the runs without gap
    peak, duration : of the motion of the pair [m/s2], [s]
    chained : whether a row of ten is run too, which takes long where forces are curved or many: another row has that
    """

    name: str
    case: Mapping[str, Any] = field(default_factory=lambda: {"link": "pounding"})
    building: Mapping[str, Any] = field(default_factory=dict)
    right: Mapping[str, Any] = field(default_factory=dict)
    more: Mapping[str, Any] = field(default_factory=dict)
    like: str = ""
    contact: bool = True
    gap: float = 0.0
    touching: str = "elastic"
    peak: float = 6.0
    duration: float = 1.0
    chained: bool = True

    def row(self, periods: tuple[float, ...], storeys: int, ground: np.ndarray, gap: float, analysis: str) -> Scene:
        """Buildings of these periods [s] side by side, every second one with the keys of the right one."""

        def cut(keys: Mapping[str, Any]) -> dict[str, Any]:
            """Lists of three storeys serve fewer."""
            return {name: each[:storeys] if isinstance(each, list) else each for name, each in keys.items()}

        common, right = {"storeys": storeys} | cut(self.building), cut(self.right)
        if "yield_shear" not in common:
            common["yield"] = {"overstrength": 2.0}
        buildings = [common | {"period": each} | (right if i % 2 else {}) for i, each in enumerate(periods)]
        case = {"gap": self.gap or gap, **self.case}
        return Scene(buildings, ground, 0.02, case, analysis, {"impact": IMPACT} | self.more)

    def pair(self, gap: float = GAP, analysis: str = "inelastic") -> Scene:
        """The two buildings."""
        return self.row(PERIODS, 3, shake(self.duration, self.peak), gap, analysis)

    def chain(self) -> Scene:
        """Ten buildings of two storeys."""
        return self.row((0.36, 0.60, 0.30, 0.52, 0.45) * 2, 2, shake(0.6, self.peak), GAP, "inelastic")


def beside(link: str, **keys: Any) -> dict[str, Any]:
    """A case of pounding with another link on the same floors."""
    return {"links": ["pounding", {"link": link, **keys}]}


def formula(force: str, acts: str, more: Mapping[str, Any] = {}, **parameters: Any) -> dict[str, Any]:
    """The section of a study with one law of its own, `own`."""
    return {"laws": {"own": {"force": force, "acts": acts, "parameters": parameters, **more}}}


XI = 0.2154538
"""Damping ratio of the dashpot near a restitution of 0.5 [-]."""

INFILL = {"link": "infill", "stiffness": 1.5e8}
THIN = 5e-4
CAPPED = {"capping_ductility": 3.0, "post_capping_slope": 0.1, "residual_strength": 0.3, "collapse": "never"}
LOST = CAPPED | {
    "strength_capacity": 60.0, "capping_capacity": 50.0, "unloading_capacity": 90.0, "reloading_capacity": 70.0,
    "deterioration_exponent": 1.2,
}  # fmt: skip
PINCHED = {"pinching_force": 0.3, "pinching_drift": 0.6}
SWAY = {"mass": 2e5, "sway_stiffness": 1e9, "sway_damping": 1e7}
ROCK = {"inertia": 1e7, "rocking_stiffness": 1e11, "rocking_damping": 1e8}
SLABS = {"slab": 0.2, "columns": 0.2}

LINKS = (
    Row("kelvin-voigt"),
    Row("kelvin-voigt, cut", {"link": "pounding", "tension_cut": True}),
    Row("kelvin-voigt, printed", more={"impact": IMPACT | {"dashpot": "printed"}}),
    Row("hertz", {"link": "hertz", "hertz_stiffness": 2e11}),
    Row("hertz-damp", {"link": "hertz-damp", "hertz_stiffness": 2e11, "restitution": 0.5}),
    Row("jankowski", {"link": "jankowski", "hertz_stiffness": 2e11, "restitution": 0.5}),
    Row("bilinear contact", {"link": "bilinear", "hertz_stiffness": 2e11, "penetration": 5e-4, "restitution": 0.5}),
    Row("infill", INFILL | {"law": "continuous"}, gap=THIN),
    Row("infill, printed", INFILL | {"law": "printed"}, gap=THIN),
    Row("infill, cut", INFILL | {"tension_cut": True}, gap=THIN),
    Row("connector", {"link": "connector", "stiffness": 1.5e8}, contact=False),
    Row("connector and pounding", beside("connector", stiffness=3e7)),
    Row("damper", beside("damper", damping_coefficient=2e6)),
    Row("viscous", beside("viscous", force_at_1_m_s=1e5, exponent=0.5, straight_below=1e-9), duration=0.6, gap=1e-4),
    Row("maxwell", beside("maxwell", stiffness=1e8, damping_coefficient=2e6)),
    Row("friction", beside("friction", stiffness=1e8, slip_force=2e5)),
    Row(
        "formula of kelvin-voigt", {"link": "own"}, like="formula's kelvin-voigt",
        more=formula("k*v + 2*xi*sqrt(k*m)*r", "beyond gap", k="2e10 N/m", xi=XI),
    ),
    Row("formula's kelvin-voigt", more={"impact": {"stiffness": 2e10, "damping_ratio": XI}}),
    Row(
        "formula of hertz", {"link": "own"}, like="hertz",
        more=formula("k*v**1.5", "beyond gap", k="2e11 N/m^1.5"),
    ),
)  # fmt: skip


def yielding(name: str, **building: Any) -> Row:
    """A law of storeys, through some cycles of yielding in both variants."""
    return Row(name, building=building, touching="inelastic", peak=5.0, duration=2.0)


STOREYS = (
    Row("elastic", building={"yield_shear": "never"}),
    yielding("bilinear", hardening=0.02),
    yielding("elastoplastic", hardening=0.0),
    yielding("peak-oriented", storey_law="peak-oriented"),
    yielding("imk", storey_law="imk-peak-oriented", **LOST),
    yielding("imk, kept", storey_law="imk-peak-oriented", **CAPPED),
    yielding("imk, pinched", storey_law="imk-pinching", **LOST, **PINCHED),
    yielding("bouc-wen", storey_law="bouc-wen", wen_exponent=2, wen_gamma=0.5),
    yielding("bouc-wen, n = 1", storey_law="bouc-wen", wen_exponent=1, wen_gamma=0.9),
    yielding("p-delta", p_delta=[2.4e7, 1.6e7, 8e6], collapse="never"),
)

GROUNDS = (
    Row("sway", building={"foundation": SWAY}),
    Row("rocking", building={"foundation": ROCK}),
    Row("sway and rocking", building={"foundation": SWAY | ROCK}),
    Row("p-delta on a foundation", building={"foundation": SWAY | ROCK, "p_delta": True, "collapse": "never"}),
    Row("infill on a foundation", INFILL, {"foundation": SWAY | ROCK}, gap=THIN),
)

COLUMNS = (
    Row("slabs on columns", {"link": "pounding"}, SLABS, {"height": [4.2, 3.0, 3.0]}),
    Row(
        "slabs on columns, on a foundation",
        {"link": "pounding"}, SLABS | {"foundation": SWAY | ROCK},
        {"height": [4.2, 3.0, 3.0]},
    ),
)  # fmt: skip

ENDS = [[2, "1 + 40 %"], ["0 + 2.1 m", 1]]
"""A floor against columns, and columns against a floor: those of the right building in storey 2, of the left in 1."""

INCLINED = {"floors": ENDS, "distance": 2.5}


def unaligned(
    name: str, link: Mapping[str, Any], building: Mapping[str, Any] = {}, right: Mapping[str, Any] = {}, **keys: Any
) -> Row:
    """A link beside pounding whose ends stand at different heights or on columns of 20 % of a storey."""
    return Row(f"unaligned {name}", {"links": ["pounding", link]}, SLABS | building, right, **keys)


UNALIGNED = (
    unaligned("connector, level", {"link": "connector", "stiffness": 3e7, "floors": ENDS}),
    unaligned(
        "connector over yielding storeys",
        {"link": "connector", "stiffness": 3e7, "floors": [["0 + 50 %", 1], [1, 2]], "distance": 3.0},
        {"hardening": 0.02}, touching="inelastic", peak=5.0, duration=2.0,
    ),
    unaligned("damper", {"link": "damper", "damping_coefficient": 2e6, **INCLINED}),
    unaligned(
        "viscous", {"link": "viscous", "force_at_1_m_s": 1e5, "exponent": 0.8, "straight_below": 1e-9, **INCLINED},
        duration=0.6, gap=1e-4, chained=False,
    ),
    unaligned(
        "maxwell on a foundation", {"link": "maxwell", "stiffness": 1e8, "damping_coefficient": 2e6, **INCLINED},
        {"foundation": SWAY | ROCK},
    ),
    unaligned(
        "friction under p-delta", {"link": "friction", "stiffness": 1e8, "slip_force": 2e5, **INCLINED},
        {"p_delta": [2.4e7, 1.6e7, 8e6], "collapse": "never"},
    ),
    unaligned(
        "connector over bouc-wen", {"link": "connector", "stiffness": 3e7, **INCLINED},
        {"storey_law": "bouc-wen", "wen_exponent": 2, "wen_gamma": 0.5}, chained=False,
    ),
    unaligned(
        "formula", {"link": "own", **INCLINED}, like="unaligned damper",
        more=formula("c*r", "always", c="2e6 N*s/m"),
    ),
    Row("infill on columns", INFILL, SLABS, {"height": [4.2, 3.0, 3.0]}, gap=THIN, chained=False),
    Row(
        "infill on columns, printed and cut", INFILL | {"law": "printed", "tension_cut": True}, SLABS,
        {"height": [4.2, 3.0, 3.0]}, gap=THIN, peak=7.0, chained=False,
    ),
)  # fmt: skip

ROWS = {row.name: row for row in (*LINKS, *STOREYS, *GROUNDS, *COLUMNS, *UNALIGNED)}

VARIANTS = "apart", "in touch"
"""The runs that the independent integrator makes of each row."""


def variant(row: Row, name: str) -> Scene:
    """The pair of a row with a gap, inelastic, or without."""
    return row.pair() if name == "apart" else row.pair(0.0, row.touching)


def referenced() -> dict[str, tuple[Row, str]]:
    """Every run of the independent integrator: its key, row and variant."""
    return {f"{row.name}; {name}": (row, name) for row in ROWS.values() if not row.like for name in VARIANTS}


def mirrored(scene: Scene) -> Scene:
    """The same seen from the other side of the street."""
    case = dict(scene.case)
    if "links" in case:
        case["links"] = [_mirrored_link(link) for link in case["links"]]
    return replace(scene, buildings=tuple(reversed(scene.buildings)), ground=-scene.ground, case=case)


def _mirrored_link(link: Any) -> Any:
    """Return a link whose ends have changed sides; what is no pair of floors stays."""
    if isinstance(link, str) or not isinstance(link.get("floors"), list):
        return link
    ends = [each[::-1] if isinstance(each, list) else each for each in link["floors"]]
    return {**link, "floors": ends}
