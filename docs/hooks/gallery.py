"""The gallery: every study of docs/gallery/ is run as a reader would run it, and shown with a figure and its time."""

from __future__ import annotations

import functools
import io
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pandas as pd
import yaml
from matplotlib.figure import Figure
from scipy.constants import g as STANDARD_GRAVITY
from scipy.stats import norm

from pounding_cli.api.studies import open_results
from pounding_cli.report.style import RC

FOLDER = Path(__file__).parents[1] / "gallery"
POUND = [sys.executable, "-c", "from pounding_cli.cli.main import main; main()"]
LINES = {"elastic": "-", "inelastic": "--"}
LINES_OF_END = {1: "core (-8 m)", 2: "frame (0 m)", 3: "light frame (8 m)"}
"""Frame lines along the row of the building at the end of a row, by number."""
COLORS = ("#0072B2", "#D55E00", "#009E73", "#AA4499", "#777777")


class Solved:
    """A study that was run: its results file, the table that some commands write beside it, and what it took [s]."""

    def __init__(self, study: Path, command: str, folder: Path) -> None:
        self.study, self.file = study, folder / f"{study.stem}.h5"
        begin = time.monotonic()
        called(command, study, "-o", self.file)
        self.seconds = time.monotonic() - begin

    @functools.cache  # noqa: B019 - the study lives as long as the page is written
    def table(self, name: str) -> pd.DataFrame:
        """A table of the results file, in SI."""
        return pd.read_csv(io.StringIO(called("show", self.file, name, "--format", "csv")))

    def written(self) -> pd.DataFrame:
        """The table that `pound connector` and `pound wall` write."""
        return pd.read_csv(next(self.file.with_suffix("").glob("tables/*.csv")))


def called(*words: object) -> str:
    """What `pound` prints.

    Raises
    ------
    RuntimeError : it failed
    """
    done = subprocess.run([*POUND, *map(str, words)], capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"pound {' '.join(map(str, words))}: {done.stderr}")
    return done.stdout


def heights(building: str) -> Callable[[Solved, Figure], None]:
    """Mean V/V0 and mu/mu0 of a building over its storeys, a line a case."""

    def draw(solved: Solved, figure: Figure) -> None:
        table = solved.table("storey").query("building == @building")
        for ax, column, analysis in zip(
            figure.subplots(1, 2, sharey=True), ("V_ratio", "mu_ratio"), ("elastic", "inelastic"), strict=True
        ):
            part = table[table["analysis"] == analysis]
            means = part.groupby(["case", "storey"], sort=False)[column].mean()
            for color, case in zip(COLORS, means.index.unique("case"), strict=False):
                ax.plot(means[case], means[case].index, "o-", ms=3, color=color, label=case)
            ax.axvline(1.0, color="0.6", lw=0.8)
            ax.set(xlabel={"V_ratio": "V/V0, elastic", "mu_ratio": "mu/mu0, inelastic"}[column])
            ax.set_yticks(means.index.unique("storey"))
        figure.axes[0].set_ylabel(f"storey of {building}")
        figure.axes[1].legend()

    return draw


def over(key: str, label: str, factor: float = 1.0, log: bool = False) -> Callable[[Solved, Figure], None]:
    """Largest mean V/V0 over the storeys of every building, against a swept key."""

    def draw(solved: Solved, figure: Figure) -> None:
        ax = figure.subplots()
        means = solved.table("storey").groupby(["analysis", "building", key, "storey"])["V_ratio"].mean()
        worst = means.groupby(["analysis", "building", key]).max()
        for analysis in worst.index.unique("analysis"):
            for color, building in zip(COLORS, worst.index.unique("building"), strict=False):
                line = worst[analysis, building]
                label_of = f"{building}, {analysis}"
                ax.plot(factor * line.index, line, LINES[analysis], color=color, label=label_of)
        ax.axhline(1.0, color="0.6", lw=0.8)
        ax.set(xlabel=label, ylabel="largest V/V0 of the storeys", xscale="log" if log else "linear")
        ax.legend()

    return draw


