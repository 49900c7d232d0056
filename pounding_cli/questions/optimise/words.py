"""The answer of `pound optimise` in sentences, tables and notes."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from pounding_cli.numbers import NOTHING, Unit, count_histories, format_number, join_limited, pluralize
from pounding_cli.questions.expression_words import CONTACT_NOTE, ON_CONTACT, describe_output, find_output_unit
from pounding_cli.questions.optimise.question import (
    CONTACTS,
    FAILED,
    FLAGGED,
    NO_OPTIMUM,
    NOT_MET,
    UNSETTLED,
    WITH_CONTACT,
)
from pounding_cli.questions.optimise.tables import DESIGN, OPTIMUM, SEARCHED_POINTS
from pounding_cli.report.background import STIFFNESS_KEY
from pounding_cli.study.display import key_words
from pounding_cli.study.expressions.expression import QUANTITIES
from pounding_cli.tables import Column, Row, Table

if TYPE_CHECKING:
    from pounding_cli.results.results import ResultTables

MAX_KEYS = 8
"""Keys that are drawn."""

AT_END = 1e-6
"""Share of a range: nearer to its end, the optimum lies at it [-]."""

NOTICED = 0.01
"""A demand that the optimum raises by more than this part is named [-]."""

_NO_DEMANDS = (CONTACTS, "largest max_closing")
"""Rows of the design in which more is not worse: a wider gap may close further; time histories are counted."""

_SAME = 1e-9
"""Two values that differ by less are one [-]."""


def list_sentences(results: ResultTables) -> list[str]:
    """Return the best values with the number sought, the contacts that are left, and what the optimum makes worse."""
    first = _first_row(results)
    if first["outcome"] == NOT_MET:
        return [f"{_name_goal(results)}: there is no answer, since {NOT_MET}: {first['required']}, under every motion."]
    if first["outcome"] in NO_OPTIMUM:
        return [f"{_name_goal(results)}: there is no answer, since {first['outcome']} that means something."]
    further = [_describe_required(first), describe_remainder(results), describe_losses(results)]
    return [describe_optimum(results), *filter(None, further)]


def list_tables(results: ResultTables) -> list[Table]:
    """Return the best value of every key, and what the buildings do with them and with the study as written."""
    if _first_row(results)["outcome"] in NO_OPTIMUM:
        return []
    return [_view_optimum(results), _view_design(results)]


def list_notes(results: ResultTables) -> list[str]:
    """Return how far the optimum can be trusted, and which points do not count."""
    first = _first_row(results)
    points = pluralize(int(first["points"]), "point")
    notes = []
    if first["outcome"] not in NO_OPTIMUM:
        if words := _describe_motions(results):
            notes.append(f"The number sought is the {words}, storey by storey, before storeys are compared.")
        if math.isnan(first["error"]):
            notes.append("The numerical error is not known: no run near the optimum was assessed (`estimate:`).")
        if _shows_contact(results):
            notes.append(CONTACT_NOTE)
        notes += [
            f"{key} is best at the end of its range: {_describe_beyond(key)}." for key in _list_keys_at_end(results)
        ]
    if first["outcome"] == UNSETTLED:
        notes.append(
            "The search ended before the points of a generation were nearly as good: write more `generations:`."
        )
    if first["failed"]:
        verb = "has" if first["failed"] == 1 else "have"
        notes.append(f"{int(first['failed'])} of {points} {verb} no value: a run failed or the quantity is undefined.")
    if first["meaningless"]:
        verb = "was" if first["meaningless"] == 1 else "were"
        notes.append(
            f"{int(first['meaningless'])} of {points} {verb} excluded: a link left the range in which its law has a "
            "meaning (`pound show FILE.h5 flagged`)."
        )
    count = len(results.answer(OPTIMUM).frame)
    if count > MAX_KEYS:
        notes.append(f"Figures show {MAX_KEYS} of {count} keys.")
    return notes


def list_references(resolved: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield the references of a search."""
    yield "storn1997", "differential evolution, as in SciPy"
    yield "nelder1965", "the simplex method, as in SciPy"


