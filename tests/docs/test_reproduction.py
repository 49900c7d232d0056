"""docs/reproduction.md has the verdicts that the studies of Figs 6 and 7 give with the motions that ship."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from click.testing import CliRunner

import pounding_cli
from pounding_cli.cli.main import cli

ROOT = Path(__file__).parents[2]
COLUMN = {"fig6": 1, "fig7": 3}


@pytest.fixture(scope="module", params=["fig6", "fig7"])
def judged(request, tmp_path_factory) -> tuple[str, dict[str, str], pounding_cli.Results]:
    """The figure, its verdicts as `pound report` prints them, and its results."""
    folder = tmp_path_factory.mktemp(request.param)
    with pytest.MonkeyPatch.context() as patch:
        patch.delenv("POUND_RECORDS", raising=False)
        patch.setenv("POUND_HOME", str(folder / "home"))
        study = (ROOT / "configs" / f"{request.param}.yaml").read_text(encoding="utf-8")
        (folder / "study.yaml").write_text(re.sub(r"^estimate:.*$", "", study, flags=re.MULTILINE) + "estimate: none\n")
        results = pounding_cli.run(folder / "study.yaml", folder / "r.h5", engine="serial")
    words = ["report", str(results.path), "-o", str(folder / "out"), "--no-figures"]
    said = CliRunner().invoke(cli, words, catch_exceptions=False).output
    return request.param, dict(re.findall(r"^  ([a-z-]+) {2,}(.+)$", said, re.MULTILINE)), results


def test_the_verdicts_are_those_of_the_page(judged):
    figure, verdicts, _ = judged
    text = (ROOT / "docs" / "reproduction.md").read_text(encoding="utf-8")
    rows = [[cell.strip() for cell in line.strip("|").split(" | ")] for line in text.splitlines() if "](#" in line]
    page = {re.match(r"\[(.+?)\]", row[0])[1]: row[COLUMN[figure]] for row in rows if row[0].startswith("[")}
    assert len(verdicts) > 8
    assert verdicts == {claim: verdict for claim, verdict in page.items() if verdict != "–"}


def test_a_verdict_follows_from_the_table(judged):
    """The connection relieves every building but the stiffest: mean ratios below 1, mean over the storeys."""
    _, verdicts, results = judged
    table = results.storey()
    others = table[(table["case"] == "connected") & table["building"].str.startswith("soft")]
    means = [
        others[others["analysis"] == analysis].groupby("building", observed=True)[column].mean()
        for analysis, column in (("elastic", "V_ratio"), ("inelastic", "mu_ratio"))
    ]
    assert (verdicts["connection-other"] == "holds") == all((each < 1).all() for each in means)
