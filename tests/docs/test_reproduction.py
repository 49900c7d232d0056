"""docs/reproduction.md has the verdicts on Figs 6 and 7 with the motions that ship, and on which side of every choice
the connection affects the inelastic buildings more."""

from __future__ import annotations

import re
from itertools import product
from pathlib import Path

import pytest
import yaml
from click.testing import CliRunner

import pounding_cli
from pounding_cli.cli.main import cli
from tests.night import NIGHTLY

ROOT = Path(__file__).parents[2]
COLUMN = {"fig6": 1, "fig7": 3}
CHOICES = {
    "foundation": ["as chosen", *(f"foundation, {k} MN/m" for k in (8000, 4000, 2000, 1000, 500))],
    "arrangement": ["as chosen", "[stiff, soft, soft]", "[stiff, stiff, soft]", "[stiff, soft, stiff]"],
    "connector-damping": ["connectors without a dashpot", "", "", "as chosen", "connectors, 30 %"],
    "connector-stiffness": ["as chosen", "connectors, 1/5 mean storey of soft"],
    "roof-mass": ["as chosen", "roofs of half the mass"],
}
"""A study of configs/sensitivity: the rows of the page that its points are, "" where a point has none."""


def read_rows(heading: str) -> list[list[str]]:
    """Return the cells of all rows of the table below a heading of the page, its head first."""
    text = (ROOT / "docs" / "reproduction.md").read_text(encoding="utf-8")
    section = re.split(rf"^## {heading}$", text, flags=re.MULTILINE)[1].split("\n## ")[0]
    lines = [line for line in section.splitlines() if line.startswith("| ")]
    rows = [[cell.strip() for cell in line.strip("|").split(" | ")] for line in lines]
    return [row for row in rows if set(row[0]) != {"-"}]


