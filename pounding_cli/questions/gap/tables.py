"""The columns of the tables of `pound gap`."""

from __future__ import annotations

from pounding_cli.numbers import Unit
from pounding_cli.tables import Column

NUMBER = Unit("", 1.0, "1")

GAP_COLUMNS = (
    Column("left", "building left of the gap"),
    Column("right", "building right of the gap"),
    Column("floor", "floor, of the left building where two face each other", unit=NUMBER),
    Column("right_floor", "floor of the right building", unit=NUMBER),
    Column(
        "columns",
        "building whose columns, in the storey below its floor, a slab of the other faces: left or right; empty where two slabs face each other",
    ),
    Column("side", "of the building that faces the line"),
    Column("height", "of the slabs, or the floor, above the ground", unit=Unit("m", 1.0, "m")),
    Column("rule", "exact, or the rule"),
    Column("motions", "number of motions behind the row; 0 where the rule depends on none", unit=NUMBER),
    Column("mean", "mean over the motions", unit=Unit("m", 1.0, "m")),
    Column("std", "standard deviation over the motions (n - 1)", unit=Unit("m", 1.0, "m")),
    Column("mean_plus_std", "mean plus one standard deviation", unit=Unit("m", 1.0, "m")),
    Column("largest", "largest of the motions", unit=Unit("m", 1.0, "m")),
    Column("median", "median of the lognormal fit", unit=Unit("m", 1.0, "m")),
    Column("dispersion", "standard deviation of the logarithm (n - 1)", unit=NUMBER),
    Column(
        "error",
        "largest numerical error of a motion's separation; no statistic but those of the fit exceeds it",
        unit=Unit("m", 1.0, "m"),
    ),
    Column("over_exact", "mean over the mean of the exact separations", unit=NUMBER),
    Column("gap", "of the case at these floors", unit=Unit("m", 1.0, "m")),
    Column(
        "required",
        "by the rule at these floors, which lack most or have least to spare; largest of the motions",
        unit=Unit("m", 1.0, "m"),
    ),
    Column(
        "enough",
        "whether the gap is wide enough at all floors of the pair, under all motions; unknown where scenes failed",
    ),
    Column("enough_for", "motions for which it is", unit=NUMBER),
)

GAP_RATE_COLUMNS = (
    Column("analysis", "elastic or inelastic storeys"),
    Column("left", "building left of the gap"),
    Column("right", "building right of the gap"),
    Column("motions", "motions at every intensity", unit=NUMBER),
    Column("intensities", "intensities", unit=NUMBER),
    Column("rate", "annual rate of contact that is allowed", unit=Unit("1/year", 1.0, "1/year")),
    Column("probability", "probability of contact within 50 years at this rate", unit=NUMBER),
    Column("gap", "gap with this rate of contact at any floor of the pair", unit=Unit("m", 1.0, "m")),
    Column("gap_low", "lower end of its bootstrap interval", unit=Unit("m", 1.0, "m")),
    Column("gap_high", "upper end of its bootstrap interval", unit=Unit("m", 1.0, "m")),
)
