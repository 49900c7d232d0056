"""The answer of `pound sensitivity` in sentences, tables and notes."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from pounding_cli.numbers import NOTHING, Unit, pluralize
from pounding_cli.questions.expression_words import CONTACT_NOTE, ON_CONTACT, describe_output, find_output_unit
from pounding_cli.questions.frames import FOUND
from pounding_cli.questions.sensitivity.tables import INDICES, OUTPUTS, PERCENTILES, PROBABILITIES, SAMPLES
from pounding_cli.report.background import STIFFNESS_KEY
from pounding_cli.report.evidence import Evidence, find_nominal
from pounding_cli.study.display import key_words
from pounding_cli.study.schema.archetypes import KEY as ARCHETYPE
from pounding_cli.study.schema.archetypes import is_sample_key
from pounding_cli.study.vary.inputs import MOTION
from pounding_cli.study.vary.uncertain import ANY, BOOTSTRAP
from pounding_cli.tables import Column, Row, Table

if TYPE_CHECKING:
    import pandas as pd

    from pounding_cli.results.results import ResultTables

MAX_OUTPUTS = 6
"""Outputs with a table and a line of panels; of more, the first are evidence."""

MAX_STATEMENTS = 4
"""Statements with a sentence each; more are summed up in one."""

MAX_WIDTH = 100.0
"""Width of the interval of a share of the variance beyond which nothing is known of the share [%]."""

NEGLIGIBLE = 0.0005
"""An index below this is shown as zero [-]."""

INFLUENCES = {"sobol": "total", "morris": "mu_star"}
"""Column by which keys are ordered, of each method."""


def list_sentences(results: ResultTables) -> list[str]:
    """Return the answer, a paragraph for every output and statement at one point of the other swept keys."""
    outputs = iter_outputs(results)
    statements = _list_statements(results)
    names = {row["statement"] for row in statements}
    sentences = [
        f"{describe_output_place(results, rows.iloc[0].to_dict())}: {describe_influence(results, rows)}"
        for rows in outputs
        if rows["output"].iloc[0] not in names
    ]
    if len(statements) > MAX_STATEMENTS:
        return [*sentences, summarize_statements(results, statements)]
    return [*sentences, *(describe_statement(results, row) for row in statements)]


def list_tables(results: ResultTables) -> list[Table]:
    """Return the probabilities of statements, and the indices of every output at one point of the other swept keys."""
    tables = [_view_probabilities(results)] if PROBABILITIES in results.answers else []
    return [*tables, *(_view_indices(results, rows) for rows in list_shown(results))]


def list_notes(results: ResultTables) -> list[str]:
    """Return what intervals are, what an output is over the motions, and what has no value."""
    spec = results.study_data["sensitivity"]
    frame = results.answer(INDICES).frame
    samples = pluralize(int(frame["samples"].iloc[0]), "sample")
    notes = []
    if (frame["outcome"] == FOUND).any() or {OUTPUTS, PROBABILITIES} & set(results.answers):
        confidence = f"{100 * spec['confidence']:.4g} % interval"
        notes.append(
            f"In brackets: {confidence}, of indices from {spec['draws']} bootstrap draws of the {samples}; behind ±: "
            "standard error."
        )
    is_of_case = frame["case"] != ""
    if is_of_case.any() and (words := describe_motion_statistic(results)):
        is_mean = not words.startswith("one")
        taken = f"An output of a sample is the {words}, storey by storey, before storeys are compared."
        notes.append(taken if is_mean else "Each sample rests on one motion.")
    if (~is_of_case).any():
        notes.append("What each statement of the study compares: `statements:` of the study, and `pound run`.")
    if failed := int(frame["failed"].max()):
        notes.append(
            f"Up to {failed} of {samples} have no value: a run failed or the quantity is undefined. Outputs with such "
            "samples have no index, since leaving them out would bias it."
        )
    swept = {key.split(".")[1] for key in results.axes if f".{ARCHETYPE}" in key and not is_sample_key(key)}
    if swept:
        notes.append(f"Nothing of {' and '.join(sorted(swept))} is varied, as `archetype` is swept there.")
    if _has_contact_outputs(results):
        notes.append(f"{CONTACT_NOTE} Add `{STIFFNESS_KEY}` to `uncertain:` to see its influence.")
    count = sum(1 for rows in iter_outputs(results) if rows["outcome"].iloc[0] == FOUND)
    if count > MAX_OUTPUTS:
        notes.append(
            f"Tables and figures show {MAX_OUTPUTS} of {count} outputs; the others: pound show FILE.h5 {INDICES}"
        )
    if len(results.axes) > len(results.swept[-1]):
        label = _shown_point(results).format_point(_other_keys(results))
        notes.append(f"Shown at {label}; other points of the sweep: pound show FILE.h5 {INDICES}")
    return notes


def list_references(resolved: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield the references of the method that a study names."""
    if (resolved.get("sensitivity") or {}).get("method", "sobol") == "morris":
        yield "campolongo2007", "screening by elementary effects"
    else:
        yield "saltelli2010", "first-order and total indices of the variance"
        yield "efron1993", "the bootstrap of the samples"
    yield "iwanaga2022", "SALib, which draws the samples and computes the indices"


