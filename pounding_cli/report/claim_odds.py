"""How likely each claim of the paper holds where its inputs are uncertain: sentences, tables and the figure."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from pounding_cli.report.claim_samples import ODDS, OUTCOMES, THRESHOLDS
from pounding_cli.report.claims import CLAIMS, Finding
from pounding_cli.report.document import Picture
from pounding_cli.report.evidence import Evidence, motion_sentence
from pounding_cli.report.style import caption, entitle, new_figure, styled
from pounding_cli.report.table import NOTHING, from_rows
from pounding_cli.results.tables import Table
from pounding_cli.workflows.indices import FOUND

if TYPE_CHECKING:
    from pounding_cli.results.results import Results

_COLORS = {"holds": "#0072B2", "partly": "#9CCBE8", "fails": "#E69F00"}

HEADS = ("claim", "holds", "holds partly", "does not hold", "decided most by")

_MEASURES = {
    "sobol": "total index (part of the variance that the key explains, with all its interactions)",
    "morris": "mean effect over its range",
}


def odds_tables(results: Results, method: str) -> tuple[list[Table], list[str]]:
    """The probability of each verdict with its interval in brackets and what decides it, the same of the numbers that
    have a threshold, at every point of the other swept keys; and what a reader should know of them."""
    odds, numbers = (results.answer(name).frame for name in (ODDS, THRESHOLDS))
    keys = [key for key in results.axes if key in odds]
    heads = [results.axis_label(key) for key in keys]
    rows = [
        [
            *(results.value_label(key, row[key]) for key in keys),
            str(row["claim"]), *(_interval(row, name) for name in OUTCOMES), _decided(row, _nothing(row)),
        ]
        for row in odds.to_dict("records")
    ]  # fmt: skip
    found = [from_rows("How likely each claim holds", [*heads, *HEADS], rows)]
    rows = []
    for row in numbers.to_dict("records"):
        low, middle, high = (Finding("", row[f"percentile_{part}"], row["unit"]).text for part in (5, 50, 95))
        where = [results.value_label(key, row[key]) for key in keys]
        told = [str(row["claim"]), str(row["number"]), _interval(row, "met"), f"{middle} ({low} to {high})"]
        rows.append([*where, *told, _decided(row, NOTHING)])
    heads += ["claim", "number", "meets its threshold", "median (5 % to 95 %)", "decided most by"]
    found.append(from_rows("The numbers of the claims", heads, rows))
    spec = results.resolved.get("sensitivity") or {}
    confidence = f"{100 * float(spec.get('confidence', 0.95)):.4g} %"
    notes = [
        f"Probabilities: shares of the {int(odds['samples'].max())} independent samples, in brackets the {confidence} "
        "interval (Clopper-Pearson). A claim holds if every number meets its threshold, holds partly where some do.",
        f"Decided most by: the key with the largest {_MEASURES[method]} of the verdict as "
        "a number, which is 1 where the claim holds, 1/2 where it holds partly and 0 where it does not; in brackets "
        f"the {confidence} bootstrap interval.",
    ]
    by_key = {claim.key: claim for claim in CLAIMS}
    return found, [*notes, *(f"{name}: {by_key[name].rule}" for name in dict.fromkeys(odds["claim"]) if name in by_key)]


def _interval(row: Mapping[Any, Any], name: str) -> str:
    """A probability with its interval."""
    if row[name] != row[name]:
        return NOTHING
    return f"{row[name]:.2f} ({row[f'{name}_low']:.2f} to {row[f'{name}_high']:.2f})"


def _nothing(row: Mapping[Any, Any]) -> str:
    """Why nothing decides a claim."""
    if row["failed"]:
        return f"no index: {row['failed']:.0f} samples failed"
    if not row["samples"]:
        return "not tested: the study lacks what it is about"
    return "nothing: one verdict at all samples" if max(row[name] for name in OUTCOMES) == 1 else "not known"


def _decided(row: Mapping[Any, Any], nothing: str) -> str:
    return f"{row['decided_by']}, {_interval(row, 'share')}" if row["decided_by"] else nothing


def odds_sentences(odds: pd.DataFrame) -> list[str]:
    """The claims by how likely they hold, in sentences."""
    known = odds[odds["samples"] > 0]
    held = known["holds"]
    groups = (
        ("Hold at every sample", held == 1),
        ("More likely to hold than not", (held > 0.5) & (held < 1)),
        ("As likely not to hold, or less likely to hold", (held <= 0.5) & (held > 0)),
        ("Hold at no sample", held == 0),
    )
    said = []
    for words, chosen in groups:
        mine = known[chosen].sort_values("holds", ascending=False, kind="stable")
        named = [
            str(row["claim"]) if row["holds"] in (0, 1) else f"{row['claim']} {row['holds']:.2f}"
            for row in mine.to_dict("records")
        ]
        if named:
            said.append(f"{words}: {', '.join(named)}.")
    return said + [f"{row['claim']}: {_nothing(row)}." for row in odds[odds["samples"] == 0].to_dict("records")]


def odds_pictures(odds: pd.DataFrame, indices: pd.DataFrame, shown: Evidence) -> list[Picture]:
    """The figure, at one point; `indices` : the rows of the table of indices that are about claims."""
    draw, text = partial(draw_odds, odds, indices, shown), " ".join(odds_sentences(odds))
    return [Picture("sensitivity-claims", "How likely each claim holds", text, draw)]


@styled
def draw_odds(odds: pd.DataFrame, indices: pd.DataFrame, shown: Evidence) -> Figure:
    """The probability of every verdict, a bar for each claim; beside it the index of every key.

    indices : the rows of the table of indices that are about claims
    """
    names = list(odds["claim"])[::-1]
    measure = "total" if "total" in indices else "mu_star"
    keys = list(dict.fromkeys(indices["key"]))
    figure = new_figure(6.4 + 0.42 * len(keys), 1.9 + 0.36 * len(names))
    bars, matrix = figure.subplots(1, 2, sharey=True, width_ratios=(4.2, 0.42 * len(keys) + 0.4))
    _bars(bars, odds.set_index("claim").loc[names], names)
    _matrix(matrix, indices, names, keys, measure)
    bars.legend(loc="lower left", bbox_to_anchor=(0, 1.0), ncols=3, fontsize=8, frameon=False)
    words = "total index (part of the variance)" if measure == "total" else "mean effect over the range of the key"
    matrix.set_title(f"What decides its verdict: {words}", loc="left", fontsize=9)
    entitle(figure, shown.title)
    caption(figure, f"Whiskers: interval of the probability that it holds. {motion_sentence(shown.records)}")
    return figure


def _bars(ax: Axes, odds: pd.DataFrame, names: Sequence[str]) -> None:
    y, left = np.arange(len(names)), np.zeros(len(names))
    for name, verdict in OUTCOMES.items():
        width = odds[name].fillna(0.0).to_numpy(float)
        ax.barh(y, width, left=left, height=0.6, color=_COLORS[name], label=str(verdict))
        left += width
    holds = odds["holds"].to_numpy(float)
    ends = np.maximum([holds - odds["holds_low"], odds["holds_high"] - holds], 0)
    ax.errorbar(holds, y, xerr=ends, ls="", color="0.15", lw=1.1, capsize=2.5)
    for place in np.flatnonzero(odds["samples"].to_numpy() == 0).tolist():
        ax.text(
            0.02, place, "not tested" if not odds["failed"].iloc[place] else "scenes failed", va="center", fontsize=8
        )
    ax.set_yticks(y, names)
    ax.set_xlim(0, 1)
    ax.set_ylim(-0.6, len(names) - 0.4)
    ax.grid(False, axis="y")
    ax.set_xlabel("probability")


def _matrix(ax: Axes, indices: pd.DataFrame, names: Sequence[str], keys: Sequence[str], measure: str) -> None:
    found = indices[indices["outcome"] == FOUND]
    values = found.set_index(["output", "key"])[measure].clip(lower=0)
    top = max(1.0, float(values.max())) if len(values) else 1.0
    for row, name in enumerate(names):
        for column, key in enumerate(keys):
            value = values.get((f"claim {name}", key), np.nan)
            if value == value:
                ax.text(column, row, f"{value:.2f}", ha="center", va="center", fontsize=7, color=_ink(value / top))
                ax.add_patch(_cell(column, row, value / top))
        if (f"claim {name}", keys[0]) not in values.index:
            ax.text(-0.35, row, "one verdict at all samples", va="center", fontsize=7, color="0.45")
    ax.set_xticks(range(len(keys)), keys, rotation=40, ha="right", fontsize=7)
    ax.set_xlim(-0.5, len(keys) - 0.5)
    ax.tick_params(axis="y", length=0)
    ax.grid(False)


def _ink(share: float) -> str:
    return "white" if share > 0.55 else "0.2"


def _cell(column: int, row: int, share: float) -> Rectangle:
    color = (1 - 0.9 * share, 1 - 0.55 * share, 1 - 0.3 * share)
    return Rectangle((column - 0.47, row - 0.3), 0.94, 0.6, color=color, lw=0, zorder=0.5)
