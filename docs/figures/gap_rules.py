"""How far ABS, SRSS and DDC are from the exact required gap, over a thousand pairs of buildings: figure and numbers of
docs/how-to/gap.md.

`python docs/figures/gap_rules.py` runs the study below with `pound gap` (a few minutes), draws `gap-rules.png` and puts
the numbers into the page. Its motions are the five stand-ins that ship and five of other random phases."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

FOLDER = Path(__file__).parent
PAGE = FOLDER.parent / "how-to" / "gap.md"
BEGIN, END = "<!-- rules: begin (python docs/figures/gap_rules.py) -->", "<!-- rules: end -->"

PERIODS = 33
MOTIONS = ("elcentro", "taft", "eureka", "olympia", "parkfield")
RULES = {"ABS": "#E69F00", "SRSS": "#0072B2", "DDC": "#009E73"}
BANDS = (0.0, 0.25, 0.5, 0.7, 0.8, 0.9, 0.95, 1.0)
"""Edges of period ratios: rows of the table, and the points that the lines join."""


def study(folder: Path) -> dict:
    """Every pair of periods, buildings of five storeys."""
    others = [{"file": str(folder / f"{name}.txt"), "name": f"{name}-7"} for name in MOTIONS]
    span = {"from": "0.2 s", "to": "2 s", "count": PERIODS, "spacing": "log"}
    return {
        "title": f"{PERIODS * PERIODS} pairs of buildings",
        "records": {"use": [*MOTIONS, *others], "duration": "whole"},
        "buildings": {"A": {"storeys": 5, "period": "0.36 s"}, "B": {"storeys": 5, "period": "0.36 s"}},
        "group": ["A", "B"],
        "cases": {"any": {"link": "none"}},
        "estimate": "none",
        "sweep": {"buildings.A.period": span, "buildings.B.period": span},
    }


def ratios() -> pd.DataFrame:
    """Rule over exact at the roof, means over the motions; one row a pair, analysis and rule."""
    import pounding_cli as pound

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        tool = Path(__file__).parents[2] / "tools" / "stand_ins.py"
        subprocess.run([sys.executable, tool, *MOTIONS, "--seed", "7", "-o", name], check=True)
        table = pound.run(study(folder), folder / "gap.h5", workflow="gap").table("gap")
    table = table[(table["floor"] == 5) & table["rule"].isin(RULES)]
    a, b = table["buildings.A.period"], table["buildings.B.period"]
    table = table[a != b].assign(ratio=np.minimum(a, b) / np.maximum(a, b))
    return table[["analysis", "rule", "ratio", "over_exact"]]


def banded(table: pd.DataFrame) -> pd.DataFrame:
    """Median, 5th and 95th percentile of rule over exact, by analysis, rule and band of period ratios."""
    band = pd.cut(table["ratio"], BANDS)
    groups = table.groupby(["analysis", "rule", band], observed=True)["over_exact"]
    return groups.agg([lambda x: x.quantile(0.05), "median", lambda x: x.quantile(0.95)])


def draw(table: pd.DataFrame) -> Figure:
    """Every pair as a point, the median of every band as a line."""
    figure = Figure(figsize=(9.2, 3.9), layout="constrained")
    for ax, (analysis, here) in zip(figure.subplots(1, 2, sharey=True), table.groupby("analysis"), strict=True):
        for rule, color in RULES.items():
            rows = here[here["rule"] == rule].sort_values("ratio")
            ax.plot(rows["ratio"], rows["over_exact"], ".", color=color, ms=2.5, alpha=0.35)
            middle = rows.groupby(pd.cut(rows["ratio"], 20), observed=True)[["ratio", "over_exact"]].median()
            ax.plot(middle["ratio"], middle["over_exact"], color=color, lw=2, label=rule)
        ax.axhline(1, color="0.2", lw=1)
        ax.set(title=analysis, xlabel="period ratio, shorter over longer", yscale="log", ylim=(0.6, 22))
        ax.set_yticks([1, 2, 5, 10, 20], ["1", "2", "5", "10", "20"])
        ax.grid(color="0.9", lw=0.6)
        ax.set_axisbelow(True)
    figure.axes[0].set_ylabel("rule / exact required gap")
    figure.axes[0].legend(frameon=False, loc="upper left")
    pairs = PERIODS * (PERIODS - 1)
    note = f"{pairs:,} pairs, roof of five storeys; mean of 10 stand-in motions. Above 1: more than required."
    figure.supxlabel(note, fontsize=8, x=0.01, ha="left", color="0.3")
    return figure


def lines(found: pd.DataFrame) -> list[str]:
    """The numbers as Markdown."""
    heads = [f"{rule}, {analysis}" for analysis in ("elastic", "inelastic") for rule in RULES]
    said = [f"| period ratio | {' | '.join(heads)} |", "|---" * (1 + len(heads)) + "|"]
    for band in found.index.get_level_values("ratio").unique():
        cells = []
        for analysis in ("elastic", "inelastic"):
            for rule in RULES:
                low, middle, high = found.loc[(analysis, rule, band)]
                cells.append(f"{middle:.2f} ({low:.2f} to {high:.2f})")
        said.append(f"| {band.left:g} to {band.right:g} | " + " | ".join(cells) + " |")
    return said


def main() -> None:
    """Run, draw, and write the numbers into the page."""
    os.environ.pop("POUND_RECORDS", None)  # the motions that everybody has
    table = ratios()
    draw(table).savefig(FOLDER / "gap-rules.png", dpi=150)
    text = PAGE.read_text(encoding="utf-8")
    numbers = "\n".join(lines(banded(table).sort_index(ascending=True)))
    PAGE.write_text(
        re.sub(f"{re.escape(BEGIN)}.*?{re.escape(END)}", lambda _: f"{BEGIN}\n{numbers}\n{END}", text, flags=re.DOTALL),
        encoding="utf-8",
    )
    print(numbers)


if __name__ == "__main__":
    main()
