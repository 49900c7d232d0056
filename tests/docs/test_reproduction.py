"""docs/reproduction.md has the verdicts and thresholds of Figs 6 and 7 with the motions that ship, and on which side of
every choice the connection affects the inelastic buildings more."""

from __future__ import annotations

import re
from itertools import product
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
import yaml
from click.testing import CliRunner

import pounding_cli
from pounding_cli.cli.main import cli
from pounding_cli.paper import claims, verdicts
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


@pytest.fixture(scope="module", params=["fig6", "fig7"])
def judged(request, tmp_path_factory) -> tuple[str, dict[str, str], pounding_cli.Results]:
    """The figure, its verdicts as `pound report` prints them, and its results."""
    folder = tmp_path_factory.mktemp(request.param)
    study = (ROOT / "configs" / f"{request.param}.yaml").read_text(encoding="utf-8")
    (folder / "study.yaml").write_text(re.sub(r"^estimate:.*$", "", study, flags=re.MULTILINE) + "estimate: none\n")
    results = pounding_cli.run(folder / "study.yaml", folder / "r.h5", engine="serial")
    words = ["report", str(results.path), "-o", str(folder / "out"), "--no-figures"]
    said = CliRunner().invoke(cli, words, catch_exceptions=False).output
    return request.param, dict(re.findall(r"^  ([a-z-]+) {2,}(.+)$", said, re.MULTILINE)), results


def test_the_verdicts_are_those_of_the_page(judged):
    figure, verdicts, _ = judged
    rows = [row for row in read_rows("Verdicts") if "](#" in row[0]]
    page = {re.match(r"\[(.+?)\]", row[0])[1]: row[COLUMN[figure]] for row in rows}
    assert len(verdicts) > 10
    assert verdicts == {claim: verdict for claim, verdict in page.items() if verdict != "–"}


def test_the_thresholds_are_those_of_the_page(judged):
    """Fails if a threshold moves either way."""
    _, _, results = judged
    page = {row[0]: row[2] for row in read_rows("Statements")}
    numbers = verdicts.judge_claims(results)
    for claim, mine in numbers.groupby("claim"):
        assert page[claim] == ", ".join(dict.fromkeys(mine["threshold"])), claim
    assert page.keys() - {"claim"} == claims.CLAIMS.keys()


def test_the_verdict_of_every_number_follows_from_its_threshold(judged):
    """Fails if the threshold in words is not the one that decides."""
    _, _, results = judged
    for row in verdicts.judge_claims(results).to_dict("records"):
        words = dict(re.findall(r"(at least|at most|above|below) (-?[\d.]+)", row["threshold"]))
        number = row["number"]
        holds = [
            {"at least": number >= end, "at most": number <= end, "above": number > end, "below": number < end}[word]
            for word, end in ((word, float(end)) for word, end in words.items())
        ]
        assert holds, row
        assert row["passed"] == all(holds), row


@pytest.mark.parametrize(
    ("threshold", "inside", "outside"),
    [
        (claims.Threshold(low=0.9), [0.9, 2.0], [0.899, np.nan]),
        (claims.Threshold(high=1.1), [1.1, -1.0], [1.101]),
        (claims.Threshold(0, 15, is_open=True), [1e-9, 14.9], [0.0, 15.0, -1.0]),
    ],
)
def test_the_ends_of_a_threshold(threshold, inside, outside):
    found = threshold.contains(xr.DataArray([*inside, *outside])).values
    assert found.tolist() == [True] * len(inside) + [False] * len(outside)


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
    assert verdicts["connection-other"].startswith("holds (") == all((each < 1).all() for each in means)
    assert "largest storey: holds partly" in verdicts["connection-other"]
    assert [bool((each < 1).all()) for each in largest] == [True, False]


def test_floors_that_are_not_connected_stay_apart(judged):
    """The number of the claim is the largest closing of the links table; none of these links strikes."""
    figure, _, results = judged
    links = results.link()
    free = links[(links["case"] == "connected") & (links["kind"] == "pounding")]
    assert set(free["floor"]) == {1, 2, 4}
    assert free["impacts"].sum() == 0
    numbers = verdicts.judge_claims(results)
    (number,) = numbers[numbers["claim"] == "connection-levels"]["number"]
    assert number == pytest.approx(100 * (free["max_closing"] / free["gap"]).max())
    if figure == "fig6":
        assert 100 * free["max_closing"].max() == pytest.approx(2.28, abs=0.005)  # cm


def test_a_connector_pulls_and_pushes(judged):
    """What the claim says of the sums over time is so at single instants."""
    _, _, results = judged
    numbers = verdicts.judge_claims(results).set_index("finding")["number"]
    words = "force of a connector summed over a motion, pulling negative"
    assert numbers[f"{words}, smallest"] < 0 < numbers[f"{words}, largest"]
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
    """Fails if eq. (7) as printed changes another verdict by the mean than the page says, or does not change one."""
    study = (ROOT / "configs" / f"{figure}.yaml").read_text(encoding="utf-8")
    (tmp_path / "study.yaml").write_text(study.replace("restitution: 0.5}", "restitution: 0.5, dashpot: printed}"))
    pounding_cli.run(tmp_path / "study.yaml", tmp_path / "r.h5", engine="serial")
    words = ["report", str(tmp_path / "r.h5"), "-o", str(tmp_path / "out"), "--no-figures"]
    said = CliRunner().invoke(cli, words, catch_exceptions=False).output
    printed = dict(re.findall(r"^  ([a-z-]+) {2,}([a-z ]+?)(?: \(.+)?$", said, re.MULTILINE))
    rows = [row for row in read_rows("Verdicts") if "](#" in row[0]]
    expected = {re.match(r"\[(.+?)\]", row[0])[1]: row[COLUMN[figure]].partition(" (")[0] for row in rows}
    name = f", Fig. {figure[-1]}, "
    for row in read_rows("Equations that are not computed as printed"):
        if name in row[0]:
            claim = row[0].partition(name)[0]
            assert expected[claim] == row[1]
            expected[claim] = row[2]
    assert printed == {claim: verdict for claim, verdict in expected.items() if verdict != "–"}


@NIGHTLY
@pytest.mark.parametrize(
    ("figure", "choice"), [each for each in product(COLUMN, CHOICES) if each != ("fig6", "arrangement")]
)
def test_the_side_of_every_choice_is_that_of_the_page(figure, choice, tmp_path):
    """μ/μ0 less V/V0 of the stiffer building when connected, by both readings."""
    rows = {row[0]: row[COLUMN[figure]] for row in read_rows("On which side of each choice")}
    name = f"{choice}{'-fig7' * (figure == 'fig7')}.yaml"
    study = yaml.safe_load((ROOT / "configs" / "sensitivity" / name).read_text(encoding="utf-8"))
    study["cases"] = {"connected": study["cases"]["connected"]}
    study["estimate"] = "none"
    del study["report"]
    (tmp_path / "study.yaml").write_text(yaml.safe_dump(study, sort_keys=False))
    results = pounding_cli.run(tmp_path / "study.yaml", tmp_path / "r.h5", engine="serial")
    numbers = verdicts.judge_claims(results)
    numbers = numbers[(numbers["claim"] == "connection-stiffer") & (numbers["measure"] != "")]
    found = [
        "; ".join(f"{value:+.3f}".replace("-", "−") for value in mine["number"])
        for _, mine in numbers.groupby("where", sort=False)
    ]
    assert len(found) == len(CHOICES[choice])
    for label, cell in zip(CHOICES[choice], found, strict=True):
        if label:
            assert rows[label] == cell, label