@pytest.fixture(autouse=True, scope="module")
def stand_ins(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.delenv("POUND_RECORDS", raising=False)
        patch.setenv("POUND_HOME", str(tmp_path_factory.mktemp("home")))
        yield


MARK = re.compile(r" (?:\(.+\)|~)")
"""What stands behind the word of a verdict: how many tests are met, and whether a small change may turn it."""


def read_verdicts(figure: str, cell: int | None = None) -> dict[str, str]:
    """Return the verdicts of the page on a figure by the names of their statements, without counts and marks."""
    column = COLUMN[figure] if cell is None else cell
    rows = {row[0].strip("`"): MARK.sub("", row[column]) for row in read_rows("Verdicts")[1:]}
    return {name: verdict for name, verdict in rows.items() if verdict != "–"}


def report_verdicts(results: Path, folder: Path) -> dict[str, str]:
    """Return the verdicts that `pound report` prints, without counts and marks."""
    words = ["report", str(results), "-o", str(folder), "--no-figures"]
    said = CliRunner().invoke(cli, words, catch_exceptions=False).output
    return {name: MARK.sub("", verdict) for name, verdict in re.findall(r"^  ([a-z-]+) {2,}(.+)$", said, re.MULTILINE)}


@pytest.fixture(scope="module", params=["fig6", "fig7"])
def judged(request, tmp_path_factory) -> tuple[str, dict[str, str], pounding_cli.Results]:
    """The figure, its verdicts as `pound report` prints them, and its results."""
    folder = tmp_path_factory.mktemp(request.param)
    study = (ROOT / "configs" / f"{request.param}.yaml").read_text(encoding="utf-8")
    (folder / "study.yaml").write_text(re.sub(r"^estimate:.*$", "", study, flags=re.MULTILINE) + "estimate: none\n")
    results = pounding_cli.run(folder / "study.yaml", folder / "r.h5", engine="serial")
    return request.param, report_verdicts(results.path, folder / "out"), results


def test_the_verdicts_are_those_of_the_page(judged):
    figure, verdicts, _ = judged
    assert len(verdicts) > 15
    assert verdicts == read_verdicts(figure)


def test_every_statement_has_its_row():
    """Of what the paper says and of what was found; the two readings of one share a row."""
    names = {name.removesuffix("-largest") for figure in COLUMN for name in read_verdicts(figure)}
    rows = [name.strip("`") for row in read_rows("Statements")[1:] for name in row[0].split(", ")]
    assert sorted(rows) == sorted(names)


def test_a_verdict_follows_from_the_table(judged):
    """The connection relieves every building but the stiffest: mean ratios below 1, mean over the storeys, and at the
    largest storey."""
    _, verdicts, results = judged
    table = results.storey()
    others = table[(table["case"] == "connected") & table["building"].str.startswith("soft")]
    means, largest = [], []
    for analysis, column in (("elastic", "V_ratio"), ("inelastic", "mu_ratio")):
        rows = others[others["analysis"] == analysis]
        means.append(rows.groupby("building", observed=True)[column].mean())
        largest.append(rows.groupby(["building", "storey"], observed=True)[column].mean())
    assert (verdicts["connection-other"] == "holds") == all((each < 1).all() for each in means)
    assert verdicts["connection-other-largest"] == "holds partly"
    assert [bool((each < 1).all()) for each in largest] == [True, False]


def test_floors_that_are_not_connected_stay_apart(judged):
    """The number of the claim is the largest closing of the links table; none of these links strikes."""
    figure, _, results = judged
    links = results.link()
    free = links[(links["case"] == "connected") & (links["kind"] == "pounding")]
    assert set(free["floor"]) == {1, 2, 4}
    assert free["impacts"].sum() == 0
    rows = results.table("statements").query("statement == 'connection-levels'")
    assert rows["number"].max() == pytest.approx(free["max_closing"].max())
    if figure == "fig6":
        assert 100 * free["max_closing"].max() == pytest.approx(2.28, abs=0.005)  # cm


def test_a_connector_pulls_and_pushes(judged):
    """What the statements say of the sums over time is so at single instants."""
    _, verdicts, results = judged
    assert verdicts["connection-pulls"] == verdicts["connection-pushes"] == "holds"
    forces = results.history(case="connected").frame("link_force")
    joined = [column for column in forces.columns if re.search("floor [35]", str(column))]
    assert joined
    assert (forces[joined].min() < 0).all()
    assert (forces[joined].max() > 0).all()


def test_the_accelerations_of_connected_buildings_are_those_of_the_page(judged):
    """Fails if the fall by the connection, or what is left over the buildings alone, is another one."""
    figure, _, results = judged
    page = {row[0]: row[COLUMN[figure]] for row in read_rows("Accelerations of connected buildings")}
    data = results.dataset
    peaks, ratios = data["acceleration"], data["acceleration_ratio"].sel(case="connected")
    for kind in ("stiff", "soft"):
        mine = [name for name in data["building"].values.tolist() if name.startswith(kind)]
        for base, words in (("touching", "in touch"), ("infill", "with the infill")):
            kept = (peaks.sel(case="connected") / peaks.sel(case=base)).sel(building=mine)
            falls = 100 * (1 - kept.mean(["record", "floor", "building"]))
            elastic, inelastic = (falls.sel(analysis=each).item() for each in ("elastic", "inelastic"))
            assert page[f"less than {words}, {kind}"] == f"{elastic:.0f} %; {inelastic:.0f} %"
        alone = ratios.sel(building=mine).mean(["record", "floor", "building"])
        elastic, inelastic = (alone.sel(analysis=each).item() for each in ("elastic", "inelastic"))
        assert page[f"over those alone, {kind}"] == f"{elastic:.2f}; {inelastic:.2f}"


@NIGHTLY
@pytest.mark.parametrize("figure", COLUMN)
def test_the_verdicts_by_the_printed_dashpot_are_those_of_the_page(figure, tmp_path):
    """Fails if eq. (7) as printed changes another verdict than the page says, or does not change one."""
    study = (ROOT / "configs" / f"{figure}.yaml").read_text(encoding="utf-8")
    (tmp_path / "study.yaml").write_text(study.replace("restitution: 0.5}", "restitution: 0.5, dashpot: printed}"))
    pounding_cli.run(tmp_path / "study.yaml", tmp_path / "r.h5", engine="serial")
    printed = report_verdicts(tmp_path / "r.h5", tmp_path / "out")
    expected = read_verdicts(figure)
    name = f", Fig. {figure[-1]}, "
    for row in read_rows("Equations that are not computed as printed"):
        if name in row[0]:
            statement = row[0].partition(name)[0].strip("`")
            assert expected[statement] == row[1]
            expected[statement] = row[2]
    assert printed == expected


@NIGHTLY
@pytest.mark.parametrize(
    ("figure", "choice"), [each for each in product(COLUMN, CHOICES) if each != ("fig6", "arrangement")]
)
def test_the_side_of_every_choice_is_that_of_the_page(figure, choice, tmp_path):
    """μ/μ0 less V/V0 of the stiffer building when connected, by both readings."""
    rows_of_page = {row[0]: row[COLUMN[figure]] for row in read_rows("On which side of each choice")}
    name = f"{choice}{'-fig7' * (figure == 'fig7')}.yaml"
    study = yaml.safe_load((ROOT / "configs" / "sensitivity" / name).read_text(encoding="utf-8"))
    study["statements"] = [
        each
        for each in yaml.safe_load((ROOT / "configs" / f"{figure}.yaml").read_text(encoding="utf-8"))["statements"]
        if each["name"].startswith("connection-stiffer")
    ]
    study["cases"] = {"connected": study["cases"]["connected"]}
    study["estimate"] = "none"
    del study["report"]
    (tmp_path / "study.yaml").write_text(yaml.safe_dump(study, sort_keys=False))
    results = pounding_cli.run(tmp_path / "study.yaml", tmp_path / "r.h5", engine="serial")
    rows = results.table("statements")
    keys = list(results.axes)
    found: dict[tuple, list[str]] = {}
    for name in ("connection-stiffer", "connection-stiffer-largest"):
        mine = rows[(rows["statement"] == name) & rows["comparison"].str.contains("mu_ratio.* > .*V_ratio")]
        for row in mine.to_dict("records"):
            found.setdefault(tuple(row[key] for key in keys), []).append(f"{row['margin']:+.3f}".replace("-", "−"))
    cells = ["; ".join(both) for both in found.values()]
    assert len(cells) == len(CHOICES[choice])
    for label, cell in zip(CHOICES[choice], cells, strict=True):
        if label:
            assert rows_of_page[label] == cell, label
