"""What a command prints to: terminals without these characters, streams that are closed or whose reader has gone."""

from __future__ import annotations

import codecs
import io
import os
import sys
import textwrap
from contextlib import suppress
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from pounding_cli.errors import Problem

_PLAIN = {
    "±": "+-", "×": "x", "·": "*", "–": "-", "−": "-", "—": "-", "→": "->", "≤": "<=", "≥": ">=",
    "μ": "mu", "σ": "sigma", "†": "!", "µ": "u", "²": "2", "³": "3", "₀": "0", "“": '"', "”": '"',
    "’": "'", "…": "...", "─": "-",
} | dict(zip("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789", strict=True))  # fmt: skip
"""What stands for a character where the terminal has none."""


_LONG = 300
"""Characters of a warning that stand in one line."""


class _Ascii(io.TextIOWrapper):
    """A stream of ASCII that click leaves alone; it would take one that says so for misconfigured, and write UTF-8."""

    encoding = property(lambda self: "ascii, meant")


def prepare() -> None:
    """Make `sys.stdout` and `sys.stderr` fit to print to: closed ones lead nowhere, unknown characters are replaced."""
    for name in ("stdin", "stdout", "stderr"):
        if getattr(sys, name) is None:  # closed; a file opened next would take its number
            setattr(sys, name, open(os.devnull, "r" if name == "stdin" else "w"))  # noqa: SIM115
    codecs.register_error("plain", _plain)
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if not isinstance(stream, io.TextIOWrapper):
            continue
        if codecs.lookup(stream.encoding).name == "ascii":
            setattr(sys, name, _Ascii(stream.buffer, "ascii", "plain", line_buffering=stream.line_buffering))
        else:
            stream.reconfigure(errors="plain")


def echo_warning(problem: Problem) -> None:
    """Print a warning to standard error; a long list in it takes several lines."""
    text = f"warning: {problem}"
    if len(problem.message) > _LONG:
        first, *rest = text.split("\n")
        lines = textwrap.wrap(first, 100, subsequent_indent="    ", break_long_words=False, break_on_hyphens=False)
        text = "\n".join([*lines, *rest])
    click.echo(text, err=True)


def silence() -> None:
    """Nobody reads `sys.stdout` or `sys.stderr` any more: what is still to be written to it is dropped."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except (OSError, ValueError):
            with suppress(OSError, ValueError):
                os.dup2(nowhere, stream.fileno())
    os.close(nowhere)


def _plain(error: UnicodeError) -> tuple[str, int]:
    assert isinstance(error, UnicodeEncodeError)
    return "".join(_PLAIN.get(each, "?") for each in error.object[error.start : error.end]), error.end
