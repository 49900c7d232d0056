"""Reading the report's page as a person does."""

from __future__ import annotations

import html
import re
from pathlib import Path


def words(page: Path | str, section: str = "") -> str:
    """The words of a page, or of one of its sections by id; white space folded."""
    text = page.read_text(encoding="utf-8") if isinstance(page, Path) else page
    if section:
        text = re.split(rf'<(?:section|header) id="{section}"', text)[1].split("</section>")[0]
    text = text.split("<main", 1)[-1].split("<script", 1)[0]
    return re.sub(r"\s+", " ", html.unescape(re.sub(r"<[^>]+>", " ", text)))


def choose(page, name: str, value: str, within: str = "body") -> None:
    """Choose an option of a control in a browser's page, by the control's name."""
    page.locator(within).get_by_label(name, exact=True).select_option(value)