# Outputs


def iter_outputs(results: ResultTables) -> Iterator[pd.DataFrame]:
    """Yield the indices of every output at one point of the other swept keys, the most influential key first."""
    frame = results.answer(INDICES).frame
    has_case = frame["case"] != ""  # of statements of the study the probabilities say it all
    frame = _shown_point(results).rows_here(frame[has_case])
    frame = frame.sort_values(_influence_column(results), ascending=False, kind="stable")
    indices = frame.columns[frame.columns.str.match("(first|total)(_|$)")]
    frame = frame.assign(**frame[indices].mask(frame[indices].abs() < NEGLIGIBLE, 0.0))
    places = [*_other_keys(results), "case", "analysis", "output"]
    groups = [rows for _, rows in frame.groupby(places, sort=False)]
    yield from sorted(groups, key=lambda rows: min(rows.index))  # in the order of the study


def list_shown(results: ResultTables) -> list[pd.DataFrame]:
    """Return the indices of the outputs with tables and figures, as `iter_outputs`."""
    return [rows for rows in iter_outputs(results) if rows["outcome"].iloc[0] == FOUND][:MAX_OUTPUTS]


def describe_output_place(results: ResultTables, row: Row) -> str:
    """Return an output or statement with where it stands: "largest μ (case gap, elastic, mean of 5 motions)"."""
    keys = _other_keys(results)
    words = [f"{key} = {results.value_label(key, row[key])}" for key in keys if key in row]
    if row["case"]:
        words += [f"case {row['case']}", str(row["analysis"]), describe_motion_statistic(results)]
    else:
        words.append("all cases")
    if has_contact_words(results, row):
        words.append(ON_CONTACT)
    name = row["output"] if "output" in row else row["statement"]
    return f"{describe_output(name) if row['case'] else name} ({', '.join(filter(None, words))})"


def describe_motion_statistic(results: ResultTables) -> str:
    """Return what an output of a sample is over its motions: "mean of 5 motions"; "" where there is one motion."""
    uncertain = results.study_data["uncertain"] or {}
    entries = uncertain if isinstance(uncertain, list) else [uncertain]
    choices = [entry[MOTION] for entry in entries if MOTION in entry]
    if choices == [ANY]:
        return "one motion a sample"
    count = len(results.names("record"))
    if count == 1:
        return ""
    words = f"{results.study_data['sensitivity']['over_motions']} of {count} motions"
    return f"{words} drawn with replacement" if choices == [BOOTSTRAP] else words


def has_contact_words(results: ResultTables, row: Row) -> bool:
    """Return whether an output depends on a contact stiffness that the study does not vary."""
    return bool(row["on_contact"]) and STIFFNESS_KEY not in results.axes


def describe_influence(results: ResultTables, rows: pd.DataFrame) -> str:
    """Return the most influential key of an output with its effect, and the distribution of the output.

    rows : of the output, as `iter_outputs`
    """
    first = rows.iloc[0].to_dict()
    unit = find_output_unit(results, first["output"], first["unit"])
    if first["outcome"] != FOUND:
        words = f"no index: {first['outcome']}"
    elif first[_influence_column(results)] <= 0:
        words = "no key has an influence"
    else:
        words = _describe_most_influential(results, first, rows.iloc[1].to_dict(), unit)
    return f"{words}.{describe_output_spread(results, first, unit)}"