def draw_row(solved: Solved, figure: Figure) -> None:
    """Mean V/V0 of every building of a row."""
    table = solved.table("storey").query("analysis == 'elastic'")
    means = table.groupby("building")["V_ratio"].mean()
    order = ["a-1", "b-1", "a-2", "b-2", "a-3"]
    ax = figure.subplots()
    ax.bar(order, means[order], color=[COLORS[name.startswith("b")] for name in order])
    ax.axhline(1.0, color="0.6", lw=0.8)
    ax.set(ylabel="V/V0, elastic", xlabel="place in the row: a is soft, b is stiff")


def draw_laws(solved: Solved, figure: Figure) -> None:
    """Mean V/V0 and largest force, by law."""
    names = yaml.safe_load(solved.study.read_text(encoding="utf-8"))["sweep"]["impact.law"]
    shears = solved.table("storey").query("building == 'stiff'").groupby("impact.law")["V_ratio"].mean()
    forces = solved.table("link").groupby(["impact.law", "record"])["peak_force"].max().groupby("impact.law").mean()
    left, right = figure.subplots(1, 2)
    left.barh(names[::-1], shears[names[::-1]], color=COLORS[0])
    left.set_xlabel("V/V0 of stiff, mean over the storeys")
    right.barh(names[::-1], 1e-6 * forces[names[::-1]], color=COLORS[0])
    right.set_xlabel("largest contact force [MN]")


def draw_columns(solved: Solved, figure: Figure) -> None:
    """Largest shear demand of the struck columns of either building against the gap."""
    demand = solved.table("struck").groupby(["building", "cases.gap.gap"])["shear_demand"].max()
    ax = figure.subplots()
    for color, building in zip(COLORS, demand.index.unique("building"), strict=False):
        ax.plot(100 * demand[building].index, demand[building], color=color, label=building)
    ax.axhline(1.0, color="0.6", lw=0.8)
    ax.set(xlabel="gap [cm]", ylabel="largest shear demand of columns", yscale="log")
    ax.legend()


def draw_lines(solved: Solved, figure: Figure) -> None:
    """Draw the largest mean V/V0 and mu/mu0 of every frame line of `end` along the row against its shift."""
    data = open_results(solved.file).dataset.sel(building="end")
    shift = data["buildings.end.plan.shift"].to_numpy()
    for ax, analysis, name, label in zip(
        figure.subplots(1, 2, sharey=True),
        ("elastic", "inelastic"),
        ("line_V_ratio", "line_mu_ratio"),
        ("V/V0, elastic", "mu/mu0, inelastic"),
        strict=True,
    ):
        means = data[name].sel(case="gap", analysis=analysis).mean("record").max("storey")
        for color, line in zip(COLORS, LINES_OF_END, strict=False):
            ax.plot(shift, means.sel(line=line), "o-", ms=3, color=color, label=LINES_OF_END[line])
        ax.axhline(1.0, color="0.6", lw=0.8)
        ax.set(xlabel="shift of the end along the street [m]", title=label)
    figure.axes[0].set_ylabel("largest of the storeys")
    figure.axes[1].legend()


def draw_gap(solved: Solved, figure: Figure) -> None:
    """Mean required gap by every rule, at the floor that needs most."""
    table = solved.table("gap")
    most = table.loc[table.groupby(["analysis", "rule"], sort=False)["mean"].idxmax()]
    for ax, (analysis, part) in zip(figure.subplots(1, 2, sharey=True), most.groupby("analysis"), strict=True):
        ax.barh(part["rule"][::-1], 100 * part["mean"][::-1], color=COLORS[0])
        ax.set_xlabel(f"gap [cm], {analysis}")


def draw_neighbours(solved: Solved, figure: Figure) -> None:
    """Probability that a gap is enough over the drawn neighbours and the motions, and beside the median one."""
    key = "buildings.theirs.archetype.sample"
    closings = solved.table("link").groupby([key, "record"])["max_closing"].max()
    is_median = closings.index.get_level_values(key) == 0
    ax = figure.subplots()
    for color, label, part in (
        (COLORS[4], "with the median neighbour", closings[is_median]),
        (COLORS[0], "over what it may be", closings[~is_median]),
    ):
        widths = 100 * np.sort(part)
        ax.step(widths, np.arange(1, widths.size + 1) / widths.size, where="post", color=color, label=label)
    ax.axvline(4.0, color="0.6", lw=0.8)
    ax.set(xlabel="gap [cm]; line: that of the joint", ylabel="probability that it is enough", ylim=(0, 1))
    ax.legend()


