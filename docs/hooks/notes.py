"""Write docs/notes.md from the catalogue: run this file after a note is added or worded anew."""

from __future__ import annotations

import textwrap
from pathlib import Path

from pounding_cli.notes import NOTES, Severity

PAGE = Path(__file__).parents[1] / "notes.md"


def notes_page() -> str:
    """The catalogue of notes by code."""
    parts = [
        "# Notes",
        textwrap.dedent("""\
        What may be doubtful in a study, and what limits numbers, by the code in front of it: `[stiffness]`. `pound
        explain stiffness` prints an entry, and a study silences it by `accept: [stiffness]`; the page then says that
        it did. What takes the meaning from numbers cannot be silenced."""),
    ]
    for heading, severity in (
        ("What may be doubtful in a study", Severity.DOUBT),
        ("What limits numbers", Severity.NOTE),
        ("What takes the meaning from numbers", Severity.ERROR),
    ):
        parts.append(f"## {heading}")
        for note in NOTES.values():
            if note.severity is severity:
                parts += [f"### {note.code}", f"*{note.title}*", note.explanation]
    return "\n\n".join(parts) + "\n"


if __name__ == "__main__":
    PAGE.write_text(notes_page(), encoding="utf-8")
