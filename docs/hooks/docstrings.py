"""Docstrings as this project writes them, put in the form that mkdocstrings reads.

Here a section's entry is `name : meaning`, further lines indented, and a blank line ends the section; numpydoc has
`name : type`, the meaning indented below, and sections that last to the end.
"""

from __future__ import annotations

import inspect
import re

import griffe

_SECTION = re.compile(r"(Parameters|Attributes|Raises|Returns)\n-+\n")


def tidied(text: str) -> str:
    """The docstring with its sections last, every meaning below its name."""
    words, sections = [], []
    for block in inspect.cleandoc(text).split("\n\n"):
        found = _SECTION.match(block)
        if found is None:
            words.append(block)
            continue
        lines = []
        for line in block[found.end() :].splitlines():
            entry = re.match(r"(\S.*?) : (.*)", line)
            lines += [entry[1], f"    {entry[2]}"] if entry else [line]
        sections.append(found[0] + "\n".join(lines))
    return "\n\n".join([*words, *sections])


class Tidied(griffe.Extension):
    """Tidies the docstring of whatever is drawn."""

    def on_object(self, *, obj: griffe.Object, **_: object) -> None:
        """Called by griffe for every module, class, function and attribute."""
        if obj.docstring is not None:
            obj.docstring.value = tidied(obj.docstring.value)
