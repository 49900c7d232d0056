"""`pound report`: what it writes and prints, and what it refuses. What stands on the page: tests/browser."""

from __future__ import annotations

import base64
import html
import re
from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from matplotlib.collections import QuadMesh
from matplotlib.path import Path as MplPath

import pounding_cli
from pounding_cli.questions.reports import build_report as report
from pounding_cli.report.sweep import SweepChoice as Asked
from tests.night import NIGHTLY

from .conftest import TWO

FOUR = TWO.replace("title", "statements: [{says: it moves, name: moves, holds: drift > 0 cm}]\ntitle").replace(
    "analyses:",
    """\
  infill: {link: infill, gap: 5 mm, stiffness: 1/5 mean storey of stiff}
  connected: {link: connector, gap: 2 cm, floors: [2], stiffness: 1/5 mean storey of stiff}
analyses:""",
)


def words(page: Path) -> str:
    text = re.split("<main", page.read_text(encoding="utf-8"))[1].split("<script")[0]
    return re.sub(r"\s+", " ", html.unescape(re.sub(r"<[^>]+>", " ", text)))


@pytest.fixture(scope="module")
def made(tmp_path_factory) -> Path:
    """A folder with two.h5, swept.h5 over restitutions, maps.h5 over these and gaps too narrow for a connector, and
    gap.h5 with the answer of `pound gap`."""
    folder = tmp_path_factory.mktemp("report")
    with_apart = FOUR.replace("analyses:", "  apart: {link: none}\nanalyses:")
    studies = {
        "two": FOUR,
        "swept": with_apart + "sweep: {impact.restitution: [0.4, 0.5, 0.65]}\n",
        "maps": FOUR + "sweep: {cases.connected.gap: [1 mm, 2 mm, 3 mm], impact.restitution: [0.4, 0.6]}\n",
    }
    for name, text in studies.items():
        (folder / f"{name}.yaml").write_text(text)
        pounding_cli.run(folder / f"{name}.yaml", folder / f"{name}.h5", engine="serial")
    pounding_cli.run(folder / "two.yaml", folder / "gap.h5", engine="serial", workflow="gap")
    return folder


def test_page_figures_and_tables(made, folder, pound):
    """PNG and SVG, and what a report before left in another format. Fails if that stays as it was."""
    old = Path("two/soft-response.pdf")
    old.parent.mkdir()
    old.write_bytes(b"%PDF-")
    code, out, err = pound("report", made / "two.h5", "-o", "two")
    assert (code, err) == (0, "")
    assert out.startswith("two/report.html: ")
    figures = product(("stiff", "soft"), ("response", "accelerations"), ("png", "svg"))
    drawn = {f"{building}-{what}.{suffix}" for building, what, suffix in figures}
    assert {path.name for path in Path("two").glob("*.*")} == {"report.html", "soft-response.pdf", *drawn}
    assert len(old.read_bytes()) > 5_000
    exact = pounding_cli.open_results(made / "two.h5").storey()
    pd.testing.assert_frame_equal(
        pd.read_csv("two/tables/storey.csv"), exact, check_dtype=False, check_categorical=False
    )
    elastic = exact[(exact["case"] == "touching") & (exact["analysis"] == "elastic") & (exact["building"] == "stiff")]
    assert f"{elastic.groupby('storey')['V_ratio'].mean().max():.2f}" in words(Path("two/report.html"))


@NIGHTLY
def test_the_same_report_again_is_the_same_to_the_byte(made, folder, pound):
    for name in ("one", "again"):
        pound("report", made / "two.h5", "-o", name, "-q", "--format", "svg")
    for path in Path("one").rglob("*.*"):
        assert path.read_bytes() == (Path("again") / path.relative_to("one")).read_bytes(), path.name


