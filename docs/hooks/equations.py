"""Equations of the pages, `$...$` and `$$...$$` in LaTeX, as MathML: browsers draw it without a script or a font."""

from __future__ import annotations

import html
import re

from latex2mathml.converter import convert

_EQUATION = re.compile(r'<(?P<tag>span|div) class="arithmatex">\\[(\[](?P<tex>.*?)\\[)\]]</(?P=tag)>', re.DOTALL)


def on_page_content(text: str, **_: object) -> str:
    """Called by mkdocs with the HTML of every page, in which arithmatex has marked the equations."""
    return _EQUATION.sub(_drawn, text)


def _drawn(found: re.Match[str]) -> str:
    display = "block" if found["tag"] == "div" else "inline"
    drawn = convert(html.unescape(found["tex"]).strip(), display=display)
    return f'<div class="equation">{drawn}</div>' if display == "block" else drawn