# The optimum


def _first_row(results: ResultTables) -> Row:
    """Return the row of the first key, which also has what all rows share."""
    return results.answer(OPTIMUM).frame.iloc[0].to_dict()


def find_goal(results: ResultTables) -> tuple[bool, str]:
    """Return whether the least is sought, not the most, and of which expression."""
    settings = results.study_data["optimise"]
    is_least = settings["least"] is not None
    return is_least, settings["least" if is_least else "most"]


def _name_goal(results: ResultTables) -> str:
    """Return what is sought: "Least value of largest μ"."""
    is_least, expression = find_goal(results)
    return f"{'Least' if is_least else 'Largest'} value of {describe_output(expression)}"


def sought_unit(results: ResultTables) -> Unit:
    """Return the unit in which people read the number sought."""
    _, expression = find_goal(results)
    return find_output_unit(results, expression, results.answer(OPTIMUM).column("optimum").unit.si)


def key_unit(results: ResultTables, key: str) -> Unit:
    """Return the unit in which people read the values of a key."""
    return results.answer(SEARCHED_POINTS).column(key).unit


def describe_optimum(results: ResultTables) -> str:
    """Return the best values and the number sought there, in place of that of the study as written."""
    first = _first_row(results)
    is_least, expression = find_goal(results)
    unit = sought_unit(results)
    best = Column("optimum", unit=unit, digits=5).format_with_unit(first)
    error = first["error"] / unit.factor
    worth = f" ± {format_number(error, 1)}" if error > 0 else ""
    number = best.replace(f" {unit.name}", f"{worth} {unit.name}") if unit.name else f"{best}{worth}"
    over = [describe_reduction(results), ON_CONTACT if _is_on_contact(results, _design_rows(results)[0]) else ""]
    brackets = f" ({', '.join(filter(None, over))})" if any(over) else ""
    comparison = _compare_with_written(first, unit, is_least)
    return f"{_name_best_values(results)}: {describe_output(expression)} {number}{comparison}{brackets}."


def _describe_required(row: Row) -> str:
    """Return what the optimum had to meet, and how many points do; "" where nothing is required."""
    if not row["required"]:
        return ""
    met = f"{int(row['points'] - row['unmet'])} of {pluralize(int(row['points']), 'point')}"
    written = "does not" if row["written_unmet"] else "does too"
    return (
        f"It meets what is required, {row['required']} under every motion, as do {met} in all; the study as written "
        f"{written}."
    )


def _name_best_values(results: ResultTables) -> str:
    """Return the best value of every key: "The best gap of near is 4.2 cm"."""
    rows = results.answer(OPTIMUM).frame.to_dict("records")
    words = Counter(key_words(str(row["key"])) for row in rows)
    values = []
    for row in rows:
        key = str(row["key"])
        name = key_words(key) if words[key_words(key)] == 1 else key
        values.append((name, _format_key_value(results, row, "value", "option")))
    if len(values) == 1:
        return f"The best {values[0][0]} is {values[0][1]}"
    return f"The best values are {join_limited(f'{name} {value}' for name, value in values)}"


def _format_key_value(results: ResultTables, row: Row, number: str, option: str) -> str:
    """Return a value of a key with its unit, or its option."""
    return row[option] or (NOTHING if math.isnan(row[number]) else key_unit(results, row["key"]).text(row[number], 4))


def _compare_with_written(row: Row, unit: Unit, is_least: bool) -> str:
    """Return how the optimum compares with the study as written: " in place of 1.38 as written, 24 % lower"."""
    written = row["as_written"]
    if math.isnan(written):
        return "; the study as written has no value"
    change = row["optimum"] - written
    if abs(change) <= _SAME * abs(written):
        return ", as good as the study as written"
    words = f" in place of {Column('as_written', unit=unit, digits=5).format_with_unit(row)} as written"
    if written != 0:
        percent = Unit("%").text(100 * abs(change / written), 2)
        words += f", {percent} {'lower' if change < 0 else 'higher'}"
    if (change > 0) == is_least:
        reason = "which does not meet what is required" if row["written_unmet"] else "outside what was searched"
        words += f": the study as written, {reason}, is better"
    return words


