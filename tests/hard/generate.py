"""Random studies over the whole range of the schema, as hypothesis strategies that give the text of a study file."""

from __future__ import annotations

import math
from typing import Any

import yaml
from hypothesis import strategies as st

from .draw import CONTACTS, LINKS, MULTIPLE, RESTITUTION, STOREYS, decades, law_keys, own_law, some
from .make_motions import FOLDER
from .verdict import TWIST

MOTIONS = ("shake", "fine", "coarse", "spikes", "push")


SHARE = st.sampled_from([0, 1e-6, 0.01, 0.02, 0.05, 0.4, 0.9, 0.999])
HARDENING = st.sampled_from([0, 1e-9, 0.02, 0.05, 0.5, 0.999])
P_DELTA = st.sampled_from([True, True, 0, 1, 30])
"""The weight of the floors above, or so many times the weight."""

HEIGHTS = [3, 3.003, 2.997, 3.5, 4.5, [4, 3], [3, 4], [2, 2.5], 6]
"""Storey heights [m]; of a list the first is that of the lowest storey. Slabs of neighbours may be 0.1 % of a storey
apart."""

SLABS = st.sampled_from([0, 0, 0.002, 0.25, 0.9])
COLUMNS = st.sampled_from([0.2, 0.25, 1, 0.01, 1e-6])

GAP = decades(1e-6, 0.3, 0, "0 cm", 10, 1e-12, far=False)


@st.composite
def foundation(draw: Any, storey: float) -> Any:
    """A foundation whose springs are 1e-3 to 1e9 times `storey` [N/m]."""
    base: dict[str, Any] = {}
    if draw(st.booleans()):
        base |= {"sway_stiffness": storey * draw(decades(1e-3, 1e9)), "mass": draw(decades(1e-1, 1e7))}
        some(draw, base, "sway_damping", decades(1.0, 1e9, 0), 2)
    if not base or draw(st.booleans()):
        base |= {"rocking_stiffness": storey * draw(decades(1e-2, 1e10)), "inertia": draw(decades(1.0, 1e9))}
        some(draw, base, "rocking_damping", decades(1.0, 1e10, 0), 2)
    return base


@st.composite
def building(draw: Any) -> dict[str, Any]:
    """One building type."""
    n = draw(st.sampled_from([1, 1, 2, 2, 3, 3, 4, 5, 8, 13]))
    mass = draw(decades(2e3, 2e7, 20.0, 2e9))
    spec: dict[str, Any] = {"storeys": n, "mass": mass}
    period = draw(decades(0.05, 3.0, 0.01, 0.36, 60, far=False))
    storey = mass * (2 * math.pi / period) ** 2 * max(1.0, 0.4 * n * n)
    if draw(st.integers(1, 4)) == 1:
        spec["stiffness"] = [storey * draw(decades(0.1, 10, far=False)) for _ in range(n)]
    else:
        spec["period"] = period
        some(draw, spec, "taper", decades(1e-2, 10, 1, far=False))
    some(draw, spec, "damping", SHARE, 2)
    if draw(st.integers(1, 8)) == 1:
        spec.pop("damping", None)
        spec["rayleigh"] = {"alpha": draw(decades(1e-2, 10, 0)), "beta": draw(decades(1e-5, 1e-2, 0))}
    some(draw, spec, "hardening", HARDENING, 2)
    if draw(st.integers(1, 3)) == 1:
        strength = draw(decades(1e-4, 1.0, far=False))
        spec["yield_shear"] = draw(st.sampled_from(["never", [strength * mass * 10 * (n - j) for j in range(n)]]))
    law = draw(st.sampled_from(["bilinear", *STOREYS]))
    spec |= {"storey_law": law} | draw(law_keys(STOREYS[law]))
    some(draw, spec, "p_delta", P_DELTA.map(lambda p: p if p is True else [p * mass * 10 * (n - j) for j in range(n)]))
    some(draw, spec, "collapse", decades(1e-3, 0.5, "never", 1, 1e-6, far=False), 4)
    if draw(st.integers(1, 4)) == 1:
        spec["foundation"] = draw(foundation(storey))
    return spec


JOINTS = ("connector", "damper", "viscous", "maxwell", "friction")
"""Links that may end anywhere, level or inclined."""

ENDS = ([1, "0 + 40 %"], ["0 + 0.1 %", 1], [1, "0 + 99.99 %"], [1, 1])
"""A floor and columns of the lowest storey, and floors that may not line up."""


