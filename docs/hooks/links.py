"""Links of pages into the code, which work in the repository, lead on the site to the page that is made from it."""

from __future__ import annotations

import posixpath
import re
from typing import Any

SITE_PAGES = {
    "../pounding_cli/laws": "laws/index.md",
    "../pounding_cli/methods.py": "reference/methods.md",
    "../pounding_cli/study/schema/study.py": "reference/keys.md",
    "../pounding_cli/study/schema/quantity.py": "reference/keys.md#plausible-values",
    "../pounding_cli/cli": "reference/commands.md",
    "../pounding_cli/__init__.py": "reference/api.md",
    "gallery": "gallery/index.md",
}
"""File or folder, from docs/ -> the page of the site that is written from it."""

_LINK = re.compile(r"\]\((?P<path>[^)#\s:]+)\)")


def replace_links(markdown: str, page: str) -> str:
    """Return the text of a page, `page` from docs/, with its links as the site has them."""
    folder = posixpath.dirname(page)

    def replace(link: re.Match[str]) -> str:
        target = posixpath.normpath(posixpath.join(folder, link["path"]))
        if target not in SITE_PAGES:
            return link[0]
        return f"]({posixpath.relpath(SITE_PAGES[target], folder or '.')})"

    return _LINK.sub(replace, markdown)


def on_page_markdown(markdown: str, page: Any, **_: object) -> str:
    """Return what mkdocs is to draw of a page that stands in docs/; written pages have links of the site already."""
    return markdown if page.file.generated_by else replace_links(markdown, page.file.src_uri)
