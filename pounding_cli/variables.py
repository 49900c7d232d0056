"""Every variable of a results file, in one list: the writer, tables, units, expressions of a study, `compare`, the page
and its charts are made from it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np

SCENE_DIMS = ("case", "analysis", "record")
"""The dimensions of one scene, after the swept axes."""

BUILDING_DIMS = (*SCENE_DIMS, "building")
STOREY_DIMS = (*BUILDING_DIMS, "storey")
FLOOR_DIMS = (*BUILDING_DIMS, "floor")
LINE_DIMS = (*STOREY_DIMS, "line")
LINK_DIMS = (*SCENE_DIMS, "link")

MIN_TWIST = 1e-9
"""Rotation of a floor up to which it is rounding [rad]."""

ITSELF, NO_DIFFERENCE = "itself", "exact"
"""See `Variable.difference_scale`."""


@dataclass(frozen=True)
class Variable:
    """A data variable; the swept axes come before `dims`.

    unit : SI, "1" for a pure number, "" for text
    kind : "f" doubles (NaN where there is nothing), "i" integers, "s" text ("" where there is nothing)
    of : field of a response that it is read from, such as "building.shear"; "" where it follows from others
    alone : True for the value of the building alone, under the same motion
    ratio : (value, value of the building alone) that it is the ratio of; its statistics over the motions are kept too
    formula : the values of variables before it by name, and the heights of storeys as "height" -> its own; shapes
        (swept axes, SCENE_DIMS, its own dimensions after these), of lengths 1 where they do not change
    difference_scale : what a difference is relative to when two files are compared: ITSELF, the largest of another
        variable in the scene (of rotations of floors [rad] a length [m], as plans are wider than 1 m: twist may be
        rounding), or NO_DIFFERENCE (none is allowed); "" for one that follows from others and is not compared
    charts : charts of the page that offer it: "height" (storey by storey, link by link), "sweep"
    label : what pages and figures call it; its name unless given
    always : whether every file has it; not so where it came later, or where only some studies have it
    """

    name: str
    dims: tuple[str, ...]
    unit: str
    text: str
    kind: str = "f"
    of: str = ""
    alone: bool = False
    ratio: tuple[str, ...] = ()
    formula: Callable[[Mapping[str, np.ndarray]], np.ndarray] | None = None
    difference_scale: str = ""
    charts: tuple[str, ...] = ()
    label: str = ""
    always: bool = True


_HEIGHT, _BOTH = ("height",), ("height", "sweep")

_PlanVariable = partial(Variable, always=False)
"""A variable that only files with plans have."""

TWIST_VARIABLES = (
    _PlanVariable(
        "edge_drift_low", STOREY_DIMS, "m",
        "largest storey drift at the lower edge of the plan along the street",
        of="building.edge_drift_low", difference_scale="drift", label="drift, low edge",
    ),
    _PlanVariable(
        "edge_drift_high", STOREY_DIMS, "m",
        "largest storey drift at the upper edge of the plan along the street",
        of="building.edge_drift_high", difference_scale="drift", label="drift, high edge",
    ),
    _PlanVariable(
        "edge_drift_low0", STOREY_DIMS, "m",
        "edge_drift_low of the building alone",
        of="building.edge_drift_low", alone=True, difference_scale="drift0",
        label="drift alone, low edge",
    ),
    _PlanVariable(
        "edge_drift_high0", STOREY_DIMS, "m",
        "edge_drift_high of the building alone",
        of="building.edge_drift_high", alone=True, difference_scale="drift0",
        label="drift alone, high edge",
    ),
    _PlanVariable(
        "edge_drift", STOREY_DIMS, "m",
        "largest storey drift at either edge of the plan; that of the storey where floors do not "
        "twist",
        formula=lambda of: np.maximum(of["edge_drift_low"], of["edge_drift_high"]), charts=_BOTH,
        label="edge drift",
    ),
    _PlanVariable(
        "edge_drift0", STOREY_DIMS, "m",
        "edge_drift of the building alone",
        formula=lambda of: np.maximum(of["edge_drift_low0"], of["edge_drift_high0"]),
        label="edge drift alone",
    ),
    _PlanVariable(
        "edge_drift_ratio", STOREY_DIMS, "1",
        "edge_drift / height of the storey",
        formula=lambda of: of["edge_drift"] / of["height"], charts=_BOTH, label="edge drift ratio",
    ),
    _PlanVariable(
        "twist", FLOOR_DIMS, "rad",
        "largest rotation of the floor about the vertical, either way",
        of="building.twist", difference_scale="displacement", charts=_BOTH,
    ),
    _PlanVariable(
        "twist0", FLOOR_DIMS, "rad",
        "largest rotation of the floor of the building alone",
        of="building.twist", alone=True, difference_scale="drift0", label="twist alone",
    ),
    _PlanVariable(
        "line_V", LINE_DIMS, "N",
        "largest shear of the frame line, without damping force",
        of="line.line_shear", difference_scale="V", label="V of the line", charts=_BOTH,
    ),
    _PlanVariable(
        "line_V0", LINE_DIMS, "N",
        "largest shear of the frame line of the building alone",
        of="line.line_shear", alone=True, difference_scale="V0", label="V₀ of the line",
    ),
    _PlanVariable(
        "line_V_ratio", LINE_DIMS, "1",
        "V / V0 of the line",
        ratio=("line_V", "line_V0"), label="V/V₀ of the line", charts=_BOTH,
    ),
    _PlanVariable(
        "line_mu", LINE_DIMS, "1",
        "ductility of the frame line, largest drift over yield drift",
        of="line.line_ductility", difference_scale="mu", label="μ of the line", charts=_BOTH,
    ),
    _PlanVariable(
        "line_mu0", LINE_DIMS, "1",
        "ductility of the frame line of the building alone",
        of="line.line_ductility", alone=True, difference_scale="mu0", label="μ₀ of the line",
    ),
    _PlanVariable(
        "line_mu_ratio", LINE_DIMS, "1",
        "mu / mu0 of the line",
        ratio=("line_mu", "line_mu0"), label="μ/μ₀ of the line", charts=_BOTH,
    ),
    _PlanVariable(
        "line_drift", LINE_DIMS, "m",
        "largest storey drift at the frame line, in its plane",
        of="line.line_drift", difference_scale="drift", label="drift of the line", charts=_BOTH,
    ),
    _PlanVariable(
        "line_drift0", LINE_DIMS, "m",
        "largest storey drift at the frame line of the building alone",
        of="line.line_drift", alone=True, difference_scale="drift0",
        label="drift of the line alone",
    ),
    _PlanVariable(
        "line_drift_ratio", LINE_DIMS, "1",
        "drift of the line / height of the storey",
        formula=lambda of: of["line_drift"] / of["height"][..., None],
        label="drift ratio of the line",
    ),
    _PlanVariable(
        "line_residual_drift", LINE_DIMS, "m",
        "drift of the line at rest, long after the motion",
        of="line.line_residual_drift", difference_scale="drift",
        label="residual drift of the line",
    ),
)  # fmt: skip
"""What responses have where some building has a plan: edges, twists and frame lines."""

RESPONSE_VARIABLES = (
    Variable("V", STOREY_DIMS, "N",
             "largest storey shear, without damping force; of floors that twist that of all lines together",
             of="building.shear", difference_scale=ITSELF, charts=_BOTH),
    Variable("V0", STOREY_DIMS, "N", "largest storey shear of the building alone",
             of="building.shear", alone=True, difference_scale=ITSELF, label="V₀"),
    Variable("V_ratio", STOREY_DIMS, "1", "V / V0", ratio=("V", "V0"), charts=_BOTH, label="V/V₀"),
    Variable("mu", STOREY_DIMS, "1",
             "ductility, largest drift over yield drift; of floors that twist in the line where it is largest",
             of="building.ductility", difference_scale=ITSELF, charts=_BOTH, label="μ"),
    Variable("mu0", STOREY_DIMS, "1", "ductility of the building alone",
             of="building.ductility", alone=True, difference_scale=ITSELF, label="μ₀"),
    Variable("mu_ratio", STOREY_DIMS, "1", "mu / mu0",
             ratio=("mu", "mu0"), charts=_BOTH, label="μ/μ₀"),
    Variable("drift", STOREY_DIMS, "m", "largest storey drift; of floors that twist at their centre of mass",
             of="building.drift", difference_scale=ITSELF, charts=_BOTH),
    Variable("drift0", STOREY_DIMS, "m", "largest storey drift of the building alone",
             of="building.drift", alone=True, difference_scale=ITSELF, label="drift alone"),
    Variable("drift_ratio", STOREY_DIMS, "1", "drift / height of the storey",
             formula=lambda of: of["drift"] / of["height"], charts=_BOTH, always=False),
    Variable("residual_drift", STOREY_DIMS, "m", "storey drift at rest, long after the motion",
             of="building.residual_drift", difference_scale="drift", charts=_BOTH),
    Variable("acceleration", FLOOR_DIMS, "m/s2", "largest total floor acceleration",
             of="building.acceleration", difference_scale="acceleration", charts=_BOTH),
    Variable("acceleration0", FLOOR_DIMS, "m/s2",
             "largest total floor acceleration of the building alone",
             of="building.acceleration", alone=True, difference_scale="acceleration0", label="acceleration alone"),
    Variable("acceleration_ratio", FLOOR_DIMS, "1", "acceleration / acceleration0",
             ratio=("acceleration", "acceleration0"), charts=_BOTH, label="a/a₀"),
    Variable("displacement", FLOOR_DIMS, "m",
             "largest floor displacement relative to the ground, either way",
             formula=lambda of: np.maximum(of["displacement_max"], -of["displacement_min"]), charts=_BOTH),
    Variable("displacement_max", FLOOR_DIMS, "m", "largest floor displacement to the right",
             of="building.displacement_max", difference_scale="displacement", label="displacement, right"),
    Variable("displacement_min", FLOOR_DIMS, "m",
             "smallest floor displacement (to the left: negative)",
             of="building.displacement_min", difference_scale="displacement", label="displacement, left"),
    Variable("sway", BUILDING_DIMS, "m", "largest translation of the foundation",
             of="building.sway"),
    Variable("rocking", BUILDING_DIMS, "rad", "largest rotation of the foundation",
             of="building.rocking"),
    Variable("isolator_displacement", BUILDING_DIMS, "m",
             "largest displacement of the isolators; NaN of a base without",
             of="building.isolator_displacement", always=False),
    Variable("collapsed", BUILDING_DIMS, "1", "storey that collapsed, from 1; 0 where none did",
             kind="i", always=False),
    Variable("collapsed0", BUILDING_DIMS, "1", "likewise of the building alone",
             kind="i", alone=True, always=False),
    *TWIST_VARIABLES,
    Variable("impacts", LINK_DIMS, "1", "number of times the link closed",
             of="link.impacts", difference_scale=NO_DIFFERENCE, charts=_BOTH, label="contacts"),
    Variable("peak_force", LINK_DIMS, "N", "largest link force, along its axis where the link is inclined",
             of="link.peak_force", difference_scale="peak_force", charts=_BOTH),
    Variable("max_closing", LINK_DIMS, "m", "largest closing of the two floors, gap not subtracted",
             of="link.max_closing", difference_scale="max_closing", charts=_BOTH, label="largest closing"),
    Variable("impulse", LINK_DIMS, "N s",
             "link force summed over time, pulling negative; along its axis where the link is inclined",
             of="link.impulse", difference_scale="impulse", charts=_HEIGHT),
    Variable("contact_time", LINK_DIMS, "s", "time with a force in the link",
             of="link.contact_time", difference_scale="contact_time", charts=_HEIGHT),
    Variable("shear_below", LINK_DIMS, "N",
             "largest shear in the columns below the end of the link, such as a blow, without damping force",
             of="columns.shear_below", difference_scale=ITSELF, charts=_HEIGHT,
             label="column shear below the link", always=False),
    Variable("shear_above", LINK_DIMS, "N",
             "largest shear in the columns above the end of the link, such as a blow, without damping force",
             of="columns.shear_above", difference_scale=ITSELF, charts=_HEIGHT,
             label="column shear above the link", always=False),
    Variable("shear_demand", LINK_DIMS, "1",
             "the larger of both over the columns' share of the storey's yield shear",
             of="columns.demand", charts=_BOTH, label="column shear over strength", always=False),
)  # fmt: skip
"""Variables of responses, and those that follow from them."""

SCENE_VARIABLES = (
    Variable("status", SCENE_DIMS, "", "outcome of the scene: done, collapsed, or what stopped it",
             "s"),
    Variable("advice", SCENE_DIMS, "", "what to do about an outcome other than done", "s"),
    Variable("collapse_time", SCENE_DIMS, "s", "when a storey collapsed; NaN where none did",
             always=False),
    Variable("method", SCENE_DIMS, "", "method of solution", "s"),
    Variable("accuracy", SCENE_DIMS, "1", "accuracy asked; NaN for a method that takes a time step"),
    Variable("time_step", SCENE_DIMS, "s", "time step of a method that takes one; NaN for the others"),
    Variable("steps", SCENE_DIMS, "1", "time steps", "i"),
    Variable("events", SCENE_DIMS, "1", "events located", "i"),
    Variable("orders", SCENE_DIMS, "1", "Taylor orders computed in all", "i"),
    Variable("seconds", SCENE_DIMS, "s", "time inside the solver", label="solver time"),
    Variable("energy_residual", SCENE_DIMS, "1", "energy imbalance over the input"),
    Variable("error_estimate", SCENE_DIMS, "1",
             "numerical error of the peaks, relative: about so much at most",
             label="error"),
    Variable("sensitivity", SCENE_DIMS, "1", "change of the peaks under a small change of the motion, relative"),
    Variable("effects", SCENE_DIMS, "", "effects simulated, one a line", "s"),
    Variable("dropped", SCENE_DIMS, "", "effects left out, and links that never act, one a line", "s"),
    Variable("dropped_links", SCENE_DIMS, "", "of each of them the neighbours whose links never act", "s"),
    Variable("dropped_reasons", SCENE_DIMS, "", "the reason of each of them", "s"),
    Variable("flags", SCENE_DIMS, "", "codes of the notes that a reader of the numbers should know, one a line", "s"),
    Variable("flag_details", SCENE_DIMS, "", "of every flag where and by how much, one a line", "s"),
    Variable("flag_severity", SCENE_DIMS, "",
             "of every flag a number that is larger where it is worse, one a line", "s"),
    Variable("energy_input", SCENE_DIMS, "J", "energy put in by the ground"),
    Variable("energy_kinetic", SCENE_DIMS, "J", "kinetic energy at the end"),
    Variable("energy_stored", SCENE_DIMS, "J", "elastic energy at the end"),
    Variable("energy_damping", SCENE_DIMS, "J", "energy lost in structural damping"),
    Variable("energy_hysteresis", SCENE_DIMS, "J", "energy lost in yielding storeys"),
    Variable("energy_links", SCENE_DIMS, "J", "energy lost in links"),
    Variable("scene", SCENE_DIMS, "", "digest of the scene", "s"),
)  # fmt: skip

LINE_VARIABLES = tuple(each for each in RESPONSE_VARIABLES if each.dims == LINE_DIMS)
"""Variables of frame lines; the table of lines and expressions call them without `line_`."""

COLUMN_VARIABLES = ("left_at", "right_at", "shear_below", "shear_above", "shear_demand")
"""Names of the variables that files have where some link ends on columns."""

INCLINED_VARIABLES = ("inclination", "facing")
"""Names of the variables that files have where some link joins places of different heights."""

_WHERE = "part of the height of the storey below its floor, 1 at it"

_PLACED_VARIABLES = (
    _PlanVariable(
        "street", ("case", "link"), "m",
        "place of its left end along the street, of its right end beside a building without a plan",
    ),
    _PlanVariable(
        "left_arm", ("case", "link"), "m",
        "place of its left end along the street, from the centre of mass",
    ),
    _PlanVariable(
        "right_arm", ("case", "link"), "m",
        "place of its right end along the street, from the centre of mass",
    ),
)  # fmt: skip

PLACED_VARIABLES = tuple(each.name for each in _PLACED_VARIABLES)
"""Names of the variables of links that files have where some building has a plan."""

LINK_VARIABLES = (
    Variable("kind", ("case", "link"), "", "law of the link; empty where there is none", "s"),
    Variable("gap", ("case", "link"), "m", "initial distance of the two floors"),
    Variable("left_at", ("case", "link"), "1", f"left end: {_WHERE}", always=False),
    Variable("right_at", ("case", "link"), "1", f"right end: {_WHERE}", always=False),
    Variable("inclination", ("case", "link"), "rad",
             "angle between the link and the horizontal; its force acts along it, and force times cosine on the floors",
             always=False),
    Variable("facing", ("case", "link"), "1",
             "1 where its ends are as high as each other, within the slabs; 0 elsewhere: there it crosses no gap",
             always=False),
    *_PLACED_VARIABLES,
)  # fmt: skip

_PLAN_VARIABLES = (
    _PlanVariable(
        "plan_low", ("building",), "m",
        "lower edge of the plan along the street; NaN without a plan",
    ),
    _PlanVariable("plan_high", ("building",), "m", "upper edge of the plan along the street"),
    _PlanVariable("plan_centre", ("building",), "m", "centre of mass along the street"),
    _PlanVariable(
        "inertia", ("building", "storey"), "kg m2",
        "rotary inertia of the floor about its centre of mass",
    ),
    _PlanVariable(
        "torsional_stiffness", ("building", "storey"), "N m",
        "of the storey beside its frame lines, about the vertical",
    ),
    _PlanVariable(
        "stiffness_centre", ("building", "storey"), "m",
        "centre of stiffness along the street, of the lines along the row",
    ),
    _PlanVariable(
        "line_street", ("building", "line"), "m",
        "place of a line along the row, along the street; NaN of others",
    ),
    _PlanVariable(
        "line_x", ("building", "line"), "m",
        "place of a line across the row from the centre of mass; NaN of others",
    ),
    _PlanVariable(
        "line_stiffness", ("building", "storey", "line"), "N/m",
        "initial stiffness of a line",
    ),
    _PlanVariable("line_yield_shear", ("building", "storey", "line"), "N", "yield shear of a line"),
)  # fmt: skip

# BUILDING_VARIABLES and RECORD_VARIABLES have only those swept axes that change one of them.

BUILDING_VARIABLES = (
    Variable("mass", ("building", "storey"), "kg", "floor mass"),
    Variable("height", ("building", "storey"), "m", "storey height"),
    Variable("stiffness", ("building", "storey"), "N/m", "initial storey stiffness"),
    Variable("yield_shear", ("building", "storey"), "N", "storey yield shear"),
    Variable("period", ("building",), "s", "fundamental period on a fixed base"),
    Variable("base_shear_ratio", ("building",), "1", "yield shear of the lowest storey over the weight, V/W"),
    Variable("slab", ("building",), "m", "thickness of the floor slabs", always=False),
    *_PLAN_VARIABLES,
    Variable("separation", ("building",), "m", "separation by the code from the building to the right"),
)

RECORD_VARIABLES = (
    Variable("record_source", ("record",), "", "real, stand-in, user or the set", "s"),
    Variable("record_digest", ("record",), "", "SHA-256 of the motion as used", "s"),
    Variable("record_scale", ("record",), "1", "factor on the motion as read"),
    Variable("record_window", ("record",), "s", "duration used", label="duration"),
    Variable("record_pga", ("record",), "m/s2", "peak ground acceleration as used", label="peak"),
    Variable("record_arias", ("record",), "m/s", "Arias intensity as used", label="Arias intensity"),
)

PLAN_VARIABLES = tuple(each.name for each in _PLAN_VARIABLES)
"""Names of the variables of buildings that files have where some building has a plan."""

_STATISTICS = {
    "mean": "mean",
    "std": "standard deviation (n - 1)",
    "min": "smallest",
    "max": "largest",
    "count": "number",
    "mean_error": "numerical error of the mean",
    "mean_sensitivity": "mean relative change of the peaks under a small change of the motion",
}

STATISTIC_VARIABLES = tuple(
    Variable(
        f"{ratio.name}_{name}", ("case", "analysis", *ratio.dims[len(SCENE_DIMS) :]), "1",
        f"{words} over the records of {ratio.name}", "i" if name == "count" else "f", always=ratio.always,
    )
    for ratio in RESPONSE_VARIABLES if ratio.ratio for name, words in _STATISTICS.items()
)  # fmt: skip

DISPLAY_QUANTITIES = {
    "gap": "gap", "max_closing": "gap",
    "acceleration": "acceleration", "acceleration0": "acceleration", "record_pga": "acceleration",
}  # fmt: skip
"""Variable that people read in the unit the study writes -> its quantity in `study.display.DISPLAY_UNITS`."""

VARIABLES = {
    v.name: v
    for v in (
        *RESPONSE_VARIABLES,
        *SCENE_VARIABLES,
        *LINK_VARIABLES,
        *BUILDING_VARIABLES,
        *RECORD_VARIABLES,
        *STATISTIC_VARIABLES,
    )
}

RATIO_VARIABLES = tuple(v.name for v in RESPONSE_VARIABLES if v.ratio and v not in LINE_VARIABLES)
LINE_RATIO_VARIABLES = tuple(v.name for v in LINE_VARIABLES if v.ratio)

ALONE_VARIABLES = {
    v.name: w.name
    for v in RESPONSE_VARIABLES
    for w in RESPONSE_VARIABLES
    if v.of and v.of == w.of and w.alone and not v.alone
}
"""Variable -> the same of the building alone."""

COORDINATE_VARIABLES = {
    "case": ("", "case of the study"),
    "analysis": ("", "elastic or inelastic storeys"),
    "record": ("", "ground motion"),
    "building": ("", "building, left to right"),
    "storey": ("1", "storey, from 1 at the ground"),
    "floor": ("1", "floor, from 1 at the ground; the top of the storey of that number"),
    "line": ("1", "frame line, from 1 as the plan lists them; those across the row last"),
    "link": ("", "link between two neighbouring floors"),
    "link_left": ("", "building left of the link"),
    "link_right": ("", "building right of the link"),
    "link_floor": ("1", "floor of the link in the left building"),
    "link_right_floor": ("1", "floor of the link in the right building"),
}
"""Coordinate variables with unit and meaning; swept axes add theirs."""
