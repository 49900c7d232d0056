"""`pound explain`: what a warning or a note means, by its code."""

from __future__ import annotations

import difflib
import textwrap

import click

from pounding_cli.errors import InputError
from pounding_cli.notes import NOTES, Severity
from pounding_cli.report.summary import PARAGRAPH_WIDTH

_KINDS = {
    Severity.DOUBT: "It is doubtful, and allowed",
    Severity.NOTE: "It limits what the numbers say",
    Severity.ERROR: "It takes the meaning from the numbers that it marks, and cannot be accepted",
}


@click.command()
@click.argument("code", required=False)
def explain(code: str | None) -> None:
    """Explain a warning or a note by the CODE in front of it; without a CODE, list them all.

    \b
    Example:
      pound explain stiffness
    """
    if code is None:
        width = max(map(len, NOTES))
        for note in NOTES.values():
            click.echo(f"{note.code:{width}}  {note.title}")
        return
    code = code.strip("[]")
    if code not in NOTES:
        near = difflib.get_close_matches(code, NOTES, 1)
        hint = f"did you mean {near[0]}?" if near else "`pound explain` lists them"
        raise InputError(f"there is no note '{code}'", hint)
    note = NOTES[code]
    means = _KINDS[note.severity]
    if note.can_be_accepted:
        means += f"; a study silences it by `accept: [{code}]`"
    click.echo(f"[{code}] {note.title}\n")
    click.echo(textwrap.fill(note.explanation, PARAGRAPH_WIDTH))
    click.echo(textwrap.fill(f"{means}.", PARAGRAPH_WIDTH))