def draw_fragility(solved: Solved, figure: Figure) -> None:
    """Draw the fitted curves of every building, alone and with pounding."""
    ax = figure.subplots()
    intensity = np.linspace(0.02, 0.4, 200)
    curves = solved.table("fragility")
    colors = dict(zip(curves["building"].unique(), COLORS, strict=False))
    for row in curves.to_dict("records"):
        style = "--" if row["state"] == "alone" else "-"
        median = row["median"] / STANDARD_GRAVITY
        probability = norm.cdf(np.log(intensity / median) / row["spread"])
        ax.plot(
            intensity, probability, style, color=colors[row["building"]], label=f"{row['building']}, {row['state']}"
        )
    ax.set(xlabel="peak ground acceleration [g]", ylabel="probability of mu > 4")
    ax.legend()


def draw_target(solved: Solved, figure: Figure) -> None:
    """Spectra of the motions as used, their mean, and the target with what the mean may fall to."""
    match = open_results(solved.file).spectrum_match
    periods = np.union1d(match.periods, [each for each in match.target.periods if each > match.periods[0]])
    periods = periods[periods <= match.periods[-1]]
    target = match.target.interpolate(periods) / STANDARD_GRAVITY
    spectra = np.array(list(match.spectra.values())) / STANDARD_GRAVITY
    ax = figure.subplots()
    ax.axvspan(match.target.low, match.target.high, color="0.94", lw=0)
    ax.plot(match.periods, spectra.T, color="0.75", lw=0.8)
    ax.plot(match.periods, spectra.mean(axis=0), color=COLORS[0], lw=2.0, label=f"mean of {len(spectra)}")
    ax.plot(periods, target, color="black", lw=1.6, label=match.target.name)
    ax.plot(periods, match.at_least * target, ":", color="black", label=f"{100 * match.at_least:g} % of it")
    ax.set(xscale="log", xlim=(periods[0], periods[-1]), xlabel="period [s]", ylabel="pseudo-acceleration [g], 5 %")
    ax.legend()


def draw_oscillators(solved: Solved, figure: Figure) -> None:
    """Both ratios over the frequency, at 5 % damping."""
    import h5py

    with h5py.File(solved.file) as file:
        frequency, first, second = (file[name][()] for name in ("frequency", "R1", "R2"))
    ax = figure.subplots()
    ax.plot(frequency, first[0], color=COLORS[0], label="first")
    ax.plot(frequency, second[0], color=COLORS[1], label="second")
    ax.axhline(1.0, color="0.6", lw=0.8)
    ax.set(xlabel="frequency over that of the first", ylabel="displacement over that alone")
    ax.legend()


def draw_wall(solved: Solved, figure: Figure) -> None:
    """Largest stress under a node, and its average under a patch, against the size of the elements."""
    ax, table = figure.subplots(), solved.written()
    node, patch = (table[table["contact.over"] == name] for name in ("node", "patch"))
    ax.plot(node["mesh.size"], 1e-6 * node["wall_stress"], "o-", color=COLORS[0], label="under one node")
    ax.plot(
        patch["mesh.size"], 1e-6 * patch["averaged_stress"], "o-", color=COLORS[1],
        label="under a patch, over half a metre",
    )  # fmt: skip
    ax.axhline(33.0, color="0.6", lw=0.8)
    ax.set(xlabel="size of the elements [m]; line: 33 N/mm2", ylabel="largest stress [N/mm2]")
    ax.invert_xaxis()
    ax.legend()


