"""Fig. 5: the numbers of two connected oscillators, what the paper says of them, both ratios over frequency."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from pounding_cli.connector.oscillators import ConnectorStudy
from pounding_cli.points import Point
from pounding_cli.report.style import caption, entitle, new_figure, styled
from pounding_cli.study.axes import SweepAxis
from pounding_cli.variables import Variable

_OVER = ("frequency",)
VARIABLES = (
    Variable("peak1", (), "1", "largest ratio of system 1"),
    Variable("at1", (), "1", "Omega / omega10 at the peak of system 1"),
    Variable("peak2", (), "1", "largest ratio of system 2"),
    Variable("at2", (), "1", "Omega / omega10 at the peak of system 2"),
    Variable("frequency_low", (), "1", "lower coupled frequency over omega10"),
    Variable("frequency_high", (), "1", "higher coupled frequency over omega10"),
    Variable("p", (), "1", "omega20 / omega10"),
    Variable("frequency", _OVER, "1", "Omega / omega10"),
    Variable("R1", _OVER, "1", "displacement of system 1, connected over alone"),
    Variable("R1_real", _OVER, "1", "displacement of system 1, connected over alone, real part"),
    Variable("R1_imag", _OVER, "1", "displacement of system 1, connected over alone, imaginary part"),
    Variable("R2", _OVER, "1", "displacement of system 2, connected over alone"),
    Variable("R2_real", _OVER, "1", "displacement of system 2, connected over alone, real part"),
    Variable("R2_imag", _OVER, "1", "displacement of system 2, connected over alone, imaginary part"),
    Variable("both_above", ("band", "edge"), "1", "bands of Omega / omega10 in which both ratios exceed one"),
)
"""What the results file holds; those without dimensions are numbers of the table."""

_PANELS = 12


def _bands(point: Mapping[str, Any]) -> str:
    return ", ".join(f"{low:.3f}-{high:.3f}" for low, high in point["both_above"]) or "nowhere"


def lines(point: Mapping[str, Any]) -> list[str]:
    """What is printed of a point."""
    return [
        f"|R1| at most {point['peak1']:.3f} at Omega/omega10 = {point['at1']:.3f}",
        f"|R2| at most {point['peak2']:.3f} at Omega/omega10 = {point['at2']:.3f}",
        f"coupled frequencies over omega10: {point['frequency_low']:.4f}, {point['frequency_high']:.4f} "
        f"(alone: 1, {point['p']:.4f})",
        f"both ratios exceed 1 in: {_bands(point)}",
    ]


def _frequencies(point: Mapping[str, Any]) -> tuple[bool, str]:
    low, high, p = point["frequency_low"], point["frequency_high"], point["p"]
    words = f"{low:.4f} and {high:.4f}, uncoupled 1 and {p:.4f} (over omega10)"
    return min(1, p) <= low <= max(1, p) <= high, words


def _opposites(point: Mapping[str, Any]) -> tuple[bool, str]:
    return not len(point["both_above"]), (
        f"both largest displacements grow in: {_bands(point)}; |R1| peaks at {point['peak1']:.2f} "
        f"(Omega/omega10 = {point['at1']:.2f}), |R2| at {point['peak2']:.2f} ({point['at2']:.2f}). It holds for the "
        "signed real ratios of undamped systems: m1 R1 + m2 R2 = m1 + m2."
    )


STATEMENTS = (
    ("The lowest frequency lies between the uncoupled ones, the other above both.", _frequencies),
    ("Whenever the response of one system increases, that of the other decreases.", _opposites),
)
"""What the paper says of Figs 4 and 5."""


def cites(study: ConnectorStudy) -> dict[str, str]:
    """The references of a study."""
    found = {"spiliopoulos1996": "two connected oscillators, Figs 4 and 5", "westermo1989": "connecting buildings"}
    return found | ({"anagnostopoulos1988": "the dashpot, eq. (7)"} if study.connector.damping_ratio else {})


def figures(title: str, points: Sequence[Point], axes: Sequence[SweepAxis]) -> dict[str, tuple[str, Figure]]:
    """Both ratios against the frequency of the ground."""
    heading = "Largest displacements over those alone, |R1| and |R2|, against the frequency of the ground"
    return {"ratios": (heading, draw_ratios(title, points))}


def beside(points: Sequence[Point], folder: Path) -> None:
    """No file for other programs."""


@styled
def draw_ratios(title: str, points: Sequence[Point]) -> Figure:
    """One panel a point of the sweep, |R1| solid and |R2| dashed."""
    drawn = points[:_PANELS]
    columns = min(len(drawn), 3)
    rows = -(-len(drawn) // columns)
    figure = new_figure(3.6 * columns + 0.6, 3.0 * rows + 0.9)
    panels = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True).ravel()
    for ax, point in zip(panels, drawn, strict=False):
        values, x = point.found, point.found["frequency"]
        ax.set_title(point.label or "response ratios", loc="left")
        ax.plot(x, values["R1"], color="#000000", lw=1.6, label="system 1")
        ax.plot(x, values["R2"], color="#0072B2", linestyle=(0, (5, 2)), lw=1.6, label="system 2")
        for low, high in values["both_above"]:
            ax.axvspan(low, high, color="0.88", zorder=0)
        for name in ("frequency_low", "frequency_high"):
            if x[0] < values[name] < x[-1]:
                ax.axvline(values[name], color="#AA2211", lw=0.9, linestyle=(0, (1, 1.5)))
        ax.axhline(1, color="0.35", lw=1.0, zorder=1)
        ax.set(xlabel="Ω / ω₁₀", ylabel="largest displacement over that alone", xlim=(x[0], x[-1]), ylim=(0, None))
    for ax in panels[len(drawn) :]:
        ax.axis("off")
    panels[0].legend(loc="upper right")
    entitle(figure, title, "bold")
    left = f" The first {len(drawn)} of {len(points)} points of the sweep." if len(points) > len(drawn) else ""
    caption(figure, f"Grey: both ratios exceed one. Dotted: frequencies of the connected pair.{left}")
    return figure
