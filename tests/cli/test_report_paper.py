"""`pound report --figures-for-paper`, and what a paper cites."""

from __future__ import annotations

import pytest
import yaml

import pounding_cli
from tests.night import NIGHTLY

from .conftest import TWO

TITLE = "Two small buildings"


@pytest.fixture
def solved(pound, folder):
    """Results over a swept key; returns the runner of `pound report`."""
    (folder / "two.yaml").write_text(TWO + "sweep: {cases.gap.gap: [1 cm, 2 cm, 3 cm]}\n")
    pound("run", "two.yaml", "-o", "r.h5")
    return lambda *arguments: pound("report", "r.h5", "-q", *arguments)


@NIGHTLY
def test_figures_for_a_paper_are_vectors_without_title_and_caption(solved, folder):
    assert solved("-o", "paper", "--figures-for-paper")[0] == 0
    drawn = sorted(path.name for path in (folder / "paper").glob("*.*"))
    assert "captions.md" in drawn
    assert "report.html" not in drawn
    assert {name.partition(".")[2] for name in drawn} == {"svg", "pdf", "md"}
    for path in (folder / "paper").glob("*.svg"):
        text = path.read_text()
        assert TITLE not in text
        assert "Motions: stand-in" not in text
    captions = (folder / "paper" / "captions.md").read_text()
    assert captions.count("Motions: stand-in") == len(list((folder / "paper").glob("*.svg")))
    curves = (folder / "paper" / "soft-sweep.svg").read_text()
    assert ">gap [cm]<" in curves  # in the unit of the study
    assert "cases.gap.gap" not in curves


@NIGHTLY
def test_figures_have_their_title_and_caption_otherwise(solved, folder):
    solved("-o", "usual", "--format", "svg")
    text = (folder / "usual" / "soft-sweep.svg").read_text()
    assert TITLE in text
    assert "cases.gap.gap" in text
    assert "Motions: stand-in" in text
    assert not (folder / "usual" / "captions.md").exists()


def test_no_figures_for_a_paper_are_refused(solved):
    code, _, err = solved("--figures-for-paper", "--no-figures")
    assert code == 2
    assert "contradict" in err


def test_the_program_is_cited_with_authors_and_version(pound):
    entry = pound("cite", "two.yaml", "--format", "bibtex")[1].partition("\n}")[0]
    assert "author = {{pounding\\_cli contributors}}" in entry
    assert f"version = {{{pounding_cli.__version__}}}" in entry
    with open(f"{pounding_cli.__path__[0]}/../CITATION.cff", encoding="utf-8") as file:
        assert yaml.safe_load(file)["authors"] == [{"name": "pounding_cli contributors"}]