def _describe_most_influential(results: ResultTables, first: Row, second: Row, unit: Unit) -> str:
    """Return the most influential key with its effect.

    first, second : indices of the most influential key and of the one behind it
    unit : of the output
    """
    influence = _influence_column(results)
    words = f"most influential: {name_key(results, first['key'])}"
    if first[f"{influence}_low"] <= second[f"{influence}_high"]:
        samples = pluralize(int(first["samples"]), "sample")
        words += f" (not significantly more than {name_key(results, second['key'])} with {samples})"
    if influence == "mu_star":
        effect = _find_column(results, influence, unit).format_with_unit(first)
        return f"{words}, which changes it by {effect} on average over its range"
    share, low, high = (100 * first[name] for name in ("total", "total_low", "total_high"))
    if high - low > MAX_WIDTH:
        samples = pluralize(int(first["samples"]), "sample")
        words += f"; how much of the variance it explains cannot be told from {samples}: give more `samples`"
    else:
        words += f", which explains {share:.0f} % ({low:.0f} to {high:.0f} %) of the variance, interactions included"
    return "; ".join(filter(None, [words, describe_ends(results, first, unit)]))


def name_key(results: ResultTables, key: str) -> str:
    """Return a key as sentences name it: one of a plan or of places along the street in words, "eccentricity of
    corner", unless another key has these too; others as the study writes them."""
    keys = list(map(str, results.answer(INDICES).frame["key"].unique()))
    steps = key.split(".")
    is_deep = "plan" in steps or "places" in steps
    is_unique = [key_words(other) for other in keys].count(key_words(key)) == 1
    return key_words(key) if is_deep and is_unique else key


def describe_ends(results: ResultTables, row: Row, unit: Unit) -> str:
    """Return how an output changes from the low to the high end of a key; "" of a key without ends."""
    if not (math.isfinite(row["at_low"]) and math.isfinite(row["at_high"])):
        return ""
    low = _find_column(results, "at_low", unit).format_with_unit(row)
    high = _find_column(results, "at_high", unit).format_with_unit(row)
    if _is_choice(results, row["key"]):
        return f"its options give means from {low} to {high}"
    change = row["at_high"] - row["at_low"]
    error = math.hypot(row["at_low_error"], row["at_high_error"])
    if not abs(change) > 2 * error:
        return f"the mean does not change significantly from its low end ({low}) to its high end ({high})"
    return f"the mean {'rises' if change > 0 else 'falls'} from {low} at its low end to {high} at its high end"


def describe_output_spread(results: ResultTables, row: Row, unit: Unit) -> str:
    """Return mean and percentiles of an output as a sentence, with a blank before it; "" where there are none.

    row : of the indices of the output
    """
    if OUTPUTS not in results.answers:
        return ""
    frame = results.answer(OUTPUTS).frame
    places = [*_other_keys(results), "case", "analysis", "output"]
    is_same = (frame[places] == [row[place] for place in places]).all(axis=1)
    if not is_same.any():
        return ""  # a statement
    numbers = frame[is_same].iloc[0].to_dict()
    table = results.answer(OUTPUTS).with_columns(mean={"unit": unit})
    if not math.isfinite(numbers["mean"]):
        return ""
    low, _, high = PERCENTILES
    mean = table.column("mean").format_with_unit(numbers)
    between = " and ".join(
        Column(f"percentile_{share}", unit=unit, digits=3).format_with_unit(numbers) for share in (low, high)
    )
    return f" Mean {mean}; {high - low} % of the samples lie between {between}."


def _view_indices(results: ResultTables, rows: pd.DataFrame) -> Table:
    """Return the indices of one output, the most influential key first.

    rows : of the output, as `iter_outputs`
    """
    first = rows.iloc[0].to_dict()
    unit = find_output_unit(results, first["output"], first["unit"])
    table = results.answer(INDICES).with_columns(
        first={"label": "first order", "optional": True},
        at_low={"unit": unit, "label": "at its low end", "optional": True},
        at_high={"unit": unit, "label": "at its high end", "optional": True},
        mu_star={"unit": unit, "label": "mean effect"},
        mu={"unit": unit, "label": "mean, signed", "optional": True},
        sigma={"unit": unit, "label": "deviation", "optional": True},
    )
    names = ("first", "total", "at_low", "at_high", "mu_star", "mu", "sigma")
    caption = f"Influence on {describe_output_place(results, first)}"
    return table.view("key", *(name for name in names if table.has(name)), frame=rows, caption=caption)


