"""The columns of the tables of `pound optimise`."""

from __future__ import annotations

from pounding_cli.numbers import Unit
from pounding_cli.tables import Column

NUMBER = Unit("", 1.0, "1")

OPTIMISE_COLUMNS = (
    Column("sought", "number that is optimised"),
    Column("optimum", "its best value"),  # in the unit that the study decides
    Column("error", "numerical error of the number sought, at most"),  # in the unit that the study decides
    Column("tolerance", "its error, or 1 % of it"),  # in the unit that the study decides
    Column("as_written", "value of the file as written"),  # in the unit that the study decides
    Column("outcome", "outcome, or why there is no answer"),
    Column("points", "points that were tried", unit=NUMBER),
    Column("failed", "points without a number", unit=NUMBER),
    Column(
        "meaningless", "points whose number has no meaning: a link left the range in which its law has one", unit=NUMBER
    ),
    Column("key", "key that varies"),
    Column("unit", "its unit"),
    Column("value", "of the key at the optimum; NaN of a choice"),
    Column("place", "of the optimum in what was searched, 0 to 1", unit=NUMBER),
    Column("option", "chosen at the optimum; empty of a number"),
    Column("good_from", "lower end of what is as good: within the tolerance, among all points that were tried"),
    Column("good_to", "upper end of what is as good"),
    Column("range_from", "lower end of what was searched"),
    Column("range_to", "upper end of what was searched"),
    Column("spacing", "linear or log; empty of a choice"),
    Column("written", "of the key as written"),
    Column("written_option", "option as written"),
)

OPTIMISE_DESIGN_COLUMNS = (
    Column(
        "quantity",
        "what is compared: first the number sought, then the largest over all motions, points of a sweep, storeys, floors and links",
    ),
    Column("unit", "its unit"),
    Column(
        "over_motions", "mean or largest, of the number sought over several motions, storey by storey; otherwise empty"
    ),
    Column("optimum", "at the optimum"),
    Column("as_written", "with the study as it is written"),
    Column("of", "scenes, where scenes are counted; otherwise 0", unit=NUMBER),
)

OPTIMISE_POINTS_COLUMNS = (
    Column("point", "number of the point", unit=NUMBER),
    Column("stage", "what it was tried for"),
    Column("value", "of the number sought; NaN where it has none or no meaning"),  # in the unit that the study decides
    Column("meaningless", "1 where a link left the range in which its law has a meaning", unit=NUMBER),
)