@st.composite
def link(draw: Any, own: dict[str, Any]) -> dict[str, Any]:
    """One link of any law: of the program, or of `own`, those of the study."""
    name = draw(st.sampled_from(["pounding", "infill", *LINKS, *own]))
    return {"link": name} | draw(law_keys(LINKS.get(name, ({}, {}))))


@st.composite
def case(draw: Any, storeys: int, own: dict[str, Any], uneven: bool) -> dict[str, Any]:
    """What stands between the buildings; between slabs and columns too where floors may not line up (`uneven`)."""
    kind = draw(st.integers(1, 12))
    if kind == 1:
        return {"link": "none"}
    links = draw(st.lists(link(own), min_size=1, max_size=3 if kind <= 4 else 1))
    for one in links[:1]:
        some(draw, one, "floors", st.sampled_from([1, [1], [storeys], {"except": [1]}]))
    if draw(st.integers(1, 3)) == 1:
        links.append(draw(link(own) | st.just({"link": "none"})) | {"floors": "rest"})
    if uneven:
        other = GAP.map(lambda gap: {"link": "pounding", "gap": gap})
        links.append(
            draw(st.one_of(st.sampled_from([{"link": "pounding"}, {"link": "none"}]), other)) | {"at": "columns"}
        )
        if draw(st.booleans()):
            joint = draw(st.sampled_from(JOINTS))
            place = {"floors": [draw(st.sampled_from(ENDS))], "gap": 0.01}
            some(draw, place, "distance", decades(0.05, 50.0, far=False))
            links.append({"link": joint} | draw(law_keys(LINKS[joint])) | place)
    gap = {"gap": draw(GAP)}
    return gap | links[0] if len(links) == 1 else gap | {"links": links}


@st.composite
def studies(draw: Any) -> str:
    """The text of a study file: a few scenes each."""
    uneven = draw(st.integers(1, 4)) == 1
    types = {name: draw(building()) for name in ("a", "b", "c")[: draw(st.integers(2 if uneven else 1, 3))]}
    heights = draw(st.permutations(HEIGHTS)) if uneven else ()
    for spec, height in zip(types.values(), heights, strict=False):
        above = spec["storeys"] - 1
        spec["height"] = [height[0], *[height[1]] * above] if isinstance(height, list) else height
        spec |= {"slab": draw(SLABS), "columns": draw(COLUMNS)}
    group = draw(st.lists(st.sampled_from(list(types)), min_size=2, max_size=draw(st.sampled_from([2, 2, 2, 3, 5]))))
    if uneven:
        group[:2] = "a", "b"
    own = {f"law {i}": draw(own_law()) for i in range(draw(st.sampled_from([0, 0, 0, 1, 2])))}
    study: dict[str, Any] = {
        "records": {
            "use": [{"file": str(FOLDER / f"{draw(st.sampled_from(MOTIONS))}.txt")}],
            "duration": draw(decades(0.2, 1.0, "whole", far=False)),
        },
        "buildings": {name: types[name] for name in dict.fromkeys(group)},
        "group": group,
        "cases": {f"case {i}": draw(case(1, own, uneven)) for i in range(draw(st.integers(1, 4)))},
        "accuracy": draw(st.sampled_from([1e-6, 1e-6, 1e-6, 1e-3, 1e-9, 1e-12, 0.1, 1e-14])),
    }
    scale = st.one_of(decades(0.01, 10, 1e-6, 1e6, far=False), st.sampled_from([{"pga": "5 g"}, {"pga": "0.3 g"}]))
    some(draw, study["records"], "scale", scale, 2)
    if own:
        study["laws"] = own
    impact: dict[str, Any] = {}
    if draw(st.integers(1, 4)) == 1:
        law = draw(st.sampled_from(CONTACTS))
        impact |= {"law": law} | draw(law_keys(LINKS.get(law, ({}, {}))))
    some(draw, impact, "stiffness", MULTIPLE, 2)
    some(draw, impact, "restitution", RESTITUTION, 2)
    some(draw, impact, "tension_cut", st.booleans())
    some(draw, impact, "dashpot", st.sampled_from(["reduced-mass", "printed"]), 6)
    if impact:
        study["impact"] = impact
    some(draw, study, "tail", decades(0.01, 0.5, 0, far=False), 6)
    twist = f"{TWIST}{draw(st.integers(0, 10**6))}\n" if draw(st.integers(1, 2)) == 1 else ""
    return twist + yaml.safe_dump(study, sort_keys=False, width=120)
