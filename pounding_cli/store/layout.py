"""Every variable of a results file: dimensions, unit and meaning, in one list for writer, reader and docs."""

from __future__ import annotations

from dataclasses import dataclass

PLACE = ("case", "analysis", "record")
"""The dimensions of one scene, after the swept axes."""

STOREY = (*PLACE, "building", "storey")
FLOOR = (*PLACE, "building", "floor")
LINK = (*PLACE, "link")


@dataclass(frozen=True)
class Variable:
    """A data variable; the swept axes come before `dims`.

    unit : SI, "1" for a pure number, "" for text
    kind : "f" doubles (NaN where there is nothing), "i" integers, "s" text ("" where there is nothing)
    """

    name: str
    dims: tuple[str, ...]
    unit: str
    text: str
    kind: str = "f"


RESPONSES = (
    Variable("V", STOREY, "N", "largest storey shear, without damping force"),
    Variable("V0", STOREY, "N", "largest storey shear of the building alone"),
    Variable("V_ratio", STOREY, "1", "V / V0"),
    Variable("mu", STOREY, "1", "ductility, largest drift over yield drift"),
    Variable("mu0", STOREY, "1", "ductility of the building alone"),
    Variable("mu_ratio", STOREY, "1", "mu / mu0"),
    Variable("drift", STOREY, "m", "largest storey drift"),
    Variable("drift0", STOREY, "m", "largest storey drift of the building alone"),
    Variable("residual_drift", STOREY, "m", "storey drift at the end"),
    Variable("acceleration", FLOOR, "m/s2", "largest total floor acceleration"),
    Variable("acceleration0", FLOOR, "m/s2", "largest total floor acceleration of the building alone"),
    Variable("acceleration_ratio", FLOOR, "1", "acceleration / acceleration0"),
    Variable("displacement", FLOOR, "m", "largest floor displacement relative to the ground, either way"),
    Variable("displacement_max", FLOOR, "m", "largest floor displacement to the right"),
    Variable("displacement_min", FLOOR, "m", "smallest floor displacement (to the left: negative)"),
    Variable("sway", (*PLACE, "building"), "m", "largest translation of the foundation"),
    Variable("rocking", (*PLACE, "building"), "rad", "largest rotation of the foundation"),
    Variable("collapsed", (*PLACE, "building"), "1", "storey that collapsed, from 1; 0 where none did", "i"),
    Variable("collapsed0", (*PLACE, "building"), "1", "likewise of the building alone", "i"),
    Variable("impacts", LINK, "1", "number of times the link closed"),
    Variable("peak_force", LINK, "N", "largest link force"),
    Variable("max_closing", LINK, "m", "largest closing of the two floors, gap not subtracted"),
    Variable("impulse", LINK, "N s", "link force summed over time, pulling negative"),
    Variable("contact_time", LINK, "s", "time with a force in the link"),
    Variable("shear_below", LINK, "N", "largest shear in the struck columns below the blow, without damping force"),
    Variable("shear_above", LINK, "N", "largest shear in the struck columns above the blow, without damping force"),
    Variable("shear_demand", LINK, "1", "the larger of both over the columns' share of the storey's yield shear"),
)

SCENES = (
    Variable("status", PLACE, "", "outcome of the scene: done, collapsed, or what stopped it", "s"),
    Variable("advice", PLACE, "", "what to do about an outcome other than done", "s"),
    Variable("method", PLACE, "", "method of solution, of a row that fell into groups theirs", "s"),
    Variable("accuracy", PLACE, "1", "accuracy asked; NaN for a method that takes a time step"),
    Variable("time_step", PLACE, "s", "time step of a method that takes one; NaN for the others"),
    Variable("collapse_time", PLACE, "s", "when a storey collapsed; NaN where none did"),
    Variable("steps", PLACE, "1", "time steps", "i"),
    Variable("events", PLACE, "1", "events located", "i"),
    Variable("orders", PLACE, "1", "Taylor orders computed in all", "i"),
    Variable("seconds", PLACE, "s", "time inside the solver"),
    Variable("energy_residual", PLACE, "1", "energy not accounted for, over the input"),
    Variable("energy_input", PLACE, "J", "energy put in by the ground"),
    Variable("energy_kinetic", PLACE, "J", "kinetic energy at the end"),
    Variable("energy_stored", PLACE, "J", "elastic energy at the end"),
    Variable("energy_damping", PLACE, "J", "energy lost in structural damping"),
    Variable("energy_hysteresis", PLACE, "J", "energy lost in yielding storeys"),
    Variable("energy_links", PLACE, "J", "energy lost in links"),
    Variable("error_estimate", PLACE, "1", "numerical error of the peaks, relative: about so much at most"),
    Variable("sensitivity", PLACE, "1", "change of the peaks under a small change of the motion, relative"),
    Variable("effects", PLACE, "", "effects simulated, one a line", "s"),
    Variable("dropped", PLACE, "", "effects left out with the reason, one a line", "s"),
    Variable("flags", PLACE, "", "what a reader of the numbers should know, one a line", "s"),
    Variable("scene", PLACE, "", "digest of the scene", "s"),
)

