"""The table of `pound screen` and its columns."""

from __future__ import annotations

from pounding_cli.numbers import Unit
from pounding_cli.questions.frames import PURE_NUMBER, list_estimate_columns
from pounding_cli.tables import Column

SCREEN_TABLE = "screen"
"""Pairs of neighbours, those that strike most often first."""

SHARES_TABLE = "screen_shares"
"""What decides about every pair: shares of the variance of the closings."""

RETURN_PERIOD = 475.0
"""Return period of the intensity at which the probability that a gap is enough is told [years]."""

MIN_SCREENED_GAP = 1e-3
"""Gap for which a smaller one is taken [m]: what touches is in contact in every earthquake."""

_RATE = Unit("1/year", 1.0, "1/year")
_LENGTH = Unit("cm", 0.01, "m")
_HEIGHT = Unit("m", 1.0, "m")
_ACCELERATION = Unit("g", 9.80665, "m/s2")


def _list_building_columns(side: str) -> list[Column]:
    """Return the columns of one of the two buildings."""
    return [
        Column(side, f"building at the {side}: type and storeys"),
        Column(f"{side}_name", f"name of the building at the {side}", label=f"{side} name"),
        Column(f"{side}_type", f"its building type of HAZUS, at the {side}", label=f"{side} type"),
        Column(f"{side}_design", f"its design level, at the {side}", label=f"{side} design"),
        Column(f"{side}_storeys", f"its number of storeys, at the {side}", PURE_NUMBER, f"{side} storeys", 0),
        Column(f"{side}_height", f"its height, at the {side}", _HEIGHT, f"{side} height", 3),
    ]


SCREEN_COLUMNS = (
    Column("rank", "place in the order of the rates, 1 the highest", PURE_NUMBER, digits=0),
    Column("pair", "name of the pair"),
    *_list_building_columns("left"),
    *_list_building_columns("right"),
    Column("gap", "width of the gap", _LENGTH, digits=3),
    *list_estimate_columns(Column("rate", "annual rate of contact", _RATE, digits=2)),
    Column("probability", "probability of contact within 50 years", Unit("%", 0.01, "1"), "in 50 years", 2),
    Column("pga", "peak ground acceleration with a return period of 475 years", _ACCELERATION, "pga 475", 3),
    Column(
        "enough", "probability that the gap is enough at that acceleration", Unit("%", 0.01, "1"), "enough at 475", 2
    ),
    Column("decides", "what nobody knows of the buildings that explains most of the variance of the closings"),
    Column("share", "its share of the variance", Unit("%", 0.01, "1"), digits=2),
    Column("motion_share", "share of the variance from motion to motion", Unit("%", 0.01, "1"), "share of motions", 2),
    Column("neighbours", "buildings that each neighbour may be", PURE_NUMBER, digits=0),
    Column("motions", "motions without a failed run", PURE_NUMBER, digits=0),
    Column("row", "row of the table", PURE_NUMBER, digits=0),
)

SHARES_COLUMNS = (
    Column("rank", "place in the order of the rates", PURE_NUMBER, digits=0),
    Column("pair", "name of the pair"),
    Column("input", "what is unknown"),
    Column("share", "share of the variance of the logarithm of the closings", Unit("%", 0.01, "1"), digits=2),
)

COLUMNS_BY_TABLE = {SCREEN_TABLE: SCREEN_COLUMNS, SHARES_TABLE: SHARES_COLUMNS}
"""The tables that a screen adds to those of `pound gap` for the worst pair."""
