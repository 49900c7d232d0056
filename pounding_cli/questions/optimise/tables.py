"""The tables of `pound optimise` and their columns."""

from __future__ import annotations

from pounding_cli.questions.frames import PURE_NUMBER
from pounding_cli.tables import Column

OPTIMUM = "optimise"
DESIGN = "optimise_design"
SEARCHED_POINTS = "optimise_points"
"""Names of the tables."""

OPTIMUM_COLUMNS = (
    Column("sought", "number that is optimised: `least` or `most`, and the expression"),
    Column("optimum", "best value of this number", digits=5),
    Column("error", "numerical error of this number, at most", digits=1),
    Column("tolerance", "its error, or 1 % of it", digits=2),
    Column("as_written", "value of this number with the study as written", digits=5),
    Column("outcome", "outcome, or why there is no answer"),
    Column("required", "statements that must hold, under every motion; empty where nothing is required"),
    Column("written_unmet", "1 where they do not hold with the study as written", PURE_NUMBER, digits=0),
    Column("points", "points that were tried", PURE_NUMBER, digits=0),
    Column("unmet", "points at which they do not hold", PURE_NUMBER, digits=0),
    Column("failed", "points that have no value: a run failed or the quantity is undefined", PURE_NUMBER, digits=0),
    Column(
        "meaningless",
        "points whose number has no meaning: a link left the range in which its law has one",
        PURE_NUMBER,
        digits=0,
    ),
    Column("key", "key that varies"),
    Column("unit", "SI unit of the key, or the storey's stiffness that it is a multiple of"),
    Column("value", "value of the key at the optimum; NaN of a choice"),
    Column("place", "place of the optimum in what was searched, 0 to 1", PURE_NUMBER),
    Column("option", "option chosen at the optimum; empty of a number"),
    Column("good_from", "lowest value among the points tried whose number is as good, within the tolerance"),
    Column("good_to", "highest value among these points"),
    Column("range_from", "lower end of what was searched"),
    Column("range_to", "upper end of what was searched"),
    Column("spacing", "linear or log; empty of a choice"),
    Column("written", "value of the key as written"),
    Column("written_option", "option as written"),
)
"""The number that is optimised and its columns are in the unit that the study decides, keys in SI."""

DESIGN_COLUMNS = (
    Column(
        "quantity",
        "what is compared: first the number sought, then the largest over all motions, points of a sweep, storeys, "
        "floors and links",
    ),
    Column("unit", "SI unit; 1 of a pure number"),
    Column(
        "over_motions", "mean or largest, of the number sought over several motions, storey by storey; otherwise empty"
    ),
    Column("optimum", "at the optimum, in SI", digits=5),
    Column("as_written", "with the study as written, in SI", digits=5),
    Column("of", "time histories, where these are counted; otherwise 0", PURE_NUMBER, digits=0),
    Column(
        "on_contact",
        "1 where floors strike on which the number rests, so that it depends on the contact stiffness",
        PURE_NUMBER,
        digits=0,
    ),
)

SEARCHED_POINT_COLUMNS = (
    Column("point", "number of the point", PURE_NUMBER, digits=0),
    Column("stage", "what the point was tried for"),
    Column("value", "value of the number sought; NaN where it has none or no meaning", digits=5),
    Column("error", "numerical error of this number, at most", digits=1),
    Column("meaningless", "1 where a link left the range in which its law has a meaning", PURE_NUMBER, digits=0),
    Column("unmet", "1 where a statement that must hold does not", PURE_NUMBER, digits=0),
)
"""Beside those of the keys, which the study decides; a swept key stands between stage and value."""

COLUMNS_BY_TABLE = {OPTIMUM: OPTIMUM_COLUMNS, DESIGN: DESIGN_COLUMNS, SEARCHED_POINTS: SEARCHED_POINT_COLUMNS}
