"""The columns of the tables of `pound sensitivity`."""

from __future__ import annotations

from pounding_cli.numbers import Unit
from pounding_cli.tables import Column

NUMBER = Unit("", 1.0, "1")

SENSITIVITY_COLUMNS = (
    Column("case", "case of the study; empty: all of them"),
    Column("analysis", "elastic or inelastic storeys; empty: both"),
    Column("output", "number looked at"),
    Column("statement", "what holds"),
    Column("unit", "SI unit of the output"),
    Column("key", "key that varies, the first of those that move together"),
    Column("outcome", "outcome, or why there is no index"),
    Column("failed", "samples without a number", unit=NUMBER),
    Column(
        "samples", "samples that the row rests on; of outputs and probabilities those that are independent", unit=NUMBER
    ),
    Column("first", "first-order index: part of the variance that this key explains by itself", unit=NUMBER),
    Column(
        "total",
        "total index: part of the variance that disappears if this key is known, including interactions",
        unit=NUMBER,
    ),
    Column("mu_star", "mean size of the elementary effects: change of the output over the whole range of the key"),
    Column("mu", "mean of the elementary effects, with their signs"),
    Column(
        "sigma",
        "standard deviation of the elementary effects: large where the key acts with others or not in proportion",
    ),
    Column("mean", "mean of the output"),
    Column("deviation", "standard deviation of the output"),
    Column("percentile_5", "percentile 5 of the output"),
    Column("percentile_50", "percentile 50 of the output"),
    Column("percentile_95", "percentile 95 of the output"),
    Column(
        "at_low",
        "mean of the output where the key is in the lowest fifth of its distribution; of a choice, at the option where it is least",
    ),
    Column(
        "at_high",
        "mean of the output where the key is in the highest fifth of its distribution; of a choice, at the option where it is most",
    ),
    Column(
        "probability",
        "part of these samples in which it holds; its interval is that of Clopper and Pearson",
        unit=NUMBER,
    ),
    Column("decided_by", "key that decides most whether it holds; empty: none"),
    Column("share", "its total index or mean elementary effect", unit=NUMBER),
    Column("sample", "number of the sample", unit=NUMBER),
    Column("independent", "1 where independent", unit=NUMBER),
)
