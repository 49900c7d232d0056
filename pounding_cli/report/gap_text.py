"""The required separations in rows that people read: the floors that need most, widths in the unit of the study."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from pounding_cli.model.separation import ASCE7, EN1998
from pounding_cli.numbers import Unit, counted
from pounding_cli.store import Results
from pounding_cli.store.answers import Answer
from pounding_cli.store.gap import CONFIDENCE, EXACT, FEWEST
from pounding_cli.study.file import parse

Part = tuple[dict[str, Any], str, str, pd.DataFrame]
"""Point of the sweep, left and right building, and the rows of the floors that need most."""


_RESTS_ON = {
    ASCE7: "ASCE/SEI 7-16, 12.12.3: delta_M = Cd delta_max / Ie of every building; SRSS of both for a pair, delta_M "
    "itself for a property line. delta_max: static displacement under the forces of `base_shear`, not under the "
    "motions.",
    EN1998: "EN 1998-1:2004, 4.4.2.7: d_s = q_d d_e of every building; SRSS of both for a pair on one property, times "
    "0.7 where the floors have the same elevations; d_s itself for a property line. d_e: static displacement under the "
    "forces of `base_shear`, not under the motions.",
}


def governing(frame: pd.DataFrame, keys: Sequence[str]) -> list[Part]:
    """Of every point of the sweep and pair of neighbours the rows of the floors whose exact mean is largest, by
    analysis.

    frame : of the table `gap`; keys : swept keys
    """
    exact = frame[(frame["rule"] == EXACT) & frame["mean"].notna()]
    among = [*keys, "left", "right", "analysis"]
    most = exact.loc[exact.groupby(among, sort=False)["mean"].idxmax(), [*among, "floor", "right_floor", "columns"]]
    rows = frame.merge(most, on=list(most.columns))
    found = []
    for _, part in rows.groupby([*keys, "left", "right"], sort=False):
        first = part.iloc[0]
        found.append(({key: first[key] for key in keys}, str(first["left"]), str(first["right"]), part))
    return found


def width_unit(answer: Answer) -> Unit:
    """The unit of widths."""
    return answer.units["mean"]


def contact_columns(answer: Answer) -> list[str]:
    """The columns of gaps for a probability of contact."""
    return [n for n in answer.meanings if n.startswith("contact_") and not n.endswith(("_low", "_high"))]


def _columns(answer: Answer) -> dict[str, str]:
    """Columns that are shown and their headings."""
    found = {"mean": "mean", "mean_plus_std": "mean + sigma", "largest": "largest"}
    shares = [name for name in answer.meanings if name.startswith("percentile_")]
    found |= {name: f"{name.removeprefix('percentile_')} %" for name in shares}
    return found | {name: f"contact {name.removeprefix('contact_')} %" for name in contact_columns(answer)}


def headings(answer: Answer) -> list[str]:
    """Headings of the rows of `numbers`; widths in `width_unit`."""
    unit = width_unit(answer).name
    return ["analysis", "rule", *(f"{heading}\n[{unit}]" for heading in _columns(answer).values()), "mean over\nexact"]


def numbers(answer: Answer, rows: pd.DataFrame) -> list[list[str]]:
    """The rows as texts; beside an exact width for a probability of contact its confidence interval."""
    unit, found = width_unit(answer), []
    for row in rows.to_dict("records"):
        cells = [str(row["analysis"]), str(row["rule"])]
        for name in _columns(answer):
            cells.append(_text(row[name], unit))
            if row["rule"] == EXACT and name.startswith("contact_") and row[f"{name}_low"] == row[f"{name}_low"]:
                cells[-1] += f" ({_text(row[name + '_low'], unit, 3)} to {_text(row[name + '_high'], unit, 3)})"
        found.append([*cells, f"{row['over_exact']:.3f}" if row["over_exact"] == row["over_exact"] else "-"])
    return found


def error_sentence(answer: Answer, error: float) -> str:
    """How wrong the widths may be, in words; `error`: the largest numerical error of one [m]."""
    if error != error:
        return "The numerical error was not estimated (estimate: none)."
    return f"No width has a numerical error above {width_unit(answer).text(error, 2)}."


def interval_sentence(frame: pd.DataFrame) -> str:
    """What stands in brackets, or why nothing does; "" where there is nothing.

    frame : of the table `gap` or `property_line`
    """
    motions = frame.loc[frame["rule"] == EXACT, "motions"]
    if not len(motions):
        return ""
    few, said = int(motions.min()), []
    if int(motions.max()) >= FEWEST:
        said.append(f"In brackets: {CONFIDENCE:.0%} confidence.")
    if few < FEWEST:
        verb = "is" if few == 1 else "are"
        said.append(
            f"No confidence interval for fewer than {FEWEST} motions: {counted(few, 'motion')} {verb} too few to tell "
            "how much the gap varies from motion to motion."
        )
    return " ".join(said)


def case_headings(cases: Answer) -> list[str]:
    """Headings of the rows of `case_rows`."""
    unit = cases.units["gap"].name
    return ["case", "analysis", "rule", f"gap\n[{unit}]", f"required\n[{unit}]", "enough", "for motions"]


def case_rows(cases: Answer, frame: pd.DataFrame) -> list[list[str]]:
    """The rows of the table `gap_cases` as texts."""
    return [
        [
            str(row["case"]), str(row["analysis"]), str(row["rule"]), _text(row["gap"], cases.units["gap"]),
            _text(row["required"], cases.units["gap"]), str(row["enough"]),
            f"{row['enough_for']} of {row['motions']}" if row["motions"] else "-",
        ]
        for row in frame.to_dict("records")
    ]  # fmt: skip


def cases_at(
    frame: pd.DataFrame, point: Mapping[str, Any], left: str, right: str, most: int
) -> tuple[pd.DataFrame, int]:
    """The rows of a pair of neighbours at a point, of its first `most` gaps, and how many gaps it has.

    frame : of the table `gap_cases`
    """
    here = frame[(frame["left"] == left) & (frame["right"] == right)]
    for key, value in point.items():
        if key in here:
            here = here[here[key] == value]
    starts = (here["rule"] == EXACT) & (here["analysis"] == here["analysis"].iloc[0] if len(here) else False)
    number = starts.cumsum()
    return here[number <= most], int(number.max()) if len(here) else 0


def case_sentences(cases: Answer, frame: pd.DataFrame) -> list[str]:
    """Whether each gap is enough, by what the motions require.

    frame : rows of the table `gap_cases`, one point of the sweep
    """
    said: dict[str, list[str]] = {}
    head = ""
    for row in frame[frame["rule"] == EXACT].to_dict("records"):
        if row["analysis"] == frame["analysis"].iloc[0]:
            gap = cases.units["gap"].text(row["gap"], 4)
            head = f"Case {row['case']}, {row['left']} | {row['right']}: gap {gap}"
        word = {"yes": "enough", "no": "not enough"}.get(row["enough"], "not known, as scenes failed")
        said.setdefault(head, []).append(
            f"{row['analysis']} {word} ({row['enough_for']} of {counted(int(row['motions']), 'motion')})"
        )
    return [f"{head}: {', '.join(words)}." for head, words in said.items()]


def case_notes(results: Results, frame: pd.DataFrame) -> list[str]:
    """What "enough" means, and which cases are not compared.

    frame : of the table `gap_cases`
    """
    notes = []
    if len(frame):
        notes.append(
            "Enough: at every floor with a link in the case the gap is no narrower than what the rule requires, under "
            "every motion. Each building moves alone."
        )
        if len(results.resolved["places"]) > 2:
            notes.append(
                "A building between two others moves alone only while neither of them strikes it. Where the gap on one "
                "side is not enough, the answer for the other side does not hold."
            )
    written = parse(results.study_text, str(results.path)).get("cases")
    others = [case for case in written or () if case not in set(frame["case"])]
    if others:
        notes.append(
            f"Not compared: {', '.join(others)}. There is no link, or one that acts before the gap has closed, so that "
            "the buildings do not move alone; `pound run` simulates them."
        )
    return notes


def code_notes(results: Results) -> list[str]:
    """What the rules of codes with a displacement of every building rest on, and which keys they lack."""
    resolved, notes, said = results.resolved, list[str](), list[str]()
    needs = {ASCE7: ("Cd", "Ie"), EN1998: ("qd",)}
    for rule, keys in needs.items():
        wanted: dict[str, list[str]] = {}
        for name in dict.fromkeys(resolved["group"]):
            building = resolved["buildings"][name]
            own = building["yield"] if building["yield_shear"] is None else {}
            lacks = [key for key in ("base_shear", *keys) if own.get(key) is None]
            if lacks:
                wanted.setdefault(", ".join(f"`{key}`" for key in lacks), []).append(name)
        if wanted:
            words = " and ".join(f"{keys} of {', '.join(names)}" for keys, names in wanted.items())
            said.append(f"{rule} (lacks {words})")
        else:
            notes.append(_RESTS_ON[rule])
    if said:
        notes.append(
            f"Not evaluated: {', '.join(said)}. Write these keys under `yield` of the building, e.g. "
            "`yield: {base_shear: 0.10 W, distribution: asce7, Cd: 5.5, Ie: 1, qd: 3.9}`."
        )
    return notes


def line_headings(answer: Answer) -> list[str]:
    """Headings of the rows of `line_rows`."""
    return ["building", "side", "floor", *(words.replace("contact", "reached") for words in headings(answer))]


def line_rows(answer: Answer, frame: pd.DataFrame) -> list[list[str]]:
    """Distances to a property line as texts: of every building and side the floor that moves most."""
    keys = ["building", "side", "analysis"]
    exact = frame[(frame["rule"] == EXACT) & frame["mean"].notna()]
    most = exact.loc[exact.groupby(keys, sort=False)["mean"].idxmax(), [*keys, "floor"]]
    rows = frame.merge(most, on=[*keys, "floor"]).sort_values(["building", "side"], kind="stable", key=_in_order)
    places = rows[["building", "side", "floor"]].astype(str).to_numpy().tolist()
    return [[*place, *words] for place, words in zip(places, numbers(answer, rows), strict=True)]


def _in_order(column: pd.Series) -> pd.Series:
    """A column by the order in which its values come."""
    return column.map({value: place for place, value in enumerate(dict.fromkeys(column))})


def _text(value: float, unit: Unit, digits: int = 4) -> str:
    return f"{unit.number(value):#.{digits}g}".rstrip(".") if value == value else "-"


def pair_heading(results: Results, point: Mapping[str, Any], left: str, right: str, rows: pd.DataFrame) -> str:
    """Which floors of which buildings, and where on the sweep."""
    pairs = dict.fromkeys(zip(rows["floor"], rows["right_floor"], rows["columns"], strict=True))
    names = {"left": left, "right": right}
    floors = [
        f"floor {other if side == 'left' else one} beside columns of {names[side]} in storey "
        f"{one if side == 'left' else other}"
        if side
        else f"floor {one}" if one == other else f"floors {one} and {other}"
        for one, other, side in pairs
    ]  # fmt: skip
    swept = ", ".join(f"{key} = {results.value_label(key, value)}" for key, value in point.items())
    return f"{left} | {right}, {' or '.join(floors)}" + (f", {swept}" if swept else "")
