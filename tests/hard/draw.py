"""Random numbers and the parameters of laws, as hypothesis strategies.

Every law that is installed is drawn, each of its parameters over the range that the law declares: a new law needs no
line here, a parameter in a new unit needs one in `USUAL`."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import MISSING
from typing import Any, get_type_hints

from hypothesis import strategies as st

from pounding_cli.laws.law import Law, Parameter
from pounding_cli.study.law_keys import FROM_CASE, own_parameters, words_of


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


RESTITUTION = st.one_of(st.floats(0.01, 1.0).map(lambda x: round(x, 3)), st.sampled_from([1, 0.5, 0.01, 1e-9]))
MULTIPLE = st.floats(-6, 7).map(lambda x: f"{10**x:.4g} x stiffest storey")
STIFFNESS = st.one_of(MULTIPLE, decades(1e3, 1e13))

USUAL: Mapping[str, st.SearchStrategy] = {
    "N/m": STIFFNESS,
    "N/m^1.5": decades(1e4, 1e14),
    "N": decades(1e2, 1e8),
    "N s/m": decades(1e2, 1e9),
    "m": decades(1e-5, 0.1),
    "m/s": decades(1e-8, 1e-2, 1e-9),
}
"""Values by unit."""

_CASE: Mapping[str, st.SearchStrategy] = {
    "stiffness": STIFFNESS, "restitution": RESTITUTION, "tension_cut": st.booleans()
}  # fmt: skip
"""Those of keys that several laws share."""


def values_of(law: type[Law], name: str, declared: Parameter) -> st.SearchStrategy:
    """Values of a parameter that a law alone has, ends of its range among them."""
    words = words_of(law, name)
    if words is not None:
        return st.sampled_from([str(word) for word in words])
    if get_type_hints(law)[name] is int:
        return st.integers(int(declared.low), int(declared.high))
    if declared.unit != "-":
        return USUAL[declared.unit]
    if declared.high > 1e3:
        corners = [
            *([] if declared.open_low else [declared.low]),
            *([declared.high] if declared.high < math.inf else []),
        ]
        return decades(max(declared.low, 1e-3), min(declared.high, 1e3), *corners, far=declared.high == math.inf)
    span = declared.high - declared.low
    ends = [declared.low + span * 1e-6 if declared.open_low else declared.low]
    ends.append(declared.high - span * 1e-6 if declared.open_high else declared.high)
    inner = st.floats(0.001, 0.999).map(lambda x: float(f"{declared.low + span * x:.4g}"))
    return st.one_of(inner, inner, st.sampled_from(ends))


@st.composite
def law_keys(draw: Any, law: type[Law]) -> dict[str, Any]:
    """The keys of a link or a building that belong to its law: all it needs, and some of the others."""
    spec: dict[str, Any] = {}
    for name, declared in own_parameters(law).items():
        needed = law.parameters()[name].default is MISSING
        some(draw, spec, name, values_of(law, name, declared), 1 if needed else 3)
    if law.acts_on == "link":
        for name in set(FROM_CASE) & law.parameters().keys() & _CASE.keys():
            some(draw, spec, name, _CASE[name], 2)
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
