"""CITATION.cff is well formed and says what the package says of itself."""

from __future__ import annotations

import datetime
import re
import tomllib
from pathlib import Path

import pytest
import yaml

import pounding_cli
from pounding_cli.report.references import PAPER, PROGRAM

REQUIRED = {"cff-version", "message", "title", "authors"}
ALLOWED = REQUIRED | {
    "abstract", "commit", "contact", "date-released", "doi", "identifiers", "keywords", "license", "license-url",
    "preferred-citation", "references", "repository", "repository-artifact", "repository-code", "type", "url",
    "version",
}  # fmt: skip
"""Keys of the Citation File Format 1.2.0."""


@pytest.fixture(scope="module")
def cff():
    return yaml.safe_load(Path("CITATION.cff").read_text(encoding="utf-8"))


def test_keys_and_types_are_those_of_the_format(cff):
    assert cff["cff-version"] == "1.2.0"
    assert set(cff) >= REQUIRED
    assert set(cff) <= ALLOWED
    assert cff["type"] in ("software", "dataset")
    assert isinstance(cff["date-released"], datetime.date)
    assert len(cff["keywords"]) == len(set(cff["keywords"]))
    for author in cff["authors"]:
        assert set(author) <= {"name"} or {"family-names", "given-names"} <= set(author)
    for reference in cff["references"]:
        assert {"type", "title", "authors"} <= set(reference)
        assert re.fullmatch("[A-Z]{2}", reference["conference"]["country"])


def test_it_agrees_with_the_package(cff):
    project = tomllib.loads(Path("pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert cff["version"] == project["version"] == pounding_cli.__version__
    assert cff["license"] == project["license"]
    assert cff["keywords"] == project["keywords"]
    assert f"{cff['authors'][0]['name']} ({cff['date-released'].year}). {cff['title']}. " in PROGRAM.text
    assert cff["authors"][0]["name"].lower() in Path("LICENSE").read_text(encoding="utf-8").lower()


def test_the_paper_is_the_one_that_pound_cite_lists(cff):
    (paper,) = cff["references"]
    people = " & ".join(f"{author['family-names']}, {author['given-names']}" for author in paper["authors"])
    assert f"{people} ({paper['year']}). {paper['title']}. {paper['collection-title']}, " in PAPER.text
