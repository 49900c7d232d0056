"""Texts from studies and other untrusted files, made safe for file names, the screen, cells and Markdown."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas as pd

CONTROL = re.compile(
    "[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028\u2029\u202a-\u202e\u2066-\u2069\ud800-\udfff\ufffe\uffff]"
    "|\r(?!\n)"
)
"""Characters that move a cursor or turn the direction of writing, and codes of no character; not line ends and tabs."""

_NUMBER_AND_UNIT = re.compile(r"(?<=\d) (?=(?:%|[A-Za-zµ]{1,2}|[kM]N/?m{0,2}|ms)(?!\w))|(?<=\d [kM]N) (?=[ms]\b)")
"""The blank between a number and a short unit."""

_FORMULA = ("=", "+", "-", "@", "\t", "\r")
_LONGEST_NAME = 120
"""Bytes of a file name in UTF-8; most disks allow 255, and suffixes follow."""


def to_file_name(text: str) -> str:
    """A name for a file in a given folder, from any text: no separators, no dots in front; never empty."""
    name = re.sub(r"[^\w +.-]+", "-", text).strip(" .-")
    return name.encode()[:_LONGEST_NAME].decode(errors="ignore").strip() or "unnamed"


def escape_controls(text: str) -> str:
    """Return a text with control characters written out, as `\\x1b`."""
    return CONTROL.sub(lambda match: match[0].encode("unicode_escape").decode(), text)


def escape_controls_in_tree(value: Any) -> Any:
    """`escape_controls` of every text in nested lists and mappings."""
    if isinstance(value, dict):
        return {
            escape_controls(key) if isinstance(key, str) else key: escape_controls_in_tree(item)
            for key, item in value.items()
        }
    if isinstance(value, list):
        return [escape_controls_in_tree(item) for item in value]
    return escape_controls(value) if isinstance(value, str) else value


def join_units(text: str) -> str:
    """Return a text in which no line ends between a number and its unit: the blank there is one that does not break."""
    return _NUMBER_AND_UNIT.sub("\N{NO-BREAK SPACE}", text)


def wrap_text(text: str, width: int, breaks_words: bool = True) -> list[str]:
    """Return the lines of a text; a number and its unit stay together where a line has room for both.

    breaks_words : whether a word longer than a line is broken, so that no line is longer than the width
    """
    lines = textwrap.wrap(join_units(text), max(width, 1), break_long_words=breaks_words, break_on_hyphens=False)
    return [line.replace("\N{NO-BREAK SPACE}", " ") for line in lines]


def escape_formulas(frame: pd.DataFrame) -> pd.DataFrame:
    """A table for CSV: a text that a spreadsheet would take for a formula is marked as text by a "'" before it."""
    frame = frame.rename(columns=escape_formula)
    texts = {name: frame[name].map(escape_formula) for name in frame.columns if frame[name].dtype.kind not in "biufcmM"}
    return frame.assign(**texts)


def escape_formula_list(texts: Iterable[str]) -> list[str]:
    """Return texts for cells of CSV as `escape_formulas` has them."""
    return [escape_formula(text) for text in texts]


def escape_formula(value: Any) -> Any:
    return f"'{value}" if isinstance(value, str) and value.startswith(_FORMULA) else value


def write_markdown(path: Path, lines: Iterable[str]) -> Path:
    """Write a Markdown page in which no text is taken for HTML; line breaks in table cells (`<br>`) stay."""
    text = "\n".join(lines).rstrip() + "\n"
    path.write_text(re.sub(r"<(?!br>)", "&lt;", text), encoding="utf-8")
    return path
