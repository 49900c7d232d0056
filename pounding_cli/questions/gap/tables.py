"""The tables of `pound gap` and their columns."""

from __future__ import annotations

from collections.abc import Sequence

from pounding_cli.numbers import Unit
from pounding_cli.questions.bootstrap import MIN_MOTIONS
from pounding_cli.questions.frames import PURE_NUMBER, list_estimate_columns
from pounding_cli.tables import Column
from pounding_cli.variables import COORDINATE_VARIABLES

GAP_TABLE = "gap"
"""What two floors that face each other require, over the motions."""

CASES_TABLE = "gap_cases"
"""Whether the gaps of the cases are enough."""

LINE_TABLE = "property_line"
"""How far every floor moves towards a property line, over the motions."""

CODES_TABLE = "gap_codes"
"""What the gaps of codes are worth."""

RATE_TABLE = "gap_rate"
"""The gap for an annual rate of contact."""

NEIGHBOURS_TABLE = "gap_neighbours"
"""What two buildings require, over what a neighbour that is only seen may be and over the motions."""

NEIGHBOUR_CASES_TABLE = "gap_neighbour_cases"
"""How likely the gaps of the cases are enough, over both."""

EXACT = "exact"
"""Rule of what the motions require: the largest closing over time, located within the step that it lies in."""

MOTION_RULES = (EXACT, "ABS", "SRSS", "DDC")
"""Rules that depend on the motions."""

FACING_KEYS = ("left", "right", "floor", "right_floor", "columns")
"""Columns that say which floors face each other."""

LOW_END = "low end"
HIGH_END = "high end"
"""Ends along the street of the edge that two floors share, or of the side of a floor."""

YES = "yes"
NO = "no"
UNKNOWN = "unknown"
"""Values of the column `enough`."""

GAP_CONFIDENCE = 0.90
"""Confidence of the intervals [-]."""

NEIGHBOUR_SHARES = (0.50, 0.84, 0.95)
"""Probabilities for which a gap beside a neighbour that is only seen is told [-]."""

METRES = Unit("m", 1.0, "m")


def name_enough(share: float) -> str:
    """Return the column of the gap that is enough with a probability: "enough_84"."""
    return f"enough_{100 * share:.0f}"


_ANALYSIS = Column("analysis", COORDINATE_VARIABLES["analysis"][1])
_RULE = Column("rule", "exact, or the name of the rule")
_LEFT = Column("left", "building left of the gap")
_RIGHT = Column("right", "building right of the gap")

FACING_COLUMNS = (
    _LEFT,
    _RIGHT,
    Column("floor", "floor of the left building", PURE_NUMBER, digits=0),
    Column("right_floor", "floor of the right building", PURE_NUMBER, "floor right", digits=0),
    Column(
        "columns",
        "building whose columns or walls, in the storey below its floor, a slab of the other faces: left or right; "
        "empty where two slabs face each other",
    ),
    Column("end", "of floors that twist, the end of the edge that they share, or another place; empty of others"),
    Column("street", "of floors that twist, place along the street; NaN of others", METRES),
)

STATISTIC_COLUMNS = (
    Column("motions", "number of motions behind the row; 0 where the rule depends on none", PURE_NUMBER, digits=0),
    Column("mean", "mean over the motions", METRES),
    Column("std", "standard deviation over the motions (n - 1)", METRES, "σ"),
    Column("mean_plus_std", "mean plus one standard deviation", METRES, "mean + σ"),
    Column("largest", "largest of the motions", METRES),
    Column("median", "median of the lognormal fit", METRES),
    Column("dispersion", "standard deviation of the logarithm (n - 1)", PURE_NUMBER),
    Column(
        "error",
        "largest numerical error of a motion's separation; no statistic but those of the fit exceeds it",
        METRES,
        digits=2,
    ),
    Column("over_exact", "mean over the mean of the exact separations", PURE_NUMBER, "mean over exact"),
)