def pair_numbers(solved: Solved) -> Iterator[tuple[str, str]]:
    """Statements of the paper about its Fig. 6, and what follows from the tables."""
    storeys, floors = solved.table("storey"), solved.table("floor")
    stiff = storeys.query("building == 'stiff'").groupby(["analysis", "case"])[["V_ratio", "mu_ratio"]].mean()
    kept = [
        stiff.loc[analysis, "infill"][column] / stiff.loc[analysis, "touching"][column]
        for analysis, column in (("elastic", "V_ratio"), ("inelastic", "mu_ratio"))
    ]
    yield (
        '"practically no reduction in either story shears or ductility factors" by the infill',
        f"{100 * (1 - kept[0]):.0f} % less V/V0, {100 * (1 - kept[1]):.0f} % less mu/mu0 than in touch",
    )
    means = floors.query("analysis == 'elastic'").groupby(["case", "building", "floor"])["acceleration"].mean()
    fall = 1 - (means["infill"] / means["touching"]).groupby("building").mean()["stiff"]
    yield '"more than 80% reduction to the accelerations" by the infill', f"{100 * fall:.0f} %, mean over the floors"
    separation = solved.table("buildings")["separation"].dropna().iloc[0]
    yield '"approximately 7cm" separation by the UBC', f"{100 * separation:.1f} cm"
    ratios = storeys.groupby(["analysis", "case", "building", "storey"])["V_ratio"].mean()["elastic", "connected"]
    yield (
        '"substantial increase to the response of the stiffer building" by the connection; '
        'that of the other "was found to reduce"',
        f"V/V0 up to {ratios['stiff'].max():.2f}; {ratios['soft'].mean():.2f}, mean over the storeys",
    )


def three_numbers(solved: Solved) -> Iterator[tuple[str, str]]:
    """The same of its Fig. 7."""
    storeys = solved.table("storey").query("case == 'gap' and building == 'stiff'")
    means = storeys.groupby(["analysis", "storey"])[["V_ratio", "mu_ratio"]].mean()
    yield (
        '"the code specified separation is quite adequate" (7 cm)',
        f"largest mu/mu0 {means.loc['inelastic', 'mu_ratio'].max():.2f} where storeys yield, "
        f"largest V/V0 {means.loc['elastic', 'V_ratio'].max():.2f} where they do not",
    )


def oscillator_numbers(solved: Solved) -> Iterator[tuple[str, str]]:
    """The same of its Fig. 5."""
    low, high = solved.written().iloc[0][["frequency_low", "frequency_high"]]
    yield (
        '"the lowest eigenfrequency lies between the two uncoupled ones, the higher one is bigger than both"',
        f"{low:.3f} and {high:.3f} times that of the first; uncoupled 0.6 and 1",
    )


def wall_numbers(solved: Solved) -> Iterator[tuple[str, str]]:
    """The same of its Fig. 8."""
    table = solved.written().query("`contact.over` == 'node'").set_index("mesh.size")
    stress = 1e-6 * table["wall_stress"]
    yield '"about 33 N/mm2", with elements of half a metre', f"{stress[0.5]:.1f} N/mm2"
    yield "the same with elements of a quarter of a metre", f"{stress[0.25]:.1f} N/mm2"


def find_line_ratios(solved: Solved) -> Iterator[tuple[str, str]]:
    """Yield the largest mu/mu0 of every frame line of `end`, where it is set back by a third to either side, and of its
    storeys if floors do not twist."""
    ratios = open_results(solved.file).dataset["line_mu_ratio"].sel(building="end", analysis="inelastic", case="gap")
    means = ratios.mean("record").max("storey")
    for line, name in LINES_OF_END.items():
        low, high = (means.sel({"buildings.end.plan.shift": shift, "line": line}).item() for shift in (-6.0, 6.0))
        yield f"mu/mu0 of the {name}", f"{low:.2f} with a shift of -6 m; {high:.2f} with 6 m"
    study = yaml.safe_load(solved.study.read_text(encoding="utf-8"))
    del study["sweep"]
    for building in study["buildings"].values():
        del building["plan"]
    path = solved.file.with_name("without-plans.yaml")
    path.write_text(yaml.safe_dump(study), encoding="utf-8")
    storeys = Solved(path, "run", path.parent).table("storey").query("building == 'end' and analysis == 'inelastic'")
    largest = storeys.groupby("storey")["mu_ratio"].mean().max()
    yield "mu/mu0 of its storeys without `plan:`", f"{largest:.2f}"


@dataclass(frozen=True)
class Entry:
    """A study of the gallery: the command that answers it, its figure, and numbers under two headings."""

    command: str
    figure: Callable[[Solved, Figure], None]
    numbers: Callable[[Solved], Iterator[tuple[str, str]]] | None = None
    headings: tuple[str, str] = ("published", "here, with the stand-in motions")