@NIGHTLY
def test_several_files_are_compared_on_one_page(made, folder, pound):
    code, out, _ = pound("report", made / "two.h5", made / "swept.h5", "-o", "both", "--no-figures")
    assert code == 0
    assert out.splitlines()[-1] == "both/comparison.md"
    page = Path("both/comparison.md").read_text(encoding="utf-8")
    assert "| statement | two | swept: impact.restitution = 0.4 |" in page
    assert Path("both/two/report.html").is_file()
    assert Path("both/swept/report.html").is_file()
    assert Path("both/comparison.csv").is_file()
    Path("two.h5").write_bytes((made / "two.h5").read_bytes())
    assert pound("report", made / "two.h5", "two.h5", "-o", "same", "--no-figures", "-q") == (0, "", "")
    assert Path("same/two-2/report.html").is_file()


@NIGHTLY
def test_several_files_of_any_study_are_compared(made, folder, pound):
    """Of studies without statements, and of an answer. Fails if the page compares statements alone."""
    for name, gap in (("near", "5 mm"), ("wide", "50 cm")):
        Path(f"{name}.yaml").write_text(TWO.replace("gap: 5 mm", f"gap: {gap}").replace("Two small", f"{name} a|b"))
        pound("run", f"{name}.yaml", "-o", f"{name}.h5", "-q")
    files = ["near.h5", "wide.h5", made / "gap.h5"]
    assert pound("report", *files, "-o", "all", "--no-figures", "-q") == (0, "", "")
    page = Path("all/comparison.md").read_text(encoding="utf-8")
    for name in ("near", "wide"):
        table = report(pounding_cli.open_results(f"{name}.h5")).answer.tables[0]
        row = next(line for line in page.splitlines() if line.startswith(f"| {name} | gap | inelastic |"))
        assert table.cells()[3][2].split("\n")[0] in row  # the largest ductility
    assert "penetration" in page
    assert "| wide | gap | inelastic |" in page.split("## Ratios")[0]
    widths = report(pounding_cli.open_results(made / "gap.h5")).answer.tables[0]
    assert f"## {widths.caption}" in page
    assert "Statements" not in page
    assert not Path("all/comparison.csv").exists()


def test_a_sweep_is_drawn_as_asked(made, folder, pound):
    asked = ["--quantity", "mu_ratio", "--case", "touching", "--building", "soft", "--where", "storey=2"]
    assert pound("report", made / "swept.h5", "-q", "--format", "svg", "-o", "asked", *asked)[0] == 0
    drawn = Path("asked/soft-mu_ratio-sweep.svg").read_text(encoding="utf-8")
    for words in (">restitution<", "impact.restitution"):  # in words, and the key in small
        assert words in drawn
    assert pound("report", made / "swept.h5", "-q", "--no-figures", "-o", "page")[0] == 0
    assert set(pd.read_csv("page/tables/statements.csv")["impact.restitution"]) == {0.4, 0.5, 0.65}


@NIGHTLY
def test_sweeps_of_several_files_are_drawn_as_asked(made, folder, pound):
    both = ["report", made / "two.h5", made / "swept.h5", "-q", "--format", "svg", "-o", "both"]
    assert pound(*both, "--case", "touching", "--where", "storey=2")[0] == 0
    assert [*Path("both/swept").glob("*-sweep.svg")]
    code, _, err = pound(
        "report", made / "gap.h5", made / "swept.h5", "--building", "soft", "--format", "svg", "-o", "more"
    )
    assert code == 0
    assert "gap.h5: the file holds the answer of `pound gap`, so --building soft does not apply to it" in err


def test_cells_without_meaning_are_hatched(made):
    """Fails if a hatched cell cannot be seen, or one that has a meaning is hatched."""
    results = pounding_cli.open_results(made / "maps.h5")
    picture = next(each for section in report(results).sections for each in section.pictures if each.has_scale)
    panels = {ax.get_title(loc="left"): ax for ax in picture.draw().axes}
    (hatched,) = panels["connected, elastic"].patches
    assert hatched.get_hatch()
    assert hatched.get_edgecolor()[3] == 1
    corners = hatched.get_path().vertices
    assert np.ptp(corners, axis=0).tolist() == [3, 2]
    assert np.count_nonzero(hatched.get_path().codes == MplPath.MOVETO) == 6  # all cells
    assert not panels["touching, elastic"].patches
    assert not panels["gap, elastic"].patches


