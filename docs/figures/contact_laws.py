"""The figures and tables of docs/contact.md that compare the laws: by themselves, and as the contact stiffens.

`python docs/figures/contact_laws.py` (a minute) runs configs/contact-laws.yaml as it is and at growing stiffness, draws
`contact-laws.svg` and `contact-stiffness.svg` and puts the tables into the page."""

from __future__ import annotations

import math
import os
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import yaml
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import pounding_cli as pound
from pounding_cli.laws.bilinear_contact import BilinearDamping
from pounding_cli.laws.law import LinkLaw
from pounding_cli.model.building import Building
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Analysis, Scene
from pounding_cli.records.motion import Motion
from pounding_cli.solver.solve import solve
from pounding_cli.study import load_study_file

FOLDER = Path(__file__).parent
PAGE = FOLDER.parent / "contact.md"
STUDY = FOLDER.parents[1] / "configs" / "contact-laws.yaml"

MASS, SPEED, RESTITUTION = 1e5, 0.5, 0.5
"""Of the blow at which the springs are matched: reduced mass m' [kg], approach speed v0 [m/s], e [-]."""

MULTIPLES = (5, 20, 80, 320, 1280, 5120)
"""Impact stiffness over that of the stiffest storey [-]."""

LOOKS = {
    "kelvin-voigt": ("#000000", "o"),
    "hertz": ("#AA2211", "s"),
    "hertz-damp": ("#0072B2", "^"),
    "jankowski": ("#E69F00", "v"),
    "bilinear": ("#009E73", "D"),
}

QUANTITIES = {
    "V/V0": ("storey", "V_ratio", 1.0),
    "mu/mu0": ("storey", "mu_ratio", 1.0),
    "displacement [mm]": ("floor", "displacement", 1e3),
    "impulse [kN s]": ("link", "impulse", 1e-3),
    "acceleration / alone": ("floor", "acceleration_ratio", 1.0),
    "impact force [MN]": ("link", "peak_force", 1e-6),
    "impacts": ("link", "impacts", 1.0),
    "time in contact [s]": ("link", "contact_time", 1.0),
}
"""Table, column and factor of what is compared: of the stiff building, or of the links."""

ROWS = {
    "V/V0, in touch": ("V/V0", "touching", "elastic", "{:.3f}"),
    "V/V0, gap of 5 cm": ("V/V0", "gap", "elastic", "{:.3f}"),
    "mu/mu0, in touch": ("mu/mu0", "touching", "inelastic", "{:.3f}"),
    "displacement, in touch [mm]": ("displacement [mm]", "touching", "elastic", "{:.1f}"),
    "impulse of a link, in touch [kN s]": ("impulse [kN s]", "touching", "elastic", "{:.0f}"),
    "floor acceleration / alone, in touch": ("acceleration / alone", "touching", "elastic", "{:.1f}"),
    "floor acceleration / alone, gap of 5 cm": ("acceleration / alone", "gap", "elastic", "{:.1f}"),
    "impact force, in touch [MN]": ("impact force [MN]", "touching", "elastic", "{:.1f}"),
    "impact force, gap of 5 cm [MN]": ("impact force [MN]", "gap", "elastic", "{:.1f}"),
    "impacts of a link, in touch": ("impacts", "touching", "elastic", "{:.0f}"),
    "impacts of a link, gap of 5 cm": ("impacts", "gap", "elastic", "{:.1f}"),
    "time in contact, in touch [s]": ("time in contact [s]", "touching", "elastic", "{:.2f}"),
    "time in contact, gap of 5 cm [s]": ("time in contact [s]", "gap", "elastic", "{:.3f}"),
}
"""Rows of the tables: what, of which case and analysis, and how it is written."""


def matched(stiffness: float) -> tuple[float, float]:
    """(k_h [N/m^1.5], d_m [m]) that go with an impact stiffness s [N/m].

    k_h gives the undamped blow of `SPEED` the same largest force as s does; d_m is the closing that the bilinear law
    gives it, k_h d_m^2.5 (1 + r) = m' v0^2 with r = E / (k_h d_m^2.5).
    """
    hertz = stiffness**1.25 / (1.25**1.5 * MASS**0.25 * SPEED**0.5)
    lost = BilinearDamping.EXACT.share(RESTITUTION)
    return hertz, (MASS * SPEED**2 / (hertz * (1 + lost))) ** 0.4