GAP_COLUMNS = (
    _ANALYSIS,
    *FACING_COLUMNS,
    Column("height", "height of the slab above the ground", METRES),
    _RULE,
    *STATISTIC_COLUMNS,
)
"""Columns of GAP_TABLE, besides those of `list_share_columns`."""

LINE_COLUMNS = (
    _ANALYSIS,
    Column("building", COORDINATE_VARIABLES["building"][1]),
    Column("side", "side of the building that faces the line: left or right"),
    Column("floor", COORDINATE_VARIABLES["floor"][1], PURE_NUMBER, digits=0),
    Column("end", "of a floor that twists, the end of its side along the street; empty of others"),
    Column("street", "of a floor that twists, place along the street; NaN of others", METRES),
    Column("height", "height of the floor above the ground", METRES),
    _RULE,
    *STATISTIC_COLUMNS,
)
"""Columns of LINE_TABLE, besides those of `list_share_columns`."""

CASES_COLUMNS = (
    Column("case", COORDINATE_VARIABLES["case"][1]),
    _ANALYSIS,
    *FACING_COLUMNS,
    Column("gap", "gap of the case at the governing floors", METRES),
    _RULE,
    Column("required", "gap required by the rule at the governing floors, the largest of the motions", METRES),
    Column(
        "enough",
        "whether the gap is wide enough at all floors of the pair, under all motions; unknown where runs failed",
    ),
    Column("enough_for", "motions for which it is; 0 of a rule that depends on none", PURE_NUMBER, digits=0),
    Column("motions", "motions whose runs did not fail; 0 of a rule that depends on none", PURE_NUMBER, digits=0),
)
"""Columns of CASES_TABLE. The governing floors lack most, or have least to spare."""

GAP_RATE_COLUMNS = (
    _ANALYSIS,
    _LEFT,
    _RIGHT,
    Column("motions", "motions at every intensity", PURE_NUMBER, digits=0),
    Column("intensities", "number of intensities", PURE_NUMBER, digits=0),
    Column("rate", "annual rate of contact that is allowed", Unit("1/year", 1.0, "1/year")),
    Column("probability", "probability of contact within 50 years at this rate", PURE_NUMBER),
    *list_estimate_columns(
        Column("gap", "gap with this rate of contact at any floor of the pair", METRES, digits=3), "bootstrap interval"
    ),
)
"""Columns of RATE_TABLE."""

CODES_COLUMNS = (
    _ANALYSIS,
    _LEFT,
    _RIGHT,
    Column("rule", "name of the code"),
    Column("gap", "gap of the code, the largest of all floors of the pair", METRES),
    Column("motions", "motions whose runs did not fail", PURE_NUMBER, digits=0),
    Column("closed", "motions that close this gap at some floor", PURE_NUMBER, digits=0),
    *list_estimate_columns(
        Column(
            "probability",
            "probability of contact at some floor at this gap, by a lognormal fit to the motions",
            Unit("%", 0.01, "1"),
            "contact",
            digits=2,
        ),
        f"{100 * GAP_CONFIDENCE:.0f} % confidence interval, from {MIN_MOTIONS} motions on",
    ),
    *list_estimate_columns(
        Column(
            "rate", "annual rate of contact at this gap, with a hazard curve", Unit("%/year", 0.01, "1/year"), digits=2
        ),
        "bootstrap interval",
    ),
)
"""Columns of CODES_TABLE."""

_DRAWN_COLUMNS = (
    Column("neighbours", "number of the buildings that the neighbour may be", PURE_NUMBER, digits=0),
    Column("motions", "number of the motions", PURE_NUMBER, digits=0),
    Column("failed", "runs that failed, of all neighbours and motions; they are left out", PURE_NUMBER, digits=0),
)

_DRAWN_INTERVAL = f"{100 * GAP_CONFIDENCE:.0f} % interval, a bootstrap over both, from {MIN_MOTIONS} motions on"

