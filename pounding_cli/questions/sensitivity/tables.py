"""The tables of `pound sensitivity` and their columns."""

from __future__ import annotations

from pounding_cli.questions.frames import PURE_NUMBER, list_estimate_columns
from pounding_cli.tables import Column

INDICES = "sensitivity"
OUTPUTS = "sensitivity_outputs"
PROBABILITIES = "sensitivity_probabilities"
SAMPLES = "sensitivity_samples"
"""Names of the tables."""

PERCENTILES = (5, 50, 95)

OUTPUT_PLACE_COLUMNS = (
    Column("case", "case of the study; empty: all of them"),
    Column("analysis", "elastic or inelastic storeys; empty: both"),
)
"""Columns that say, behind the swept keys, where a row stands."""

_CONTACT = Column(
    "on_contact",
    "1 where floors strike on which the number rests, so that it depends on the contact stiffness",
    PURE_NUMBER,
)

_FAILED = Column("failed", "samples without a value", PURE_NUMBER, digits=0)

INDEX_COLUMNS = (
    *OUTPUT_PLACE_COLUMNS,
    Column("output", "output, or statement, that the indices are of"),
    Column("unit", "SI unit of the output; empty of a pure number"),
    _CONTACT,
    Column("key", "key that varies, the first of those that move together"),
    Column("outcome", "found, or why there is no index"),
    _FAILED,
    Column("samples", "samples that the row rests on", PURE_NUMBER, digits=0),
    *list_estimate_columns(
        Column(
            "first", "first-order index: part of the variance that this key explains by itself", PURE_NUMBER, digits=3
        )
    ),
    *list_estimate_columns(
        Column(
            "total",
            "total index: part of the variance that disappears if this key is known, including interactions",
            PURE_NUMBER,
            digits=3,
        )
    ),
    Column("mean", "mean of the output over the independent samples, in its SI unit", digits=3),
    Column(
        "at_low",
        "mean of the output where the key is in the lowest fifth of its distribution, in its SI unit; of a choice, at "
        "the option where it is least",
        digits=3,
        error="at_low_error",
    ),
    Column("at_low_error", "standard error of that mean", digits=2),
    Column(
        "at_high",
        "mean of the output where the key is in the highest fifth of its distribution, in its SI unit; of a choice, at "
        "the option where it is most",
        digits=3,
        error="at_high_error",
    ),
    Column("at_high_error", "standard error of that mean", digits=2),
    *list_estimate_columns(
        Column(
            "mu_star",
            "mean size of the elementary effects: change of the output over the whole range of the key, in its SI unit",
            digits=3,
        )
    ),
    Column("mu", "mean of the elementary effects, with their signs, in the SI unit of the output", digits=3),
    Column(
        "sigma",
        "standard deviation of the elementary effects, in the SI unit of the output: large where the key acts with "
        "others or not in proportion",
        digits=3,
    ),
)

OUTPUT_COLUMNS = (
    *OUTPUT_PLACE_COLUMNS,
    Column("output", "output"),
    Column("unit", "SI unit of the output; empty of a pure number"),
    _CONTACT,
    _FAILED,
    Column("samples", "independent samples that the row rests on", PURE_NUMBER, digits=0),
    *list_estimate_columns(Column("mean", "mean of the output, in its SI unit", digits=3)),
    *list_estimate_columns(Column("deviation", "standard deviation of the output, in its SI unit", digits=3)),
    *(
        column
        for share in PERCENTILES
        for column in list_estimate_columns(
            Column(f"percentile_{share}", f"percentile {share} of the output, in its SI unit", digits=3)
        )
    ),
)

PROBABILITY_COLUMNS = (
    *OUTPUT_PLACE_COLUMNS,
    Column("statement", "statement that holds or does not"),
    _CONTACT,
    _FAILED,
    Column("samples", "independent samples in which it is known whether the statement holds", PURE_NUMBER, digits=0),
    *list_estimate_columns(
        Column("probability", "part of these samples in which the statement holds", PURE_NUMBER, digits=3),
        "interval (Clopper and Pearson)",
    ),
    Column("most_influential", "key with the largest effect on whether the statement holds; empty: none"),
    *list_estimate_columns(
        Column("influence", "total index or mean elementary effect of this key", PURE_NUMBER, digits=3)
    ),
)

SAMPLE_COLUMNS = (
    *OUTPUT_PLACE_COLUMNS,
    Column("sample", "number of the sample", PURE_NUMBER, digits=0),
    Column("independent", "1 where the sample is independent of the others", PURE_NUMBER, digits=0),
)
"""Beside those of the keys and of the outputs, which the study decides."""

COLUMNS_BY_TABLE = {
    INDICES: INDEX_COLUMNS,
    OUTPUTS: OUTPUT_COLUMNS,
    PROBABILITIES: PROBABILITY_COLUMNS,
    SAMPLES: SAMPLE_COLUMNS,
}
