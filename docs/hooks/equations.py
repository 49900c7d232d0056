"""Equations of the pages, `$...$` and `$$...$$` in LaTeX, as MathML: browsers draw it without a script or a font."""

from __future__ import annotations

import html
import re

from latex2mathml.converter import convert

_EQUATION = re.compile(r'<(?P<tag>span|div) class="arithmatex">\\[(\[](?P<tex>.*?)\\[)\]]</(?P=tag)>', re.DOTALL)


def on_page_content(text: str, **_: object) -> str:
    """Called by mkdocs with the HTML of every page, in which arithmatex has marked the equations.

    Raises
    ------
    ValueError : an equation has a command or an environment that latex2mathml does not know
    """
    return _EQUATION.sub(_drawn, text)


def _drawn(found: re.Match[str]) -> str:
    display = "block" if found["tag"] == "div" else "inline"
    tex = html.unescape(found["tex"]).strip()
    drawn = convert(tex, display=display)
    if "<mi>&</mi>" in drawn or "\\" in drawn:
        raise ValueError(f"not all of this equation could be typeset: {tex}")
    return f'<div class="equation">{drawn}</div>' if display == "block" else drawn
