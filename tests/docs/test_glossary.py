"""The glossary's words: those that it rules out stand in no page, no help text and no message."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest
from pages import PAGES, ROOT

GLOSSARY = ROOT / "docs" / "glossary.md"
METAPHORS = (
    "shelf", "ashore", "spoilt", "proves monotony", "slower than life", "end otherwise", "on a hair", "astray",
    "fall apart", "falls apart", "nobody knows", "for ever", "of late", "goodbye", "honestly", "in silence",
    "gives up", "gave up", "twice over", "put right", "by the dozen",
)  # fmt: skip
"""Metaphors and private turns for plain things, besides what the glossary rules out."""

_ROW = re.compile(r"^\| (?P<term>[^|]+) \| (?P<meaning>[^|]+) \| (?P<instead>[^|]*) \|$", re.MULTILINE)


def rows() -> list[re.Match[str]]:
    return [row for row in _ROW.finditer(GLOSSARY.read_text(encoding="utf-8")) if row["term"] != "term"]


BANNED = sorted({*METAPHORS, *(word for row in rows() for word in row["instead"].split(", ") if word)})
_BANNED = re.compile(rf"\b({'|'.join(map(re.escape, BANNED))})\b", re.IGNORECASE)


def found(text: str) -> list[str]:
    """Words that are ruled out; a line break counts as a blank."""
    return _BANNED.findall(re.sub(r"\s+", " ", text))


@pytest.mark.parametrize("page", [page for page in PAGES if page != GLOSSARY], ids=lambda page: page.name)
def test_pages_keep_to_the_glossary(page):
    assert found(page.read_text(encoding="utf-8")) == []


@pytest.mark.parametrize("module", sorted((ROOT / "pounding_cli").rglob("*.py")), ids=lambda path: path.stem)
def test_help_messages_and_docstrings_keep_to_the_glossary(module: Path):
    """Every text of the package: a command's help is its docstring, a message is a text or a part of one."""
    tree = ast.parse(module.read_text(encoding="utf-8"))
    texts = [node.value for node in ast.walk(tree) if isinstance(node, ast.Constant) and isinstance(node.value, str)]
    assert found("\n".join(texts)) == []


def test_no_two_terms_share_a_word_that_is_ruled_out():
    terms = [part.strip() for row in rows() for part in row["term"].split(",")]
    assert len(terms) == len(set(terms))
    assert len(terms) > 40
    assert not {term.lower() for term in terms} & {word.lower() for word in BANNED}


def test_ruled_out_words_are_found():
    assert found("two rows of a Street,\nand one energy that\nwent astray") == ["Street", "energy that went astray"]