def describe_reduction(results: ResultTables) -> str:
    """Return what the number sought is over several motions and points of a sweep; "" where there is one of both."""
    words = [_describe_motions(results)]
    axes = results.swept[:-1]
    if axes:
        count = math.prod(len(results.axes[keys[0]]) for keys in axes)
        words.append(f"{results.study_data['optimise']['over_sweep']} of {count} points of the sweep")
    return ", ".join(filter(None, words))


def _describe_motions(results: ResultTables) -> str:
    """Return what the number sought is over several motions: "mean of 5 motions"; "" of one motion."""
    over_motions = _design_rows(results)[0]["over_motions"]
    return f"{over_motions} of {pluralize(len(results.names('record')), 'motion')}" if over_motions else ""


def _list_keys_at_end(results: ResultTables) -> list[str]:
    """Return the keys whose best value lies at an end of its range."""
    keys = []
    for row in results.answer(OPTIMUM).frame.to_dict("records"):
        tolerance = AT_END * (row["range_to"] - row["range_from"])
        if any(abs(row[end] - row["value"]) <= tolerance for end in ("range_from", "range_to")):
            keys.append(str(row["key"]))
    return keys


def _describe_beyond(key: str) -> str:
    """Return what may lie beyond the range of a key whose best value lies at the end of it."""
    if "places" in key.split("."):
        return "a better place may lie beyond, if both floors reach that far"
    return "a better value may lie beyond"


def _view_optimum(results: ResultTables) -> Table:
    """Return the best value of every key, in the unit of the key."""
    points = results.answer(SEARCHED_POINTS).frame

    def format_range(row: Row, low: str, high: str) -> str:
        if math.isnan(row[low]):
            return NOTHING
        unit = key_unit(results, row["key"])
        return " to ".join(Unit().text(unit.number(row[end]), 4) for end in (low, high))

    def format_value(row: Row, number: str, option: str) -> str:
        if row[option] or math.isnan(row[number]):
            return row[option] or NOTHING
        if row["option"]:  # of a choice, whose options are texts with their units
            return results.value_label(row["key"], row[number])
        return Unit().text(key_unit(results, row["key"]).number(row[number]), 4)

    def format_unit(row: Row) -> str:
        name = key_unit(results, row["key"]).name
        return f"[{name}]" if name else ""

    def format_searched(row: Row) -> str:
        if row["option"]:
            return ", ".join(dict.fromkeys(map(str, points[row["key"]])))
        return format_range(row, "range_from", "range_to")

    columns = (
        Column("key", below=format_unit),
        Column("value", label="best", is_right=True, write=lambda row: format_value(row, "value", "option")),
        Column(
            "written",
            label="as written",
            is_right=True,
            write=lambda row: format_value(row, "written", "written_option"),
        ),
        Column(
            "good_from", label="as good", optional=True, write=lambda row: format_range(row, "good_from", "good_to")
        ),
        Column("range_from", label="searched", optional=True, write=format_searched),
    )
    return results.answer(OPTIMUM).view(*columns, caption="The optimum")


# What the buildings do


def _design_rows(results: ResultTables) -> Sequence[Row]:
    """Return the rows of the design, the number sought first."""
    return results.answer(DESIGN).frame.to_dict("records")


def _is_on_contact(results: ResultTables, row: Row) -> bool:
    """Return whether a quantity depends on a contact stiffness that the study does not vary."""
    return bool(row["on_contact"]) and STIFFNESS_KEY not in results.axes


def _shows_contact(results: ResultTables) -> bool:
    return any(_is_on_contact(results, row) for row in _design_rows(results))


