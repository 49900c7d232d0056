"""Every number of a point of `pound wall`: dimensions, unit, meaning, and where in its response or model it stands."""

from __future__ import annotations

from pounding_cli.variables import Variable

_HISTORY, _CELL, _ROW, _ELEMENT, _NODE = ("instant",), ("cell",), ("row",), ("element",), ("node", "component")

VARIABLES = (
    Variable("peak_force", (), "N", "largest contact force"),
    Variable("peak_time", (), "s", "time of the largest contact force"),
    Variable("separation", (), "s", "first time the striker leaves the wall"),
    Variable("last_contact", (), "s", "last time the striker pushes"),
    Variable("impulse", (), "N s", "impulse of the contact force"),
    Variable("momentum_residual", (), "1", "impulse less the striker's change of momentum, over its first momentum"),
    Variable("energy_residual", (), "1", "largest open part of the energy balance, over the first energy"),
    Variable("wall_stress", (), "N/m2", "largest von Mises stress of an element"),
    Variable("averaged_stress", (), "N/m2", "largest von Mises stress averaged over the stated length"),
    Variable("beam_stress", (), "N/m2", "largest edge stress of the beams"),
    Variable("column_stress", (), "N/m2", "largest edge stress of the columns"),
    Variable("beam_stress_then", (), "N/m2", "largest edge stress of the beams at the instant of the wall's peak"),
    Variable("column_stress_then", (), "N/m2", "largest edge stress of the columns at the instant of the wall's peak"),
    Variable("wall_shear", (), "N", "largest shear force in a cross-section of the wall"),
    Variable("wall_moment", (), "N m", "largest bending moment in a cross-section of the wall"),
    Variable("reach", (), "m", "farthest from the contact that the averaged stress exceeds half its largest"),
    Variable("stressed_share", (), "1", "share of the wall's area stressed above a tenth of the averaged stress"),
    Variable("step", (), "s", "time step"),
    Variable("freedoms", (), "1", "degrees of freedom"),
    Variable("averaged_over", (), "m", "length over which stress is averaged", of="model.averaging_length"),
    Variable("wall_length", (), "m", "length of the wall", of="model.length"),
    Variable("time_of_peak", (), "s", "instant of the largest stress of an element", of="fields.time_of_peak"),
    Variable("contact", ("end",), "m", "heights between which the striker pushes", of="model.patch"),
    Variable("floors", ("floor",), "m", "heights of the floors", of="model.frame.floors"),
    Variable("time", _HISTORY, "s", "time", of="transient.time"),
    Variable("force", _HISTORY, "N", "contact force", of="transient.force"),
    Variable("velocity", _HISTORY, "m/s", "velocity of the striker", of="transient.velocity"),
    Variable("position", _HISTORY, "m", "displacement of the striker", of="transient.position"),
    Variable("indentation", _HISTORY, "m", "displacement of the wall under the striker", of="transient.indentation"),
    Variable("striker_energy", _HISTORY, "J", "kinetic energy of the striker", of="transient.striker_energy"),
    Variable("kinetic_energy", _HISTORY, "J", "kinetic energy of wall and frame", of="transient.kinetic_energy"),
    Variable("strain_energy", _HISTORY, "J", "strain energy of wall and frame", of="transient.strain_energy"),
    Variable("cell_height", _CELL, "m", "height of a cell over which stress is averaged, at the struck face"),
    Variable("cell_stress", _CELL, "N/m2", "largest von Mises stress of the mean stress in a cell"),
    Variable("row_height", _ROW, "m", "height of a cross-section of the wall"),
    Variable("normal", _ROW, "N", "largest normal force in a cross-section"),
    Variable("shear", _ROW, "N", "largest shear force in a cross-section"),
    Variable("moment", _ROW, "N m", "largest bending moment in a cross-section"),
    Variable("points", _NODE, "m", "corner points of the mesh", of="fields.points"),
    Variable("displacement", _NODE, "m", "displacement of the points at `time_of_peak`", of="fields.displacement"),
    Variable("quads", ("element", "corner"), "1", "points of a quadrilateral, from 0", "i", of="fields.quads"),
    Variable("stress_peak", _ELEMENT, "N/m2", "von Mises stress at `time_of_peak`", of="fields.stress_peak"),
    Variable("stress_envelope", _ELEMENT, "N/m2", "largest von Mises stress over time", of="fields.stress_envelope"),
)
"""Those without dimensions are numbers of the table `wall`."""
