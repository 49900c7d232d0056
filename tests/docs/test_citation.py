"""CITATION.cff is well formed and says what the package says of itself."""

from __future__ import annotations

import datetime
import re
import tomllib
from pathlib import Path

import pytest
import yaml

import pounding_cli
from pounding_cli.laws import link_laws, storey_laws
from pounding_cli.methods import METHODS
from pounding_cli.report.references import REFERENCES, parse_references

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
    assert (
        f"{cff['authors'][0]['name']} ({cff['date-released'].year}). {cff['title']}. "
        in REFERENCES["pounding_cli"].text
    )
    assert cff["authors"][0]["name"].lower() in Path("LICENSE").read_text(encoding="utf-8").lower()


def test_the_paper_is_the_one_that_pound_cite_lists(cff):
    (paper,) = cff["references"]
    people = " & ".join(f"{author['family-names']}, {author['given-names']}" for author in paper["authors"])
    assert (
        f"{people} ({paper['year']}). {paper['title']}. {paper['collection-title']}, "
        in REFERENCES["spiliopoulos1996"].text
    )


@pytest.mark.parametrize(
    ("name", "citation"),
    [(each.name, each.citation) for each in (*link_laws().values(), *storey_laws().values(), *METHODS.values())],
)
def test_what_laws_and_methods_cite_is_there(name, citation):
    for key, _ in citation:
        assert key in REFERENCES


def test_an_entry_is_read_as_people_cite_it():
    """Fails if names, escapes, volume or the dash of pages are left as BibTeX has them."""
    entry = (
        "@article{a2000,\n  author = {Li, A. B. and Po, C. and Wu, D.},\n  title = {{Beams & rods}},\n"
        "  year = {2000},\n  journal = {Soil \\& Rock},\n  volume = {2},\n  number = {3},\n  pages = {4--5}\n}"
    )
    (found,) = parse_references(f"% first\n\n{entry}\n").values()
    assert found.text == "Li, A. B., Po, C. & Wu, D. (2000). Beams & rods. Soil & Rock 2(3), 4-5."
    assert found.bibtex == entry


def test_every_entry_is_read_with_all_its_fields():
    """Fails where an entry of the file is not written as the others, or a key is there twice."""
    text = (Path(pounding_cli.__path__[0]) / "report" / "references.bib").read_text(encoding="utf-8")
    assert len(REFERENCES) == text.count("\n@")
    assert all(len(each.fields) == each.bibtex.count("\n") - 1 for each in REFERENCES.values())
