"""docs/reproduction.md says what the studies of Figs 6 and 7 give with the motions that ship."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path

import pytest
from scipy.stats import binomtest

from pounding_cli.api import run
from pounding_cli.batch import run_plan
from pounding_cli.report.claims import judge
from pounding_cli.report.evidence import points
from pounding_cli.store import open_results
from pounding_cli.store.indices import independent_samples
from pounding_cli.study import expand, load_study
from pounding_cli.study.claim_names import claims_about
from pounding_cli.study.sampled import at_points
from pounding_cli.study.sensitivity import question_of

ROOT = Path(__file__).parents[3]
COLUMN = {"fig6": 0, "fig7": 2}
"""The columns of the page's tables that stand on stand-ins only."""
SAMPLES = 6
"""Samples of the studies of what the paper leaves open that are run again."""
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


@pytest.mark.parametrize("figure", ["fig6", "fig7"])
def test_the_probabilities_are_those_of_the_shipped_study(page, figure, tmp_path, monkeypatch):
    """The rows are the claims about the figure, and a few samples of the study do not contradict them. Fails if a row
    is missing, or if a claim that holds by the page is found not to hold at most samples, or the other way round."""
    monkeypatch.delenv("POUND_RECORDS", raising=False)
    monkeypatch.setenv("POUND_HOME", str(tmp_path / "home"))
    section = f"Fig. {figure[-1]}, over what the paper leaves open"
    rows = {first: cells for (where, first), cells in page.items() if where == section}
    rows.pop("claim")
    rows.pop("---", None)
    assert list(rows) == list(claims_about(figure))
    study = load_study(ROOT / "configs" / "sensitivity" / f"open-{figure}.yaml")
    question = question_of(study)
    some = question.cube[independent_samples(question)][:SAMPLES]
    keys = [number for number, factor in enumerate(question.factors) if factor.key != "motion"]
    plan = expand(at_points(study, question.keys, some[:, keys]))
    run_plan(plan, tmp_path / "some.h5", engine_name="serial")
    found = Counter(
        (judgement.claim.key, str(judgement.verdict))
        for evidence in points(open_results(tmp_path / "some.h5"))
        for judgement in judge(evidence)
    )
    for claim, cells in rows.items():
        for verdict, cell in zip(("holds", "holds partly", "does not hold"), cells, strict=False):
            share, low, high = map(float, re.fullmatch(r"(\S+) \((\S+) to (\S+)\)", cell).groups())
            assert 0 <= low <= share <= high <= 1
            count = found[claim, verdict]
            likely = min(max(count / SAMPLES, low), high)  # the probability of the page that fits best
            assert binomtest(count, SAMPLES, likely).pvalue > 1e-3, (claim, verdict, count, cell)
