"""The tables of `pound fragility` and their columns."""

from __future__ import annotations

from pounding_cli.numbers import Unit
from pounding_cli.questions.frames import PLACE_COLUMNS, PURE_NUMBER, STATE_COLUMN, list_estimate_columns
from pounding_cli.tables import Column

CURVES = "fragility"
MOTIONS = "fragility_motions"
CURVE_POINTS = "fragility_curves"
RATES = "fragility_rates"
CONTRIBUTIONS = "fragility_contributions"
"""Names of the tables; the last two where the study gives a hazard curve."""

NEIGHBOURS = "fragility_neighbours"
"""How much wider curves are over what a neighbour may be that is only seen."""

PER_YEAR = Unit("1/year", 1.0, "1/year")
PERCENT = Unit("%", 0.01, "1")


def _count(name: str, text: str) -> Column:
    """Return a column of counts."""
    return Column(name, text, PURE_NUMBER, digits=0)


CURVE_COLUMNS = (
    Column("outcome", "outcome of the fit; only `fitted` has a median and a spread"),
    *list_estimate_columns(Column("median", "median capacity: intensity at which 50 % of the motions pass the limit")),
    *list_estimate_columns(Column("spread", "standard deviation of the logarithm of the capacity", PURE_NUMBER)),
    Column("low", "lower bound of the median, whatever undecided motions would do"),
    Column("high", "upper bound of the median; inf where there is none"),
    _count("motions", "motions of the curve"),
    _count("histories", "time histories that the curve rests on"),
    _count("failed", "time histories that failed; they widen brackets and count neither as holding nor as passing"),
    _count(
        "undecided",
        "time histories that a collapse ended before the limit was passed; of a cloud also those whose demand is not "
        "known or has no logarithm; they count neither as holding nor as passing",
    ),
    _count(
        "undecided_motions",
        "motions not known to pass, nor to hold at the highest intensities, since a collapse ended their time "
        "histories; from half of the motions on there is no curve",
    ),
    _count("unfitted", "draws of the bootstrap without a fit; they count with what a fit would tend to"),
    *list_estimate_columns(Column("ratio", "median with pounding over median alone; empty alone", PURE_NUMBER)),
)

MOTION_COLUMNS = (
    Column("intensity", "intensity of the motion"),
    Column("held", "highest intensity below `passed` at which the motion holds; 0 where there is none"),
    Column("passed", "lowest intensity at which the motion passes the limit; inf where there is none"),
    Column(
        "demand",
        "demand over limit; inf where a collapse ended the time history after the limit was passed; empty where one "
        "did before, and where the time history failed",
        PURE_NUMBER,
    ),
    _count(
        "undecided",
        "time histories of the motion that a collapse ended before the limit was passed; they count neither as holding "
        "nor as passing",
    ),
)

CURVE_POINT_COLUMNS = (
    Column("intensity", "intensity of the point of the curve"),
    *list_estimate_columns(Column("probability", "probability that the limit is passed at the intensity", PURE_NUMBER)),
)

RATE_COLUMNS = (
    *list_estimate_columns(Column("rate", "mean annual rate at which the limit is passed", PER_YEAR)),
    Column("probability", "probability that the limit is passed within 50 years", PURE_NUMBER),
    Column("beyond", "part of the rate that comes from beyond the last intensity of the hazard curve", PURE_NUMBER),
    *list_estimate_columns(Column("rate_ratio", "rate with pounding over rate alone; empty alone", PURE_NUMBER)),
)

CONTRIBUTION_COLUMNS = (
    Column("from", "lower end of a range of intensities"),
    Column("to", "upper end of a range of intensities"),
    Column("rate", "part of the mean annual rate that comes from the range", PER_YEAR),
)

WIDENING_COLUMNS = (
    _count("neighbours", "number of the buildings that the neighbour may be"),
    Column("median", "median capacity over these and over the motions"),
    Column("spread", "standard deviation of the logarithm of the capacity over both", PURE_NUMBER, "β both", digits=3),
    Column("median_of_median", "median capacity with the median building", label="median, median building"),
    Column(
        "spread_of_median",
        "that standard deviation with the median building; 0 where motions do not hold above where others pass",
        PURE_NUMBER,
        "β motions",
        digits=3,
    ),
    Column(
        "widening",
        "root of the difference of the squares of both: what is added as the neighbour is only seen, or 0",
        PURE_NUMBER,
        "β neighbour",
        digits=3,
    ),
)

_KNOWN = {column.name: column for column in PLACE_COLUMNS}

CURVE_PLACES = (
    _KNOWN["case"],
    _KNOWN["analysis"],
    Column("limit", "limit that is passed"),
    Column("building", "building that passes the limit, or the pair in contact"),
    _KNOWN[STATE_COLUMN],
)
"""Columns that say in every table, behind the swept keys, where a row stands."""

COLUMNS_BY_TABLE = {
    CURVES: (*CURVE_PLACES, *CURVE_COLUMNS),
    MOTIONS: (*CURVE_PLACES, _KNOWN["record"], *MOTION_COLUMNS),
    CURVE_POINTS: (*CURVE_PLACES, *CURVE_POINT_COLUMNS),
    RATES: (*CURVE_PLACES, *RATE_COLUMNS),
    CONTRIBUTIONS: (*CURVE_PLACES, *CONTRIBUTION_COLUMNS),
    NEIGHBOURS: (*CURVE_PLACES, *WIDENING_COLUMNS),
}
"""Columns of every table, behind the swept keys."""

IN_UNIT_OF_INTENSITY = (
    "median",
    "median_low",
    "median_high",
    "median_of_median",
    "low",
    "high",
    "intensity",
    "held",
    "passed",
    "from",
    "to",
)
"""Columns whose unit the study decides."""

_NOT_OF_METHOD = {"ida": ("intensity", "demand"), "stripes": ("held", "passed"), "cloud": ("held", "passed")}
"""Columns of MOTIONS that a method does not have: `ida` has brackets of capacities, the others have demands."""


def list_columns(name: str, method: str) -> list[str]:
    """Return the names of the columns of a table, for a method."""
    left_out = _NOT_OF_METHOD[method] if name == MOTIONS else ()
    return [column.name for column in COLUMNS_BY_TABLE[name] if column.name not in left_out]
