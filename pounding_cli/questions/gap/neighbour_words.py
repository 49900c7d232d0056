"""The answer of `pound gap` beside a neighbour that is only seen, in sentences and tables."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pounding_cli.numbers import format_number, join_limited
from pounding_cli.questions.gap.evidence import GapEvidence, describe_pair
from pounding_cli.questions.gap.tables import (
    NEIGHBOUR_CASES_TABLE,
    NEIGHBOUR_SHARES,
    NEIGHBOURS_TABLE,
    name_enough,
)
from pounding_cli.questions.neighbours import describe_seen, list_drawn_names
from pounding_cli.tables import Column, Row, Table

if TYPE_CHECKING:
    from pounding_cli.results.results import ResultTables

_PAIR = Column("left", "two neighbours, left and right of the gap", label="between", write=describe_pair)
_KINDS = {"elastic": "elastic", "inelastic": "yielding"}


def describe_neighbours(evidence: GapEvidence, pair: tuple[str, str]) -> str:
    """Return how likely the gaps of the cases are enough, and the gaps for some probabilities; "" where all buildings
    are certain."""
    results = evidence.results
    if NEIGHBOURS_TABLE not in results.answers:
        return ""
    table = results.answer(NEIGHBOURS_TABLE)
    rows = evidence.select_pair(evidence.shown.rows_here(table.frame), pair)
    if rows.empty:
        return ""
    first = rows.iloc[0]
    places = dict(zip(results.resolved["places"], results.resolved["group"], strict=True))
    drawn = [place for place in pair if places[place] in list_drawn_names(results)]
    if not drawn:
        return ""
    names = join_limited(describe_seen(results.resolved["buildings"][places[place]], place) for place in drawn)
    count = f"{first['neighbours']:.0f} buildings that {names} may be and over {first['motions']:.0f} motions"
    where = f"between {' and '.join(pair)} " if len(evidence.pairs) > 1 else ""
    parts = []
    judged = results.answer(NEIGHBOUR_CASES_TABLE)
    cases = evidence.select_pair(evidence.shown.rows_here(judged.frame), pair)
    names_cases = cases["case"].nunique() > 1
    for (case, gap), of_case in cases.groupby(["case", "gap"], sort=False):
        column = judged.column("enough")
        chances = ", ".join(
            f"{_format_probability(column, row)} {_describe_kind(row, number)}"
            for number, row in enumerate(of_case.to_dict("records"))
        )
        named = f" ({case})" if names_cases else ""
        parts.append(f"{evidence.unit.text(gap)}{named} is enough {where}with a probability of {chances}")
    widths = []
    for number, row in enumerate(rows.to_dict("records")):
        gaps = ", ".join(format_number(row[name_enough(share)] / evidence.unit.factor, 3) for share in NEIGHBOUR_SHARES)
        widths.append(f"{gaps} {evidence.unit.name} {_describe_kind(row, number)}")
    shares = ", ".join(f"{100 * share:.0f} %" for share in NEIGHBOUR_SHARES)
    needs = f"for {shares} {where}the gap is {'; '.join(widths)}"
    point = evidence.shown.format_point(rows)
    over = f"At {point}, over" if point else "Over"
    return f"{over} {count}: {'; '.join([*parts, needs])}."


def _describe_kind(row: Row, number: int) -> str:
    return f"as {_KINDS[row['analysis']]} {'ones' if number else 'buildings'}"


def _format_probability(column: Column, row: Row) -> str:
    """Return a probability with its interval: "0.8 (0.6 to 0.9)"."""
    return column.format_with_unit(row)


def describe_spread(evidence: GapEvidence, pair: tuple[str, str]) -> str:
    """Return what the neighbour adds to the scatter of the required gap; "" where nothing is known of it."""
    results = evidence.results
    if NEIGHBOURS_TABLE not in results.answers:
        return ""
    rows = evidence.select_pair(evidence.shown.rows_here(results.answer(NEIGHBOURS_TABLE).frame), pair)
    rows = rows[rows["spread"].notna()]
    parts = [
        f"{format_number(row['spread_motions'], 2)} over the motions and {format_number(row['spread_neighbours'], 2)} "
        f"over the neighbour, {format_number(row['spread'], 2)} in all, {_describe_kind(row, number)}"
        for number, row in enumerate(rows.to_dict("records"))
    ]
    where = f" between {' and '.join(pair)}" if len(evidence.pairs) > 1 else ""
    return f"Scatter of the required gap{where} (β, of the logarithm): {'; '.join(parts)}." if parts else ""


def show_neighbours(results: ResultTables) -> list[Table]:
    """Return the tables over what neighbours may be; none where all buildings are certain."""
    tables = []
    if NEIGHBOURS_TABLE in results.answers:
        table = results.answer(NEIGHBOURS_TABLE)
        keys = [key for key in results.axes if table.has(key)]
        gaps = [name_enough(share) for share in NEIGHBOUR_SHARES]
        caption = "Gap that is enough with a probability over what the neighbour may be and over the motions"
        spreads = ("spread_motions", "spread_neighbours", "spread")
        tables.append(table.view(*keys, _PAIR, "analysis", *gaps, *spreads, caption=caption))
        judged = results.answer(NEIGHBOUR_CASES_TABLE)
        caption = "Probability that the gaps of the cases are enough, over both"
        tables.append(judged.view(*keys, "case", _PAIR, "analysis", "gap", "enough", caption=caption))
    return tables


def note_median(results: ResultTables) -> str:
    """Return which neighbour all other numbers are of; "" where all buildings are certain."""
    names = list_drawn_names(results)
    if not names or NEIGHBOURS_TABLE not in results.answers:
        return ""
    return (
        f"Annual rates are over what {join_limited(names)} may be too; all other numbers but the first ones are of the "
        "median building, which `pound run` simulates. `pound check` lists its numbers with their sources."
    )
