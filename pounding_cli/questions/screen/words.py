"""The texts of `pound screen`: its answer in sentences, its table, and notes on the numbers."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.numbers import NOTHING, format_number, pluralize
from pounding_cli.questions.hazard import YEARS
from pounding_cli.questions.screen.tables import MIN_SCREENED_GAP, RETURN_PERIOD, SCREEN_TABLE
from pounding_cli.tables import Column, Table

if TYPE_CHECKING:
    import pandas as pd

    from pounding_cli.results.results import ResultTables

MAX_SHOWN = 20
"""Pairs that a terminal prints."""


def describe_scope(results: ResultTables) -> str:
    """Return in one line what was computed."""
    frame = results.answer(SCREEN_TABLE).frame
    pairs = pluralize(len(frame), "pair")
    return f"{pairs} of neighbours, {pluralize(int(frame['neighbours'].max()), 'building')} that each may be, " + (
        f"{pluralize(int(frame['motions'].max()), 'motion')}: an answer for each pair."
    )


def list_sentences(results: ResultTables) -> list[str]:
    """Return how many pairs will probably strike, which is the worst, and what decides most often."""
    table = results.answer(SCREEN_TABLE)
    frame = table.frame
    likely = int((frame["probability"] > 0.5).sum())
    count = f"{likely} of {pluralize(len(frame), 'pair')}" if len(frame) > 1 else "The pair"
    if len(frame) == 1:
        count = "The pair will probably" if likely else "The pair will probably not"
        first = f"{count} strike within {YEARS:g} years"
    elif likely:
        first = f"{count} will probably strike within {YEARS:g} years"
    else:
        first = f"None of {pluralize(len(frame), 'pair')} will probably strike within {YEARS:g} years"
    sentences = [f"{first}; {_describe_worst(table)}"]
    if len(frame) > 1 and (common := _describe_common(frame)):
        sentences.append(common)
    if failed := int(frame["rate"].isna().sum()):
        sentences.append(f"{pluralize(failed, 'pair has', 'pairs have')} no rate, as time histories failed.")
    return sentences


def _describe_worst(table: Table) -> str:
    """Return the end of a sentence about the pair that strikes most often."""
    row: dict[Any, Any] = table.frame.iloc[0].to_dict()
    if not np.isfinite(row["rate"]):
        return "no rate is known."
    gap = table.column("gap").format_with_unit(row)
    rate = table.column("rate").format(row["rate"])
    probability = table.column("probability").format_with_unit(row)
    subject = "the worst is" if len(table.frame) > 1 else "it is"
    sentence = (
        f"{subject} {row['pair']} ({row['left']} and {row['right']} storeys, gap {gap}), with an annual rate of "
        f"contact of {rate} ({probability} in {YEARS:g} years)"
    )
    if row["decides"]:
        share = format_number(100 * row["share"], 2)
        of_motions = format_number(100 * row["motion_share"], 2)
        sentence += (
            f". Of what nobody knows of its buildings, the {row['decides']} building decides most ({share} % of the "
            f"variance of the closing; which earthquake comes: {of_motions} %)"
        )
    return f"{sentence}."


def _describe_common(frame: pd.DataFrame) -> str:
    """Return what decides most often, of whichever building; "" where nothing does of any pair."""
    decided = frame.loc[frame["decides"] != "", "decides"]
    if decided.empty:
        return ""
    counts = decided.str.partition(" of the ")[0].value_counts()
    quantity = str(counts.index[0])
    return (
        f"What most often decides is a {quantity} that nobody knows: of {counts.iloc[0]} of "
        f"{pluralize(len(frame), 'pair')}, so that knowing it sharpens the answer most."
    )


def list_tables(results: ResultTables) -> list[Table]:
    """Return the pairs that strike most often, as a terminal prints them."""
    table = results.answer(SCREEN_TABLE)
    frame = table.frame.head(MAX_SHOWN)
    decides = Column("decides", "what decides", write=_shorten_decision)
    columns: list[str | Column] = [
        "pair",
        replace(table.column("left"), optional=True),
        replace(table.column("right"), optional=True),
        "gap",
        replace(table.column("rate"), low="", high=""),
        replace(table.column("probability"), label="50 years", optional=True),
        replace(table.column("enough"), label="enough"),
        decides,
    ]
    caption = "Pairs of neighbours, by their rate of contact"
    if len(table.frame) > MAX_SHOWN:
        caption += f": the first {MAX_SHOWN} of {len(table.frame)}"
    return [table.view(*columns, frame=frame, caption=caption)]


def _shorten_decision(row: Any) -> str:
    """Return what decides in a cell: "period, right"."""
    return str(row["decides"]).replace(" of the ", ", ") or NOTHING


def list_notes(results: ResultTables) -> list[str]:
    """Return what the numbers are over, and what they leave out."""
    frame = results.answer(SCREEN_TABLE).frame
    neighbours = int(frame["neighbours"].max())
    motions = int(frame["motions"].min())
    levels = len(next(iter(results.axes.values()), [0]))
    notes = [
        f"Rates are over {pluralize(motions, 'motion')} at {pluralize(levels, 'peak acceleration')} and over "
        f"{pluralize(neighbours, 'building')} that each neighbour may be. `enough`: the probability that the gap is "
        f"enough at the acceleration with a return period of {RETURN_PERIOD:g} years.",
        "The buildings move alone until they touch, on firm ground, as shear buildings of their HAZUS type without "
        "twist. A screen says where to look: `pound screen TABLE --pair NAME` prints the study of a pair, for "
        "`pound gap` and `pound run`. The file holds the time histories of the worst pair.",
    ]
    if (frame["gap"] < MIN_SCREENED_GAP).any():
        notes.append("Neighbours that touch strike in every earthquake: their rate is that of a closing of 1 mm.")
    return notes
