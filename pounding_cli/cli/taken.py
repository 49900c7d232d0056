"""What was taken of the plain files of motions that a study declares, for people."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from pounding_cli.texts import escape_controls

if TYPE_CHECKING:
    from pounding_cli.study.study import Study

MAX_SHOWN = 20
"""Files of which it is shown what was taken."""


def describe_taken_files(study: Study) -> Iterator[str]:
    """Yield, of every plain file of a study, a line with what was taken and one with the lines that were not read."""
    taken = study.list_taken_files()
    for first, *more in taken[:MAX_SHOWN]:
        yield escape_controls(first)
        yield from (f"  {escape_controls(line)}" for line in more)
    if len(taken) > MAX_SHOWN:
        yield f"... and {len(taken) - MAX_SHOWN} more files; `pound records show FILE` tells what is taken of one"
