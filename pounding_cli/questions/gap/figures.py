"""The figure of `pound gap`: required gaps over the height, of every motion and by rules."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from pounding_cli.model.separation import E030, NBC202, NTC2008, TBDY2018
from pounding_cli.questions.gap.evidence import PLACE_KEYS, GapEvidence
from pounding_cli.questions.gap.neighbour_figures import draw_probabilities
from pounding_cli.questions.gap.neighbour_words import describe_neighbours
from pounding_cli.questions.gap.sentences import list_sentences
from pounding_cli.questions.gap.tables import EXACT, GAP_CONFIDENCE, NEIGHBOURS_TABLE
from pounding_cli.records.code_spectra import ASCE7, EN1998, GB50011, NTC2018
from pounding_cli.report.document import Picture
from pounding_cli.report.evidence import describe_motions
from pounding_cli.report.style import finish, grid, shared_legend, with_style

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from pounding_cli.numbers import Unit
    from pounding_cli.results.results import ResultTables

_LOOKS = {
    EXACT: ("#000000", "-", "o"),
    "ABS": ("#E69F00", (0, (5, 2)), "^"),
    "SRSS": ("#0072B2", (0, (5, 2)), "s"),
    "DDC": ("#009E73", (0, (5, 1.5, 1, 1.5)), "D"),
    ASCE7: ("#CC79A7", (0, (1, 1.2)), "v"),
    EN1998: ("#56B4E9", (0, (1, 1.2)), "<"),
    GB50011: ("#AA2211", (0, (1, 1.2)), "P"),
    NTC2018: ("#117733", (0, (1, 1.2)), ">"),
    NTC2008: ("#999933", (0, (1, 1.2)), ">"),
    TBDY2018: ("#332288", (0, (1, 1.2)), "d"),
    E030: ("#AA4499", (0, (1, 1.2)), "p"),
    NBC202: ("#44AA99", (0, (1, 1.2)), "*"),
}
"""Rule -> colour, line and marker."""

_UBC_LOOK = ("#666666", (0, (3, 1)), "X")
"""Of the edition of the UBC."""

_CONTACT_COLOR = "#56B4E9"


def list_figures(results: ResultTables) -> list[Picture]:
    """Return the required gaps over the height, behind how likely gaps are enough beside a neighbour that is only seen;
    nothing where no run has a result at the point that is shown."""
    evidence = GapEvidence(results)
    is_exact = evidence.gaps["rule"] == EXACT
    if not evidence.gaps.loc[is_exact, "mean"].notna().any():
        return []
    text = " ".join(list_sentences(results))
    pictures = [Picture("required-gap", "Required gap over the height", text, partial(draw_profiles, evidence))]
    if NEIGHBOURS_TABLE in results.answers:
        text = " ".join(describe_neighbours(evidence, pair) for pair in evidence.pairs)
        draw = partial(draw_probabilities, evidence)
        pictures.insert(0, Picture("gap-probability", "Probability that a gap is enough", text, draw))
    return pictures


@with_style
def draw_profiles(evidence: GapEvidence) -> Figure:
    """Draw gaps across, height upwards: a panel for each pair of neighbours and analysis."""
    unit = evidence.unit
    contact = next(name for name in map(str, evidence.gaps) if name.startswith("contact_"))
    panels = _select_governing_ends(evidence.gaps).groupby(["left", "right", "analysis"], sort=False)
    figure, axes = grid(len(panels), 3.6, 3.4, "height of the floors [m]", sharey=True, sharex=True)
    for ax, ((left, right, analysis), rows) in zip(axes, panels, strict=True):
        _draw_motions(ax, _find_closings(evidence, rows), unit)
        for rule, of_rule in rows.sort_values("height").groupby("rule", sort=False):
            _draw_rule(ax, str(rule), of_rule, unit)
        _draw_contact(ax, contact, rows[rows["rule"] == EXACT].sort_values("height"), unit)
        ax.set_title(f"{left} | {right}, {analysis}", loc="left")
        ax.set_xlabel(unit.label("gap"))
    axes[0].set_ylim(0, None)  # of all panels, after the tallest pair
    widest = evidence.gaps[["largest", contact]].max().max() / unit.factor
    axes[0].set_xlim(0, 1.25 * widest if widest > 0 else None)  # a wide interval of confidence leaves the panel
    shared_legend(figure, axes)
    finish(figure, evidence.results.title, _describe_figure(evidence))
    return figure


def _select_governing_ends(gaps: pd.DataFrame) -> pd.DataFrame:
    """Return the rows of the ends, of floors that twist, at which these need most on average; all of others."""
    if "end" not in gaps:
        return gaps
    keys = ["left", "right", "analysis", *(key for key in PLACE_KEYS if key != "end")]
    exact = gaps[(gaps["rule"] == EXACT) & gaps["mean"].notna()]
    governing = exact.loc[exact.groupby(keys, sort=False)["mean"].idxmax(), [*keys, "end"]]
    return gaps.merge(governing, on=[*keys, "end"])


def _describe_figure(evidence: GapEvidence) -> str:
    """Return what the lines of the figure are."""
    where = f"At {evidence.shown.label}. " if evidence.shown.label else ""
    lines = f"Grey: every motion, exact. Lines: mean over the motions. Band: {100 * GAP_CONFIDENCE:.0f} % confidence."
    if "end" in evidence.gaps and evidence.gaps["end"].any():
        lines += " At every height the end of the shared edge that needs most."
    return f"{where}{lines} {describe_motions(evidence.shown.records)}"


def _find_closings(evidence: GapEvidence, rows: pd.DataFrame) -> pd.DataFrame:
    """Return of every motion the largest closing at every height of a pair and analysis, by height.

    rows : of GAP_TABLE, of this pair and analysis
    """
    link = evidence.shown.link
    if "left_at" not in link:
        link = link.assign(left_at=1.0, right_at=1.0)
    sides = np.select([link["left_at"] < 1, link["right_at"] < 1], ["left", "right"], "")
    keys = ["left", "right", "analysis", *(key for key in PLACE_KEYS if key != "end")]
    facing = rows[[*keys, "height"]].drop_duplicates()
    closings = link.assign(columns=sides).merge(facing, on=keys)
    places = closings.groupby(["record", "height"], sort=False)
    largest: pd.DataFrame = places.agg({"max_closing": "max"}).reset_index()  # of both ends
    return largest.sort_values("height")


def _draw_motions(ax: Axes, closings: pd.DataFrame, unit: Unit) -> None:
    """Draw a thin line for every motion."""
    for _, motion in closings.groupby("record", sort=False):
        ax.plot(motion["max_closing"] / unit.factor, motion["height"], color="0.75", lw=0.7, zorder=2)


def _draw_rule(ax: Axes, rule: str, rows: pd.DataFrame, unit: Unit) -> None:
    """Draw the mean over the motions by a rule.

    rows : of the rule, by height
    """
    color, line, marker = _LOOKS.get(rule, _UBC_LOOK)
    is_exact = rule == EXACT
    ax.plot(
        rows["mean"] / unit.factor, rows["height"], color=color, ls=line, marker=marker,
        ms=4.5 if is_exact else 3.5, lw=2.2 if is_exact else 1.3, zorder=4 if is_exact else 3,
        label="exact, mean" if is_exact else rule,
    )  # fmt: skip


def _draw_contact(ax: Axes, contact: str, rows: pd.DataFrame, unit: Unit) -> None:
    """Draw the gap for a probability of contact with its interval.

    contact : column of this gap
    rows : exact ones, by height
    """
    if not rows[contact].notna().any():
        return
    low = rows[f"{contact}_low"] / unit.factor
    high = rows[f"{contact}_high"] / unit.factor
    ax.fill_betweenx(rows["height"], low, high, color=_CONTACT_COLOR, alpha=0.2, lw=0, zorder=1)
    label = f"exact, contact {contact.removeprefix('contact_')} %"
    ax.plot(rows[contact] / unit.factor, rows["height"], color=_CONTACT_COLOR, lw=1.8, zorder=3.5, label=label)