@NIGHTLY
def test_maps_of_ratios_have_one_scale_with_1_in_its_middle(made):
    """Fails if a panel has colours of its own, or 1 has another colour than white; of other quantities too there is one
    scale."""
    results = pounding_cli.open_results(made / "maps.h5")
    for asked, is_ratio in ((None, True), (Asked(("acceleration_ratio",)), True), (Asked(("drift",)), False)):
        sections = report(results, asked).sections
        pictures = [each for section in sections for each in section.pictures if each.has_scale]
        for axes in (picture.draw().axes for picture in pictures):
            meshes = [mesh for ax in axes for mesh in ax.collections if isinstance(mesh, QuadMesh)]
            *panels, bar = meshes
            assert len(panels) >= 4
            assert len({(mesh.norm.vmin, mesh.norm.vmax) for mesh in meshes}) == 1
            if is_ratio:
                assert panels[0].norm(1.0) == pytest.approx(0.5)
                assert min(panels[0].to_rgba(1.0)) > 0.95
                assert [1.0, 1.0] in [list(line.get_ydata()) for line in bar.axes.lines]


def test_a_run_is_told_without_its_figures_over_the_sweep(made, monkeypatch):
    """They take long: fails if they are made for a terminal too."""
    monkeypatch.setattr("pounding_cli.questions.run.figures.list_sweep_pictures", None)
    report(pounding_cli.open_results(made / "swept.h5")).print()


@pytest.mark.parametrize(("most", "quantities"), [(650, "3 of 14"), (10, None)])
def test_a_page_carries_no_more_numbers_than_it_may(made, folder, pound, monkeypatch, most, quantities):
    """Of a large sweep means and the largest over the height, of fewer quantities; none where not one has room."""
    monkeypatch.setattr("pounding_cli.report.widgets.MOST_VALUES", most)
    assert pound("report", made / "swept.h5", "-q", "--no-figures", "-o", "page") == (0, "", "")
    page = Path("page/report.html").read_text(encoding="utf-8")
    assert ('id="explorer"' in page) == (quantities is not None)
    told = f"{quantities} quantities" if quantities else "too large to look around here; tables/ has all numbers."
    assert told in page
    assert "0 of 14" not in page


def test_keys_with_the_same_words_are_told_apart(folder, pound):
    """Fails if the first table calls the stiffness of two links, or of two laws, by one name."""
    links = (
        "links: [{link: connector, floors: 1, stiffness: 1 kN/mm}, {link: connector, floors: 2, stiffness: 1 kN/mm}]"
    )
    study = TWO.replace("gap: {link: pounding, gap: 5 mm}", f"joined: {{gap: 2 cm, {links}}}")
    keys = [f"cases.joined.links.{number}.stiffness" for number in (0, 1)]
    sweep = "".join(f"  {key}: [1 kN/mm, 2 kN/mm]\n" for key in keys)
    Path("two.yaml").write_text(f"{study}sweep:\n{sweep}  impact.restitution: [0.4, 0.5]\n")
    assert pound("run", "two.yaml", "-q")[0] == 0
    table = report(pounding_cli.open_results("results/two.h5")).answer.tables[0].frame.to_string()
    assert all(f"{key} = " in table for key in keys)
    assert ", restitution = " in table