NEIGHBOUR_COLUMNS = (
    _ANALYSIS,
    _LEFT,
    _RIGHT,
    *_DRAWN_COLUMNS,
    *(
        column
        for share in NEIGHBOUR_SHARES
        for column in list_estimate_columns(
            Column(
                name_enough(share),
                f"gap that is enough with a probability of {100 * share:.0f} % over what the neighbour may be and over "
                "the motions, at all floors of the pair",
                METRES,
                f"enough {100 * share:.0f} %",
                digits=3,
            ),
            _DRAWN_INTERVAL,
        )
    ),
    Column(
        "spread_motions",
        "standard deviation of the logarithm of the required gap over the motions, mean square of all neighbours",
        PURE_NUMBER,
        "β motions",
        digits=2,
    ),
    Column(
        "spread_neighbours",
        "that of the means of all neighbours: what is added as the neighbour is only seen",
        PURE_NUMBER,
        "β neighbour",
        digits=2,
    ),
    Column("spread", "that over both, the root of the sum of the squares", PURE_NUMBER, "β both", digits=2),
)
"""Columns of NEIGHBOURS_TABLE."""

NEIGHBOUR_CASES_COLUMNS = (
    Column("case", COORDINATE_VARIABLES["case"][1]),
    _ANALYSIS,
    _LEFT,
    _RIGHT,
    Column("gap", "smallest gap of the case between the pair", METRES),
    *list_estimate_columns(
        Column(
            "enough",
            "probability that the gaps are enough at all floors of the pair, over what the neighbour may be and over "
            "the motions",
            PURE_NUMBER,
            "enough with",
            digits=2,
        ),
        _DRAWN_INTERVAL,
    ),
    *list_estimate_columns(
        Column(
            "rate", "annual rate of contact at this gap, with a hazard curve", Unit("%/year", 0.01, "1/year"), digits=2
        ),
        "bootstrap interval",
    ),
    *_DRAWN_COLUMNS,
)
"""Columns of NEIGHBOUR_CASES_TABLE."""

COLUMNS_BY_TABLE = {
    GAP_TABLE: GAP_COLUMNS,
    CASES_TABLE: CASES_COLUMNS,
    CODES_TABLE: CODES_COLUMNS,
    LINE_TABLE: LINE_COLUMNS,
    RATE_TABLE: GAP_RATE_COLUMNS,
    NEIGHBOURS_TABLE: NEIGHBOUR_COLUMNS,
    NEIGHBOUR_CASES_TABLE: NEIGHBOUR_CASES_COLUMNS,
}
"""Columns of every table; those of `list_share_columns` and of swept keys depend on the study."""


def name_percentile(share: float) -> str:
    """Return the column of a percentile over the motions: "percentile_84"."""
    return f"percentile_{100 * share:g}"


def name_contact(probability: float) -> str:
    """Return the column of the gap for a probability of contact: "contact_10"."""
    return f"contact_{100 * probability:g}"


def list_share_columns(table: str, percentiles: Sequence[float], contact: Sequence[float]) -> list[Column]:
    """Return the columns of GAP_TABLE or LINE_TABLE that a study decides.

    percentiles : shares of the motions [-]
    contact : probabilities that floors touch, or that a floor reaches the line [-]
    """
    event = "reached" if table == LINE_TABLE else "contact"
    meaning = "distance that the floor reaches" if table == LINE_TABLE else "gap"
    of_contact = "" if table == LINE_TABLE else " of contact"
    columns = [
        Column(
            name_percentile(share), f"{100 * share:g} % of the motions need no more, interpolated", METRES,
            f"{100 * share:g} %",
        )
        for share in percentiles
    ]  # fmt: skip
    interval = f"{100 * GAP_CONFIDENCE:.0f} % confidence interval, from {MIN_MOTIONS} motions on"
    for share in contact:
        text = f"{meaning} with a probability{of_contact} of {100 * share:g} % by the lognormal fit"
        column = Column(name_contact(share), text, METRES, f"{event} {100 * share:g} %", digits=3)
        columns += list_estimate_columns(column, interval)
    return columns


def is_length(column: Column) -> bool:
    """Return whether people read a column in the unit that the study writes gaps in."""
    return column.unit.si == METRES.si and column.name not in ("height", "street")
