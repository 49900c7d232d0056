"""Every relative link leads to a file of the repository and a heading that is there; on the site those into the code
lead to the page that is written from it."""

from __future__ import annotations

import re

import pytest
from pages import PAGES, ROOT, generated, hook

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
        if not there:
            lost.append(link[0][2:-1])
    assert not lost


def test_links_into_the_code_lead_to_pages_of_the_site():
    """mkdocs knows no file outside docs/. Fails if a link has no page there, or the page is none of the site."""
    links = hook("links")
    for place, named in links.SITE_PAGES.items():
        assert (ROOT / "docs" / place).exists()
        assert ROOT / "docs" / named.partition("#")[0] in generated()
    for page in (page for page in PAGES if page.is_relative_to(ROOT / "docs")):
        name = page.relative_to(ROOT / "docs").as_posix()
        text = links.replace_links(_FENCE.sub("", page.read_text(encoding="utf-8")), name)
        for link in _LINK.finditer(text):
            target = (page.parent / link["path"]).resolve() if link["path"] else page
            assert target.is_relative_to(ROOT / "docs"), link[0]
            assert not target.is_dir(), link[0]
