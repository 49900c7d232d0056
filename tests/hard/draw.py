"""Random numbers and the keys of laws, as hypothesis strategies: one row a law, each key over its whole range."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from hypothesis import strategies as st


def decades(low: float, high: float, *corners: float | str, far: bool = True) -> st.SearchStrategy:
    """A positive number, even in its logarithm; now and then a corner of the range, or (`far`) one absurdly far."""
    usual = st.floats(math.log10(low), math.log10(high)).map(lambda x: float(f"{10**x:.4g}"))
    rare = [st.sampled_from(corners)] * (2 if corners else 0)
    if far:
        rare.append(st.integers(-12, 14).map(lambda x: 10.0**x))
    return st.integers(0, 40).flatmap(lambda i: rare[i] if i < len(rare) else usual)


def some(draw: Any, into: dict, key: str, values: st.SearchStrategy, chance: int = 3) -> None:
    """Put `key` into a mapping once in `chance` times."""
    if draw(st.integers(1, chance)) == 1:
        into[key] = draw(values)


def share(low: float, high: float, *ends: float) -> st.SearchStrategy:
    """A number of a bounded range, its ends among them."""
    inner = st.floats(0.001, 0.999).map(lambda x: float(f"{low + (high - low) * x:.4g}"))
    return st.one_of(inner, inner, st.sampled_from(ends or (low, high)))


RESTITUTION = st.one_of(st.floats(0.01, 1.0).map(lambda x: round(x, 3)), st.sampled_from([1, 0.5, 0.01, 1e-9]))
LOSSY = share(0.01, 1)
"""Restitution of the laws of contact that have a least one."""
MULTIPLE = st.floats(-6, 7).map(lambda x: f"{10**x:.4g} x stiffest storey")
STIFFNESS = st.one_of(MULTIPLE, decades(1e3, 1e13))
HERTZ = decades(1e4, 1e14)
CUT = st.booleans()
CAPACITY = decades(1e-3, 1e3)

Keys = Mapping[str, st.SearchStrategy]
"""Values by key of a study."""

LINKS: Mapping[str, tuple[Keys, Keys]] = {
    "pounding": ({}, {"stiffness": STIFFNESS, "restitution": RESTITUTION, "tension_cut": CUT}),
    "infill": (
        {},
        {
            "stiffness": STIFFNESS, "restitution": RESTITUTION, "tension_cut": CUT,
            "law": st.sampled_from(["continuous", "printed"]),
        },
    ),
    "connector": ({}, {"stiffness": STIFFNESS, "restitution": RESTITUTION}),
    "hertz": ({"hertz_stiffness": HERTZ}, {}),
    "hertz-damp": (
        {"hertz_stiffness": HERTZ},
        {"restitution": LOSSY, "damping_formula": st.sampled_from(["exact", "ye", "muthukumar"])},
    ),
    "jankowski": (
        {"hertz_stiffness": HERTZ},
        {"restitution": LOSSY, "damping_formula": st.sampled_from(["exact", "jankowski"])},
    ),
    "bilinear": (
        {"hertz_stiffness": HERTZ, "penetration": decades(1e-5, 0.1)},
        {
            "restitution": LOSSY, "yield_share": share(0, 0.5, 5e-7, 0.4999995),
            "damping_formula": st.sampled_from(["exact", "muthukumar"]),
        },
    ),
    "damper": ({"damping_coefficient": decades(1e2, 1e9)}, {}),
    "viscous": (
        {"force_at_1_m_s": decades(1e2, 1e8), "exponent": share(0.1, 1, 0.1, 0.999999)},
        {"straight_below": decades(1e-8, 1e-2, 1e-9)},
    ),
    "maxwell": ({"damping_coefficient": decades(1e2, 1e9)}, {"stiffness": STIFFNESS}),
    "friction": ({"slip_force": decades(1e2, 1e8)}, {"stiffness": STIFFNESS}),
}  # fmt: skip
"""Laws of links, with the keys that each needs and those that it may have."""

CONTACTS = "kelvin-voigt", "hertz", "hertz-damp", "jankowski", "bilinear"
"""What `link: pounding` may stand for."""

CAPPED: Keys = {"capping_ductility": decades(1.0, 1e3, 1.0), "post_capping_slope": decades(1e-3, 1e3)}
LOSSES: Keys = {
    "residual_strength": share(0, 1, 0, 0.999999), "deterioration_exponent": share(0.1, 3),
    **{f"{mode}_capacity": CAPACITY for mode in ("strength", "capping", "unloading", "reloading")},
}  # fmt: skip
PINCHED: Keys = {"pinching_force": share(0, 1, 1e-6, 1), "pinching_drift": share(0, 1)}

STOREYS: Mapping[str, tuple[Keys, Keys]] = {
    "bilinear": ({}, {}),
    "peak-oriented": ({}, {}),
    "imk-peak-oriented": (CAPPED, LOSSES),
    "imk-pinching": ({**CAPPED, **PINCHED}, LOSSES),
    "bouc-wen": ({}, {"wen_exponent": st.integers(1, 20), "wen_gamma": share(-1, 0.99, -1, 0.99)}),
}
"""The same for laws of storeys."""


@st.composite
def law_keys(draw: Any, law: tuple[Keys, Keys]) -> dict[str, Any]:
    """The keys of a link or a building that belong to its law: all it needs, and some of the others."""
    needed, others = law
    spec = {name: draw(values) for name, values in needed.items()}
    for name, values in others.items():
        some(draw, spec, name, values)
    return spec


@st.composite
def own_law(draw: Any) -> dict[str, Any]:
    """A law of the study's own."""
    k, c = draw(decades(1e5, 1e11)), draw(decades(1e3, 1e8))
    force, parameters, acts = draw(
        st.sampled_from(
            [
                ("k*v + c*r", {"k": f"{k:g} N/m", "c": f"{c:g} N s/m"}, "beyond gap"),
                ("k*v + c*r", {"k": f"{k:g} N/m", "c": f"{c:g} N s/m"}, "always"),
                ("k*v + k3*v**3 + 2*xi*sqrt(m*(k + 3*k3*v**2))*r",
                 {"k": f"{k:g} N/m", "k3": f"{1e4 * k:g} N/m^3", "xi": 0.2}, "compression"),
                ("k*v**1.5 + c*r", {"k": f"{10 * k:g} N/m^1.5", "c": f"{c:g} N s/m"}, "beyond gap"),
                ("k*v/(1 + v**2/w**2)", {"k": f"{k:g} N/m", "w": "5 cm"}, "compression"),
            ]
        )
    )  # fmt: skip
    spec = {"force": force, "parameters": parameters, "acts": acts}
    if acts != "always":
        some(draw, spec, "tension_cut", st.booleans())
    return spec
