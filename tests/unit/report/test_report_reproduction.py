"""docs/reproduction.md says what the studies of Figs 6 and 7 give with the motions that ship."""

from __future__ import annotations

from pathlib import Path

import pytest

from pounding_cli.api import run
from pounding_cli.report.claims import judge
from pounding_cli.report.evidence import points

ROOT = Path(__file__).parents[3]
COLUMN = {"fig6": 0, "fig7": 2}
"""The columns of the page's tables that stand on stand-ins only."""
TOLERANCE = {"-": 0.02, "%": 2.0, "cm": 0.1}


@pytest.fixture(scope="module")
def page():
    """Every row of the page's tables by section and first cell, as lists of the other cells."""
    rows, section = {}, ""
    for line in (ROOT / "docs" / "reproduction.md").read_text(encoding="utf-8").splitlines():
        if line.startswith("#"):
            section = line.lstrip("# ")
        elif line.startswith("| "):
            first, *cells = (cell.strip() for cell in line.strip("|").split(" | "))
            rows[section, first] = cells
    return rows


@pytest.fixture(scope="module", params=["fig6", "fig7"])
def judged(request, tmp_path_factory):
    """The figure and its judgements, from the motions that ship."""
    folder = tmp_path_factory.mktemp(request.param)
    with pytest.MonkeyPatch.context() as patch:
        patch.delenv("POUND_RECORDS", raising=False)
        patch.setenv("POUND_HOME", str(folder / "home"))
        results = run(ROOT / "configs" / f"{request.param}.yaml", folder / "results.h5", engine="serial")
    assert set(results.records()["source"]) == {"stand-in"}
    assert (results.scene()["status"] == "done").all()
    return request.param, judge(points(results)[0])


def test_verdicts_are_those_of_the_page(page, judged):
    figure, judgements = judged
    for judgement in judgements:
        key = judgement.claim.key
        assert page["Verdicts", f"[{key}](#{key})"][COLUMN[figure]] == judgement.verdict, key


def test_numbers_are_those_of_the_page(page, judged):
    figure, judgements = judged
    compared = 0
    for judgement in judgements:
        for finding in judgement.findings:
            words = finding.words.replace(" (stand-in)", "").split(" (no test")[0]
            row = next(
                cells for (section, first), cells in page.items()
                if section == judgement.claim.key and first.split(" (built")[0] == words
            )  # fmt: skip
            said = row[COLUMN[figure]].strip("*").split(" ")[0]
            assert float(said) == pytest.approx(finding.number, abs=TOLERANCE[finding.unit]), words
            compared += 1
    assert compared > 30