def test_figures_of_a_notebook_have_a_white_ground(made):
    """Fails if black lines stand on the dark page of a notebook; the page of a report inverts its figures."""
    shown = report(pounding_cli.open_results(made / "two.h5"))._repr_html_()
    svg = base64.b64decode(re.search(r"data:image/svg\+xml;base64,([^\"]+)", shown)[1]).decode()
    assert "fill: #ffffff" in svg.split('id="axes_1"')[0]


def test_a_study_without_links_is_told(folder, pound):
    Path("two.yaml").write_text(TWO[: TWO.index("  touching")] + "  apart: {link: none}\nanalyses: [elastic]\n")
    code, out, _ = pound("run", "two.yaml")
    assert code == 0
    assert "apart" in out


@NIGHTLY
def test_keys_that_move_together_are_fixed_together(folder, pound):
    """Fails if the key that is not given keeps the value of the study's own point."""
    Path("two.yaml").write_text(
        TWO + "sweep:\n  - {cases.gap.gap: [5 mm, 6 mm]}\n"
        "  - {impact.restitution: [0.4, 0.5], impact.stiffness: [1 MN/mm, 2 MN/mm]}\n"
    )
    pound("run", "two.yaml", "-q")
    asked = (
        "results/two.h5",
        "-q",
        "--format",
        "svg",
        "--quantity",
        "drift",
        "--where",
        "restitution=0.5",
    )
    assert pound("report", *asked)[0] == 0
    drawn = re.sub("<[^>]+>", " ", Path("results/two/soft-drift-sweep.svg").read_text(encoding="utf-8"))
    assert "impact.restitution = 0.5; impact.stiffness = 2 MN/mm" in " ".join(drawn.split())


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["two.h5", "--quantity", "mu_ratio"], "sweeps nothing"), (["two.h5", "--case", "gap"], "sweeps nothing"),
        (["gap.h5", "--quantity", "nonsense"], "the answer of `pound gap`"),
        (["gap.h5", "--where", "storey=1"], "the answer of `pound gap`"),
        (["gap.h5", "two.h5", "--building", "soft"], "the answer of `pound gap`"),
        (["gap.h5", "swept.h5", "--quantity", "nonsense"], "no quantity 'nonsense'"),
        (["swept.h5", "--analysis", "plastic"], "elastic, inelastic"), (["swept.h5", "--record", "worst"], "worst"),
        (["swept.h5", "--where", "restitution=0.5"], "no swept key"),
        (["swept.h5", "--quantity", "shear_demand"], "no case has"),
        (["swept.h5", "--quantity", "peak_force", "--case", "apart"], "no number of peak_force in case apart"),
        (["gap.h5", "--no-figures", "--format", "png"], "contradict"),
        (["swept.h5", "--no-figures", "--quantity", "drift"], "contradict"),
        (["swept.h5", "--quantity", "mue"], "mu_ratio"),
        (["swept.h5", "--case", "gip"], "touching, gap"), (["swept.h5", "--where", "storey=8"], "1, 2, 3"),
        (["swept.h5", "--where", "restitution=0.7"], "0.4, 0.5, 0.65"), (["missing.h5"], "missing.h5"),
        (["two.yaml"], "is a study"), (["."], "folder"), (["swept.h5", "--case", "touching", "--case", "gap"], "twice"),
    ],
)  # fmt: skip
def test_what_cannot_be_drawn_is_refused(made, folder, pound, arguments, message):
    """Nothing is written; where one of several files is bad, neither."""
    names = [each for each in arguments if each.endswith((".h5", ".yaml")) or each == "."]
    files, options = [made / name for name in names], arguments[len(names) :]
    options += [] if "--no-figures" in options else ["--format", "svg"]
    for several in (files, [made / "swept.h5", *files]) if files[0].suffix != ".h5" else (files,):
        code, out, err = pound("report", *several, *options, "-q", "-o", "out")
        assert (code, out) == (2, "")
        assert message in err
        assert "Traceback" not in err
        assert not Path("out").exists()