def format_quantity(results: ResultTables, row: Row, name: str) -> str:
    """Return a value of a row of the design as people read it: "3 of 5" time histories, "38.50 mm".

    name : "optimum" or "as_written"
    """
    if math.isnan(row[name]):
        return NOTHING
    if row["of"]:
        return f"{row[name]:.0f} of {row['of']:.0f}"
    if row["quantity"] == CONTACTS:
        return f"{row[name]:.0f}"
    unit = find_output_unit(results, row["quantity"], row["unit"])
    return unit.text(row[name], 5)


def name_quantity(row: Row) -> str:
    """Return the name of a row of the design."""
    is_demand = not row["of"] and row["quantity"] != CONTACTS
    return describe_output(row["quantity"]) if is_demand else str(row["quantity"])


def describe_remainder(results: ResultTables) -> str:
    """Return in how many time histories contact is left at the optimum, and what is flagged there."""
    rows = {row["quantity"]: row for row in _design_rows(results)}
    row = rows[WITH_CONTACT]
    count = row["optimum"]
    if math.isnan(count):
        contact = "contacts are not known, since a run failed"
    elif count == 0:
        contact = "no contact is left"
    else:
        contact = f"contact is left in {count:.0f} of {count_histories(int(row['of']))}"
    flags = [name.removeprefix(FLAGGED) for name, row in rows.items() if name.startswith(FLAGGED) and row["optimum"]]
    return f"At the optimum {contact}; {f'flagged: {join_limited(flags)}' if flags else 'nothing is flagged'}."


def describe_losses(results: ResultTables) -> str:
    """Return what is larger at the optimum than with the study as written by more than NOTICED; "" where nothing is.

    Where the most is sought, quantities of the expression are larger by intention.
    """
    is_least, expression = find_goal(results)
    sought = set(expression.split()) & set(QUANTITIES)
    losses = []
    for row in _design_rows(results)[1:]:
        is_intended = not is_least and bool(sought & set(row["quantity"].split()))
        if row["quantity"] in _NO_DEMANDS or is_intended:
            continue
        if row["optimum"] > (1 + NOTICED) * row["as_written"]:
            best, written = (format_quantity(results, row, name) for name in ("optimum", "as_written"))
            contact = f" ({ON_CONTACT})" if _is_on_contact(results, row) else ""
            losses.append(f"{name_quantity(row)}{contact}, {best} in place of {written}")
    return f"The optimum makes worse: {'; '.join(losses)}." if losses else ""


def _view_design(results: ResultTables) -> Table:
    """Return what the buildings do at the optimum, and with the study as written."""
    frame = results.answer(DESIGN).frame
    is_idle = (frame["quantity"] == FAILED) & (frame["optimum"] == 0) & (frame["as_written"] == 0)
    motions = len(results.names("record"))
    caption = "What the buildings do"
    if motions > 1:
        caption += f" (largest of {motions} motions, unless said otherwise)"

    frame = frame.assign(reduction=[describe_reduction(results), *[""] * (len(frame) - 1)])

    def describe_row(row: Row) -> str:
        """Return what stands below a quantity: what is flagged, what it is over the motions, whether on contact."""
        kind = row["quantity"].removeprefix(FLAGGED) if row["quantity"].startswith(FLAGGED) else ""
        return "\n".join(filter(None, [kind, row["reduction"], ON_CONTACT if _is_on_contact(results, row) else ""]))

    columns = (
        Column("quantity", write=lambda row: name_quantity(row).partition(": ")[0], below=describe_row),
        Column(
            "optimum",
            label="at the optimum",
            is_right=True,
            write=lambda row: format_quantity(results, row, "optimum"),
        ),
        Column(
            "as_written",
            label="as written",
            is_right=True,
            write=lambda row: format_quantity(results, row, "as_written"),
        ),
    )
    return results.answer(DESIGN).view(*columns, frame=frame[~is_idle], caption=caption)
