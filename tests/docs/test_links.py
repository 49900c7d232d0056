"""Every relative link leads to a file of the repository and a heading that is there, or to a page that the site writes
from the code (mkdocs checks the headings of those)."""

from __future__ import annotations

import re

import pytest
from pages import PAGES, ROOT, generated

_LINK = re.compile(r"\]\((?P<path>[^)#\s:]*)(?:#(?P<anchor>[^)\s]*))?\)")
_FENCE = re.compile(r"^ *```.*?^ *```", re.MULTILINE | re.DOTALL)


def anchors(text: str) -> set[str]:
    """The anchors that headings get: lower case, blanks as hyphens, other signs left out."""
    headings = re.findall(r"^#+ (.+)$", _FENCE.sub("", text), flags=re.MULTILINE)
    return {re.sub(r"[-\s]+", "-", re.sub(r"[^\w\s-]", "", heading).strip().lower()) for heading in headings}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_lead_somewhere(page):
    text = _FENCE.sub("", page.read_text(encoding="utf-8"))
    lost = []
    for link in _LINK.finditer(text):
        target = (page.parent / link["path"]).resolve() if link["path"] else page
        there = target.exists() and target.is_relative_to(ROOT)
        if there and link["anchor"] and target.suffix == ".md":
            there = link["anchor"] in anchors(target.read_text(encoding="utf-8"))
        if not there and target not in generated():
            lost.append(link[0][2:-1])
    assert not lost