def _find_column(results: ResultTables, name: str, unit: Unit) -> Column:
    """Return a column of the indices in the unit of an output."""
    return results.answer(INDICES).with_columns(**{name: {"unit": unit}}).column(name)


def _influence_column(results: ResultTables) -> str:
    return INFLUENCES[results.study_data["sensitivity"]["method"]]


def _other_keys(results: ResultTables) -> list[str]:
    """Return the swept keys beside those that vary from sample to sample."""
    return [key for keys in results.swept[:-1] for key in keys]


def _shown_point(results: ResultTables) -> Evidence:
    return find_nominal(results.first_sample())


def _is_choice(results: ResultTables, key: str) -> bool:
    """Return whether a key takes one of some options, whose ends have no direction."""
    frame = results.answer(SAMPLES).frame
    return frame[key].dtype.kind not in "iuf"


def _has_contact_outputs(results: ResultTables) -> bool:
    tables = [results.answer(name).frame for name in (INDICES, PROBABILITIES) if name in results.answers]
    return STIFFNESS_KEY not in results.axes and any(bool(frame["on_contact"].any()) for frame in tables)


# Statements


def _list_statements(results: ResultTables) -> Sequence[Row]:
    """Return the rows of the statements at one point of the other swept keys."""
    if PROBABILITIES not in results.answers:
        return []
    return _shown_point(results).rows_here(results.answer(PROBABILITIES).frame).to_dict("records")


def describe_statement(results: ResultTables, row: Row) -> str:
    """Return the probability of a statement, and the most influential key."""
    place = describe_output_place(results, row)
    if not math.isfinite(row["probability"]):
        return f"{place}: no probability, since no sample has a value: a run failed or the quantity is undefined."
    probability = results.answer(PROBABILITIES).column("probability").cell(row)
    words = f"{place} holds with a probability of {probability}"
    if row["most_influential"]:
        return f"{words}; most influential: {name_key(results, row['most_influential'])}."
    return f"{words}."


def summarize_statements(results: ResultTables, rows: Sequence[Row]) -> str:
    """Return how many of several statements hold more often than not, with the most and the least likely one."""
    known = sorted((row for row in rows if math.isfinite(row["probability"])), key=lambda row: row["probability"])
    if not known:
        return f"None of {len(rows)} statements has a probability: a run failed or the quantity is undefined."
    count = sum(row["probability"] > 0.5 for row in known)
    column = results.answer(PROBABILITIES).column("probability")
    least, most = (f"{_name_statement(row)}, {column.cell(row)}" for row in (known[0], known[-1]))
    words = f"Of {len(rows)} statements {count} hold with a probability above 50 %"
    return f"{words}; most likely: {most}; least likely: {least}."


def _name_statement(row: Row) -> str:
    """Return a statement with case and analysis, unless it is about all of them."""
    if not row["case"]:
        return str(row["statement"])
    return f"{describe_output(row['statement'])}, case {row['case']}, {row['analysis']}"


def _view_probabilities(results: ResultTables) -> Table:
    """Return the probability of every statement, with the most influential key and its influence."""
    influence = "total index" if _influence_column(results) == "total" else "mean effect"

    def write_statement(row: Row) -> str:
        return describe_output(row["statement"]) if row["case"] else row["statement"].partition(", ")[0]

    def write_below(row: Row) -> str:
        """Return that it is a part of a statement, or that the statement depends on the contact stiffness."""
        if has_contact_words(results, row):
            return ON_CONTACT
        return "" if row["case"] else row["statement"].partition(", ")[2]

    table = results.answer(PROBABILITIES).with_columns(
        case={"write": lambda row: row["case"] or "all"},
        analysis={"write": lambda row: row["analysis"] or "both"},
        statement={"write": write_statement, "below": write_below},
        most_influential={
            "write": lambda row: row["most_influential"] or NOTHING,
            "label": "most influential",
            "optional": True,
        },
        influence={"label": f"its {influence}", "optional": True},
    )
    caption = "Probability that statements hold"
    if (words := describe_motion_statistic(results)) and (results.answer(PROBABILITIES).frame["case"] != "").any():
        caption += f" ({words})"
    varying = (*_other_keys(results), "case", "analysis")
    return table.view("statement", "probability", "most_influential", "influence", varying=varying, caption=caption)