FORMERLY = {"accuracy": "tolerance", "time_step": "tolerance"}
"""What files of before call a variable: accuracy or time step were one, the study says which."""

OF_COLUMNS = ("left_at", "right_at", "shear_below", "shear_above", "shear_demand")
"""What files have where some link strikes columns."""

ADDED = ("collapsed", "collapsed0", "collapse_time", "slab", *OF_COLUMNS)
"""What files of before, or of other studies, do not have."""

# The variables of BUILDINGS and RECORDS have only those swept axes that change one of them.

LINKS = (
    Variable("kind", ("case", "link"), "", "law of the link; empty where there is none", "s"),
    Variable("gap", ("case", "link"), "m", "initial distance of the two floors"),
    Variable("left_at", ("case", "link"), "1", "left end: part of the height of the storey below its floor, 1 at it"),
    Variable("right_at", ("case", "link"), "1", "right end: part of the height of the storey below its floor, 1 at it"),
)

BUILDINGS = (
    Variable("mass", ("building", "storey"), "kg", "floor mass"),
    Variable("height", ("building", "storey"), "m", "storey height"),
    Variable("stiffness", ("building", "storey"), "N/m", "initial storey stiffness"),
    Variable("yield_shear", ("building", "storey"), "N", "storey yield shear"),
    Variable("period", ("building",), "s", "fundamental period on a fixed base"),
    Variable("base_shear_ratio", ("building",), "1", "yield shear of the lowest storey over the weight, V/W"),
    Variable("slab", ("building",), "m", "thickness of the floor slabs"),
    Variable("separation", ("building",), "m", "separation by the code from the building to the right"),
)

RECORDS = (
    Variable("record_source", ("record",), "", "real, stand-in or user", "s"),
    Variable("record_digest", ("record",), "", "SHA-256 of the motion as used", "s"),
    Variable("record_scale", ("record",), "1", "factor on the motion as read"),
    Variable("record_window", ("record",), "s", "duration used"),
    Variable("record_pga", ("record",), "m/s2", "peak ground acceleration as used"),
    Variable("record_arias", ("record",), "m/s", "Arias intensity as used"),
)

STATISTICS = tuple(
    Variable(
        f"{ratio}_{statistic}",
        ("case", "analysis", "building", level),
        "1",
        f"{words} over the records of {ratio}",
        "i" if statistic == "count" else "f",
    )
    for ratio, level in (("V_ratio", "storey"), ("mu_ratio", "storey"), ("acceleration_ratio", "floor"))
    for statistic, words in (
        ("mean", "mean"),
        ("std", "standard deviation (n - 1)"),
        ("min", "smallest"),
        ("max", "largest"),
        ("count", "number"),
        ("mean_error", "numerical error of the mean"),
        ("mean_sensitivity", "mean relative change of the peaks under a small change of the motion"),
    )
)

WRITTEN = {
    "gap": "gap", "max_closing": "gap",
    "acceleration": "acceleration", "acceleration0": "acceleration", "record_pga": "acceleration",
}  # fmt: skip
"""Variables that people read in the unit the study writes, and the quantity of `study.written.PLACES` they are."""

VARIABLES = {v.name: v for v in (*RESPONSES, *SCENES, *LINKS, *BUILDINGS, *RECORDS, *STATISTICS)}

COORDINATES = {
    "case": ("", "case of the study"),
    "analysis": ("", "elastic or inelastic storeys"),
    "record": ("", "ground motion"),
    "building": ("", "building, left to right"),
    "storey": ("1", "storey, from 1 at the ground"),
    "floor": ("1", "floor, from 1 at the ground; the top of the storey of that number"),
    "link": ("", "link between two neighbouring floors"),
    "link_left": ("", "building left of the link"),
    "link_right": ("", "building right of the link"),
    "link_floor": ("1", "floor of the link in the left building"),
    "link_right_floor": ("1", "floor of the link in the right building"),
}
"""Coordinate variables with unit and meaning; swept axes add theirs."""