def run(study: Path | dict[str, Any]) -> dict[str, pd.DataFrame]:
    """The tables of a study, with the motions that everybody has."""
    os.environ.pop("POUND_RECORDS", None)
    with tempfile.TemporaryDirectory() as folder:
        results = pound.run(study, Path(folder) / "laws.h5")
        tables = {name: getattr(results, name)() for name in ("storey", "floor", "link", "scene")}
    assert set(tables["scene"]["status"]) == {"done"}
    return tables


def laws() -> dict[str, LinkLaw]:
    """Every law as the study has it, between its two roofs."""
    links = load_study_file(STUDY).parts.links["touching"]
    found = dict.fromkeys(at_point[-1].law for _, at_point in links.iter_values())
    return dict(zip(LOOKS, found, strict=True))


def blow(law: LinkLaw) -> tuple[float, float, float]:
    """(largest force over v0 sqrt(s m'), contact time over pi sqrt(m' / s), rebound) of the blow at which the springs
    are matched [-]; the storeys of the two floors are next to nothing."""
    floors = tuple(Building(name, [2 * MASS], [3.0], [1e-9], [math.inf], [0.0], 0.0, 0.0) for name in ("left", "right"))
    scene = Scene(floors, (Link(0, 1, 1, law),), Motion("still", 0.02, np.zeros(3)), Analysis.ELASTIC)
    found = solve(scene, 1e-9, initial=([[0.0], [0.0]], [[SPEED], [0.0]]))
    spring = laws()["kelvin-voigt"].max_slopes[0]
    (_, (left,)), (_, (right,)) = found.final
    force = float(found.links.peak_force[0]) / (SPEED * math.sqrt(spring * MASS))
    return force, float(found.links.contact_time[0]) / (math.pi * math.sqrt(MASS / spring)), (right - left) / SPEED


def stiffening() -> dict[str, Any]:
    """The study, with stiffer and stiffer contacts of every law, matched at each stiffness."""
    study = yaml.safe_load(STUDY.read_text(encoding="utf-8"))
    checked = load_study_file(STUDY)
    storey = max(float(each.stiffness.max()) for each in checked.group(checked.first_point).buildings)
    pairs = [matched(multiple * storey) for multiple in MULTIPLES]
    study["estimate"] = "none"
    study["sweep"] = [
        study["sweep"],
        {
            "impact.stiffness": [multiple * storey for multiple in MULTIPLES],
            "impact.hertz_stiffness": [f"{hertz!r} N/m^1.5" for hertz, _ in pairs],
            "impact.penetration": [depth for _, depth in pairs],
        },
    ]
    return study


def means(tables: dict[str, pd.DataFrame], what: str, case: str, analysis: str) -> pd.DataFrame:
    """Means over the motions: a row a law (and stiffness), a column a storey, floor or link of the stiff building."""
    table, column, factor = QUANTITIES[what]
    rows = tables[table]
    rows = rows[(rows["case"] == case) & (rows["analysis"] == analysis)]
    if table != "link":
        rows = rows[rows["building"] == "stiff"]
    axes = [name for name in ("impact.law", "impact.stiffness") if name in rows]
    return rows.pivot_table(column, axes, table, sort=False) * factor


def compared(tables: dict[str, pd.DataFrame]) -> str:
    """The table of the laws: one blow of two free floors, then means over the motions where they are largest."""
    lines = [f"| | {' | '.join(LOOKS)} |", "|---" * (1 + len(LOOKS)) + "|"]
    blows = [blow(law) for law in laws().values()]
    for number, words in enumerate(("blow at 0.5 m/s: force / v0 sqrt(s m')", "time / pi sqrt(m'/s)", "rebound")):
        lines.append(f"| {words} | {' | '.join(f'{each[number]:.3f}' for each in blows)} |")
    for words, (what, case, analysis, form) in ROWS.items():
        largest = means(tables, what, case, analysis).max(axis=1)
        lines.append(f"| {words} | {' | '.join(form.format(largest[law]) for law in LOOKS)} |")
    return "\n".join(lines)


def over_stiffness(
    tables: dict[str, pd.DataFrame], what: str, case: str, analysis: str, multiples: tuple[int, ...] = MULTIPLES
) -> pd.DataFrame:
    """What is compared, largest of all places: a row a law, a column a stiffness, one of `multiples`."""
    largest = means(tables, what, case, analysis).max(axis=1).rename(what).reset_index()
    return largest.pivot_table(what, "impact.law", "impact.stiffness").set_axis(multiples, axis=1)


