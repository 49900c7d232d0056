"""The columns of the tables of `pound fragility`."""

from __future__ import annotations

from pounding_cli.numbers import Unit
from pounding_cli.tables import Column

NUMBER = Unit("", 1.0, "1")

FRAGILITY_COLUMNS = (
    Column("limit", "what is passed"),
    Column("building", "building that passes it, or the pair in contact"),
    Column("outcome", "outcome of the fit"),
    Column("median", "intensity at which half of the motions pass the limit"),  # in the unit that the study decides
    Column("spread", "logarithmic standard deviation of that intensity", unit=NUMBER),
    Column("low", "the median is not below"),  # in the unit that the study decides
    Column("high", "the median is not above; inf where no end is known"),  # in the unit that the study decides
    Column("motions", "motions of the curve", unit=NUMBER),
    Column("scenes", "scenes asked for", unit=NUMBER),
    Column(
        "failed",
        "scenes that failed; they widen brackets and are counted neither as holding nor as passing",
        unit=NUMBER,
    ),
    Column(
        "undecided",
        "scenes that a collapse ended before the limit was passed or, of a cloud, whose demand is not known or has no logarithm; counted neither as holding nor as passing",
        unit=NUMBER,
    ),
    Column(
        "undecided_motions",
        "motions not known to pass, nor to hold at the highest intensities, since a collapse ended their scenes; from half of the motions on there is no curve",
        unit=NUMBER,
    ),
    Column("unfitted", "draws of the bootstrap without a fit; they count with what a fit would tend to", unit=NUMBER),
    Column("ratio", "median with pounding over median alone", unit=NUMBER),
    Column("intensity", "intensity of the motion, or of the point of the curve"),  # in the unit that the study decides
    Column(
        "held", "highest intensity below `passed` at which the motion holds; 0 where there is none"
    ),  # in the unit that the study decides
    Column(
        "passed", "lowest intensity at which the motion passes the limit; inf where there is none"
    ),  # in the unit that the study decides
    Column(
        "demand",
        "demand over limit; inf where a collapse ended the scene after the limit was passed; empty where one did before, and where the scene failed",
        unit=NUMBER,
    ),
    Column("probability", "probability that the limit is passed, at the intensity or within 50 years", unit=NUMBER),
    Column(
        "rate",
        "mean annual rate at which the limit is passed; beside a range, at these intensities",
        unit=Unit("1/year", 1.0, "1/year"),
    ),
    Column(
        "beyond", "part of the rate that comes from intensities above the last one of the hazard curve", unit=NUMBER
    ),
    Column("rate_ratio", "rate with pounding over rate alone", unit=NUMBER),
    Column("from", "lower end of a range of intensities"),  # in the unit that the study decides
    Column("to", "its upper end"),  # in the unit that the study decides
)