ENTRIES = {
    "first-pair": Entry("run", heights("stiff")),
    "gap-sweep": Entry("run", over("cases.pair.gap", "gap [cm]", 100)),
    "period-ratio": Entry("run", over("buildings.soft.period", "period of the soft building [s]")),
    "row-of-five": Entry("run", draw_row),
    "contact-laws": Entry("run", draw_laws),
    "viscous-dampers": Entry("run", over("cases.dampers.links.1.damping_coefficient", "damping [MN s/m]", 1e-6, True)),
    "friction-dampers": Entry("run", over("cases.dampers.links.1.slip_force", "slip force [kN]", 1e-3, True)),
    "retrofit": Entry("run", heights("frame")),
    "end-of-row": Entry(
        "run", draw_lines, find_line_ratios, ("frame line of the end building", "mean over the motions, worst storey")
    ),
    "slabs-columns": Entry("run", draw_columns),
    "soft-soil": Entry("run", over("buildings.stiff.foundation.sway_stiffness", "sway stiffness [MN/m]", 1e-6, True)),
    "hospital-moat": Entry("run", over("cases.moat.gap", "width of the moat [cm]", 100)),
    "required-gap": Entry("gap", draw_gap),
    "seen-neighbour": Entry("gap", draw_neighbours),
    "code-spectrum": Entry("run", draw_target),
    "fragility": Entry("fragility", draw_fragility),
    "paper-pair": Entry("run", heights("stiff"), pair_numbers),
    "paper-three": Entry("run", heights("stiff"), three_numbers),
    "paper-oscillators": Entry("connector", draw_oscillators, oscillator_numbers),
    "paper-wall": Entry("wall", draw_wall, wall_numbers),
}
"""In the order of the page."""

HEAD = """\
# Gallery

Every study here is a file of `docs/gallery/` in the repository. The site's build ran it with the command shown, in the
time shown (start of the program and writing included), and drew its figure. Open a command to see the study. The
motions are the stand-ins that come with the program. `pound init mine --like NAME` writes any of them to start from,
e.g. `--like first-pair`, and also those of [published results](../published.md)."""


def section(name: str, solved: Solved) -> tuple[str, bytes]:
    """A study as Markdown, and its figure as SVG."""
    text, entry = solved.study.read_text(encoding="utf-8"), ENTRIES[name]
    about = " ".join(line.removeprefix("# ") for line in re.match(r"(?:#.*\n)+", text)[0].splitlines())
    title = yaml.safe_load(text)["title"]
    parts = [f"## {title}", about, f"![{title}]({name}.svg)"]
    if entry.numbers is not None:
        rows = [f"| {said} | {found} |" for said, found in entry.numbers(solved)]
        parts.append("\n".join([f"| {' | '.join(entry.headings)} |", "|---|---|", *rows]))
    study = "".join(f"    {line}\n" for line in text[text.index("title:") :].splitlines())
    parts.append(
        f'??? example "`pound {entry.command} {name}.yaml`: {solved.seconds:.1f} s"\n\n    ```yaml\n{study}    ```'
    )
    with mpl.rc_context({**RC, "svg.hashsalt": name}):
        figure, kept = Figure(figsize=(6.4, 3.2), layout="constrained"), io.BytesIO()
        entry.figure(solved, figure)
        figure.savefig(kept, format="svg", metadata={"Date": None})
    return "\n\n".join(parts), kept.getvalue()


def pages() -> Iterator[tuple[str, str | bytes]]:
    """Place in the site and content of the page and its figures."""
    with tempfile.TemporaryDirectory(prefix="gallery-") as folder:
        found = {
            name: section(name, Solved(FOLDER / f"{name}.yaml", entry.command, Path(folder)))
            for name, entry in ENTRIES.items()
        }
    yield "gallery/index.md", "\n\n".join([HEAD, *(text for text, _ in found.values())]) + "\n"
    for name, (_, figure) in found.items():
        yield f"gallery/{name}.svg", figure


def on_files(files, config):
    """Called by mkdocs: adds the page to those that stand in docs/."""
    from mkdocs.structure.files import File

    for path, content in pages():
        files.append(File.generated(config, path, content=content))
    return files
