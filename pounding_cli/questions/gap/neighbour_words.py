"""The answer of `pound gap` beside a neighbour that is only seen, in sentences and tables."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from pounding_cli.numbers import format_number, join_limited, pluralize
from pounding_cli.questions.gap.evidence import GapEvidence, describe_pair
from pounding_cli.questions.gap.tables import NEIGHBOUR_CASES_TABLE, NEIGHBOUR_SHARES, NEIGHBOURS_TABLE, name_enough
from pounding_cli.questions.neighbours import describe_seen, list_drawn_names
from pounding_cli.tables import Column, Row, Table

if TYPE_CHECKING:
    import pandas as pd

    from pounding_cli.results.results import ResultTables

_PAIR = Column("left", "two neighbours, left and right of the gap", label="between", write=describe_pair)
_KINDS = {"elastic": "elastic", "inelastic": "yielding"}


def describe_neighbours(evidence: GapEvidence, pair: tuple[str, str]) -> str:
    """Return how likely the gaps of the cases are enough, and the gaps for some probabilities; "" where both buildings
    are certain."""
    types = _list_drawn_types(evidence, pair)
    if not types:
        return ""
    rows = _select_rows(evidence, pair)
    if rows.empty:
        return ""
    first = rows.iloc[0].to_dict()
    drawn = [describe_seen(evidence.results, building_type, place, first) for place, building_type in types.items()]
    motions = pluralize(int(first["motions"]), "motion")
    count = f"{first['neighbours']:.0f} buildings that {join_limited(drawn, last=' and ')} may be and over {motions}"
    where = f"between {' and '.join(pair)} " if len(evidence.pairs) > 1 else ""
    shares = ", ".join(f"{100 * share:.0f} %" for share in NEIGHBOUR_SHARES)
    needs = f"for {shares} {where}the gap is {'; '.join(_iter_widths(evidence, rows))}"
    point = evidence.shown.format_point(rows)
    over = f"At {point}, over" if point else "Over"
    return f"{over} {count}: {'; '.join([*_iter_chances(evidence, pair, where), needs])}."


def _list_drawn_types(evidence: GapEvidence, pair: tuple[str, str]) -> dict[str, str]:
    """Return the building types of which the question drew several, by the places of a pair where they stand."""
    results = evidence.results
    if NEIGHBOURS_TABLE not in results.answers:
        return {}
    type_by_place = dict(zip(results.study_data["places"], results.study_data["group"], strict=True))
    drawn_types = list_drawn_names(results, results.answer(NEIGHBOURS_TABLE))
    return {place: type_by_place[place] for place in pair if type_by_place[place] in drawn_types}


def _select_rows(evidence: GapEvidence, pair: tuple[str, str]) -> pd.DataFrame:
    """Return the rows of a pair in NEIGHBOURS_TABLE, elastic first."""
    return evidence.select_pair(evidence.shown.rows_here(evidence.results.answer(NEIGHBOURS_TABLE).frame), pair)


def _iter_chances(evidence: GapEvidence, pair: tuple[str, str], where: str) -> Iterator[str]:
    """Yield how likely each gap of the cases is enough: "40 mm is enough with a probability of 0.8 (0.6 to 0.9)"."""
    judged = evidence.results.answer(NEIGHBOUR_CASES_TABLE)
    column = judged.column("enough")
    cases = evidence.select_pair(evidence.shown.rows_here(judged.frame), pair)
    names_cases = len(set(cases["case"])) > 1
    for (case, gap), of_case in cases.groupby(["case", "gap"], sort=False):
        chances = ", ".join(
            f"{column.format_with_unit(row)} {_describe_kind(row, number)}"
            for number, row in enumerate(of_case.to_dict("records"))
        )
        named = f" ({case})" if names_cases else ""
        yield f"{evidence.unit.text(gap)}{named} is enough {where}with a probability of {chances}"


def _iter_widths(evidence: GapEvidence, rows: pd.DataFrame) -> Iterator[str]:
    """Yield the gaps for NEIGHBOUR_SHARES in each analysis."""
    for number, row in enumerate(rows.to_dict("records")):
        gaps = [format_number(row[name_enough(share)] / evidence.unit.factor, 3) for share in NEIGHBOUR_SHARES]
        yield f"{', '.join(gaps)} {evidence.unit.name} {_describe_kind(row, number)}"


def _describe_kind(row: Row, number: int) -> str:
    return f"as {_KINDS[row['analysis']]} {'ones' if number else 'buildings'}"


def describe_neighbour_spread(evidence: GapEvidence, pair: tuple[str, str]) -> str:
    """Return what the neighbour adds to the scatter of the required gap; "" where nothing is known of it."""
    types = _list_drawn_types(evidence, pair)
    if not types:
        return ""
    neighbours = "the neighbour" if len(types) == 1 else "both buildings"
    rows = _select_rows(evidence, pair)
    rows = rows[rows["spread"].notna()]
    parts = [
        f"{format_number(row['spread_motions'], 2)} over the motions and {format_number(row['spread_neighbours'], 2)} "
        f"over {neighbours}, {format_number(row['spread'], 2)} in all, {_describe_kind(row, number)}"
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
        rates = ["rate"] if judged.frame["rate"].notna().any() else []
        tables.append(judged.view(*keys, "case", _PAIR, "analysis", "gap", "enough", *rates, caption=caption))
    return tables


def note_median(results: ResultTables) -> str:
    """Return which neighbour all other numbers are of; "" where all buildings are certain."""
    if NEIGHBOURS_TABLE not in results.answers:
        return ""
    names = list_drawn_names(results, results.answer(NEIGHBOURS_TABLE))
    has_rates = results.answer(NEIGHBOUR_CASES_TABLE).frame["rate"].notna().any()
    rates = f"Annual rates are over what {join_limited(names, last=' and ')} may be too; all" if has_rates else "All"
    is_one = len(names) == 1
    return (
        f"{rates} other numbers but the first ones are of the median {'building' if is_one else 'buildings'}, which "
        f"`pound run` simulates. `pound check` lists {'its' if is_one else 'their'} numbers with their sources."
    )