@NIGHTLY
def test_a_target_spectrum_is_drawn(folder, pound):
    target = ", scale: {spectrum: mean, target: {0.1 s: 0.8 g, 2 s: 0.2 g}, from: 0.2 s, to: 1 s, at_least: 0.9}}"
    Path("two.yaml").write_text(TWO.replace("3 s}", f"3 s{target}"))
    pound("run", "two.yaml", "-q")
    assert pound("report", "results/two.h5", "-q", "--format", "png")[0] == 0
    assert Path("results/two/target-spectrum.png").stat().st_size > 10_000


def test_what_limits_the_numbers_stands_on_the_page(folder, pound):
    """Warnings with their lines, and scenes that have no meaning, by name."""
    spring = "spring: {link: connector, gap: 2, stiffness: 1 kN/mm}\n  close: {link: connector, gap: 1 mm}"
    text = TWO.replace("gap: {link: pounding, gap: 5 mm}", spring).replace(", inelastic", "")
    values = "[5 x stiffest storey, 20 x stiffest storey, 100 x stiffest storey]"
    sweep = f"sweep: {{impact.stiffness: {{values: {values}, middle: 20 x stiffest storey}}}}\n"
    Path("two.yaml").write_text(text + sweep)
    pound("run", "two.yaml", "-q")
    pound("report", "results/two.h5", "--no-figures", "-o", "out")
    page = words(Path("out/report.html"))
    assert "gap is 2 m" in page
    assert "Line 9 of the study" in page
    assert "100 x stiffest storey" in page
    assert re.search(r"close, elastic, 6 of 6 rows.*a joint closes more than the gap", page)


def test_a_gap_that_never_closes_is_no_effect_of_the_page(folder, pound):
    """Fails if its sentence is taken for the name of an effect that is not used in the study."""
    wide = TWO.replace("gap: 5 mm", "gap: 50 cm").replace(", inelastic", "")
    Path("two.yaml").write_text(wide)
    pound("run", "two.yaml", "-q")
    pound("report", "results/two.h5", "--no-figures", "-o", "out", "-q")
    page = words(Path("out/report.html"))
    rest = re.search(r"not used in this study: ([^.]*)", page)[1].split(" Cases")[0]
    assert "tension cut-off" in rest
    assert "stiff" not in rest
    assert not re.search("links(?! of the kinds)", rest)
    assert "stiff | soft: the gap never closes in 2 of 4 runs, in which no force acts across it." in page


NASTY = (
    "../../out",
    *(pytest.param(name, marks=NIGHTLY) for name in ("'=1+1'", "'<script>alert(1)</script>'", "'a;b|c&d ü'")),
)


@pytest.mark.parametrize("name", NASTY)
def test_names_cannot_leave_the_folder_or_become_code(folder, pound, name):
    """Names of cases and titles are refused or shown as text. Fails if one becomes a path, a formula or HTML."""
    Path("work").mkdir()
    study = TWO.replace("Two small buildings", name).replace("gap: {", f"{name}: {{").replace(", inelastic", "")
    Path("work/two.yaml").write_text(study, encoding="utf-8")
    if pound("run", "work/two.yaml", "-o", "work/r.h5", "-q")[0] == 2:
        Path("work/two.yaml").write_text(study.replace(f"  {name}: {{", "  gap: {"), encoding="utf-8")
        if pound("run", "work/two.yaml", "-o", "work/r.h5", "-q")[0] == 2:
            return
    before = set(folder.iterdir())
    assert pound("report", "work/r.h5", "-q", "--format", "png")[0] == 0
    assert pound("export", "work/r.h5", "-o", "work/out.xlsx")[0] == 0
    assert set(folder.iterdir()) == before
    assert "<script>alert" not in Path("work/r/report.html").read_text(encoding="utf-8")
    for path in Path("work").rglob("*.csv"):
        assert not re.search(r"(^|,)[=@]", path.read_text(encoding="utf-8"), flags=re.MULTILINE)