def growth(tables: dict[str, pd.DataFrame]) -> str:
    """The table of what converges: factors as the stiffness is multiplied by 4, near its usual value and far above."""
    lines = [f"| s times 4: from 20, from 1280 | {' | '.join(LOOKS)} |", "|---" * (1 + len(LOOKS)) + "|"]
    for words, (what, case, analysis, _) in ROWS.items():
        values = over_stiffness(tables, what, case, analysis)
        cells = (f"{values.loc[law, 80] / values.loc[law, 20]:.2f}, "
                 f"{values.loc[law, 5120] / values.loc[law, 1280]:.2f}" for law in LOOKS)  # fmt: skip
        lines.append(f"| {words.split(' [')[0]} | {' | '.join(cells)} |")
    return "\n".join(lines)


def _legend(figure: Figure, ax: Axes) -> None:
    figure.legend(*ax.get_legend_handles_labels(), loc="outside upper left", ncols=len(LOOKS), fontsize=8.5)


def draw_laws(tables: dict[str, pd.DataFrame]) -> Figure:
    """Profiles over the storeys of the stiff building."""
    panels = [
        ("V/V0", "touching", "elastic", "V/V0, in touch"),
        ("V/V0", "gap", "elastic", "V/V0, gap of 5 cm"),
        ("mu/mu0", "touching", "inelastic", "mu/mu0, in touch"),
        ("acceleration / alone", "touching", "elastic", "floor acceleration / alone, in touch"),
    ]
    figure = Figure(figsize=(10, 3.4), layout="constrained")
    axes = figure.subplots(1, 4, sharey=True)
    for ax, (what, case, analysis, words) in zip(axes, panels, strict=True):
        profile = means(tables, what, case, analysis)
        for law, (color, marker) in LOOKS.items():
            ax.plot(profile.loc[law], profile.columns, color=color, marker=marker, ms=4, lw=1.2, label=law)
        ax.axvline(1, color="0.4", lw=1)
        ax.set(xlabel=words, yticks=profile.columns)
    axes[0].set_ylabel("storey, floor")
    _legend(figure, axes[0])
    return figure


def draw_stiffness(tables: dict[str, pd.DataFrame]) -> Figure:
    """Everything over the stiffness, buildings in touch."""
    figure = Figure(figsize=(10, 5.2), layout="constrained")
    axes = figure.subplots(2, 4, sharex=True)
    for ax, what in zip(axes.flat, QUANTITIES, strict=True):
        values = over_stiffness(tables, what, "touching", "inelastic" if what == "mu/mu0" else "elastic")
        for law, (color, marker) in LOOKS.items():
            ax.plot(MULTIPLES, values.loc[law], color=color, marker=marker, ms=4, lw=1.2, label=law)
        ax.set(xscale="log", title=what)
        ax.set_xticks(MULTIPLES, [str(multiple) for multiple in MULTIPLES])
        ax.minorticks_off()
        if what in ("acceleration / alone", "impact force [MN]"):
            ax.set_yscale("log")
        else:
            ax.set_ylim(0, 1.1 * values.to_numpy().max())
    figure.supxlabel("impact stiffness s over that of the stiffest storey", fontsize=9.5)
    _legend(figure, axes.flat[0])
    return figure


def marks(name: str) -> tuple[str, str]:
    """What stands before and after a table in the page."""
    return f"<!-- {name}: begin (python docs/figures/contact_laws.py) -->", f"<!-- {name}: end -->"


def put(name: str, table: str) -> None:
    """A table between its marks."""
    begin, end = marks(name)
    before, rest = PAGE.read_text(encoding="utf-8").split(begin)
    PAGE.write_text(f"{before}{begin}\n\n{table}\n\n{end}{rest.split(end)[1]}", encoding="utf-8")


def main() -> None:
    """Run, draw, and write the tables into the page."""
    import matplotlib as mpl

    from pounding_cli.report.style import RC

    alike, stiffer = run(STUDY), run(stiffening())
    with mpl.rc_context(RC):
        draw_laws(alike).savefig(FOLDER / "contact-laws.svg", metadata={"Date": None})
        draw_stiffness(stiffer).savefig(FOLDER / "contact-stiffness.svg", metadata={"Date": None})
    for name, table in (("laws", compared(alike)), ("stiffness", growth(stiffer))):
        put(name, table)
        print(table, end="\n\n")


if __name__ == "__main__":
    main()
