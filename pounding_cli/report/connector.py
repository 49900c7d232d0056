"""The report of `pound connector`: Fig. 5 in the paper's form, the statements on Figs 4 and 5, references."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from matplotlib.figure import Figure

from pounding_cli.report.answer_page import AnswerPage, Illustration
from pounding_cli.report.citations import Use
from pounding_cli.report.evidence import Evidence
from pounding_cli.report.statements import CAPTION, Statement, judged
from pounding_cli.report.style import caption, entitle, new_figure, styled
from pounding_cli.store import Results
from pounding_cli.store.points import Point, read_points

_COLORS = ("#000000", "#0072B2")
_PANELS = 12


def connector_page(results: Results, shown: Evidence | None, with_figures: bool = True) -> AnswerPage:
    """What the report of two connected oscillators says."""
    figures = {}
    if with_figures:
        heading = "Largest displacements over those alone, against the frequency of the ground"
        text = "|R1| and |R2| against Omega / omega10, one panel a point of the sweep."
        figures["ratios"] = Illustration(draw_ratios(results, list(read_points(results, _PANELS))), heading, text)
    return AnswerPage("Against the paper", [], figures, [(CAPTION, judged(results, STATEMENTS))])


@styled
def draw_ratios(results: Results, points: Sequence[Point]) -> Figure:
    """One panel a point of the sweep, |R1| solid and |R2| dashed."""
    columns = min(len(points), 3)
    rows = -(-len(points) // columns)
    figure = new_figure(3.6 * columns + 0.6, 3.0 * rows + 0.9)
    panels = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True).ravel()
    for ax, (_, label, point) in zip(panels, points, strict=False):
        ax.set_title(label or "response ratios", loc="left")
        if point["status"] != "done":
            continue
        x = point["frequency"]
        for which, dash in ((1, "-"), (2, (0, (5, 2)))):
            y = point[f"R{which}"]
            ax.plot(x, y, color=_COLORS[which - 1], linestyle=dash, lw=1.6, label=f"system {which}")
        for low, high in point["both_above"]:
            ax.axvspan(low, high, color="0.88", zorder=0)
        for name in ("frequency_low", "frequency_high"):
            if x[0] < point[name] < x[-1]:
                ax.axvline(point[name], color="#AA2211", lw=0.9, linestyle=(0, (1, 1.5)))
        ax.axhline(1, color="0.35", lw=1.0, zorder=1)
        ax.set(
            xlabel="Ω / ω₁₀",
            ylabel="largest displacement over that alone",
            xlim=(x[0], x[-1]),
            ylim=(0, None),
        )
    for ax in panels[len(points) :]:
        ax.axis("off")
    panels[0].legend(loc="upper right")
    entitle(figure, results.title, "bold")
    note = "Grey: both ratios exceed one. Dotted: frequencies of the connected pair."
    if (count := math.prod(map(len, results.axes.values()))) > len(points):
        note += f" The first {len(points)} of {count} points of the sweep."
    caption(figure, note)
    return figure


def _frequencies(point: Mapping[str, Any]) -> tuple[bool, str]:
    low, high, p = point["frequency_low"], point["frequency_high"], point["p"]
    words = f"{low:.4f} and {high:.4f}, uncoupled 1 and {p:.4f} (over omega10)"
    return min(1, p) <= low <= max(1, p) <= high, words


def _opposites(point: Mapping[str, Any]) -> tuple[bool, str]:
    bands = ", ".join(f"{low:.3f}-{high:.3f}" for low, high in point["both_above"])
    return not bands, (
        f"both largest displacements grow in: {bands or 'nowhere'}; |R1| peaks at {point['peak1']:.2f} "
        f"(Omega/omega10 = {point['at1']:.2f}), |R2| at {point['peak2']:.2f} ({point['at2']:.2f}). It holds for the "
        "signed real ratios of undamped systems: m1 R1 + m2 R2 = m1 + m2."
    )


STATEMENTS: Sequence[Statement] = (
    ("The lowest frequency lies between the uncoupled ones, the other above both.", _frequencies),
    ("Whenever the response of one system increases, that of the other decreases.", _opposites),
)


def cite_connector(resolved: Mapping[str, Any], used: Use) -> None:
    """The references of `pound connector`."""
    used("spiliopoulos1996", "two connected oscillators, Figs 4 and 5")
    used("westermo1989", "connecting buildings")
    if resolved["connector"]["damping_ratio"]:
        used("anagnostopoulos1988", "the connector's dashpot, eq. (7)")
