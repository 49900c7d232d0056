"""The summary of a report that a terminal prints, as texts kept beside results, which need neither these nor pandas."""

from __future__ import annotations

import functools
import hashlib
import json
import shutil
import sys
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

from pounding_cli.numbers import pluralize
from pounding_cli.text_tables import TextTable
from pounding_cli.texts import wrap_text

PARAGRAPH_WIDTH = 118
"""Characters of a line of a paragraph, where the terminal is not narrower."""


@dataclass(frozen=True)
class Summary:
    """The summary of a report that a terminal prints.

    sentences : the answer, one paragraph each
    tables : below them
    notes : what a reader should know of the numbers
    """

    title: str
    sentences: tuple[str, ...]
    tables: tuple[TextTable, ...]
    notes: tuple[str, ...]

    def print(self) -> None:
        """Print it, in the width of the terminal."""
        width = shutil.get_terminal_size().columns if sys.stdout.isatty() else None
        print("\n".join(self.iter_lines(width)))

    def iter_lines(self, width: int | None) -> Iterator[str]:
        """Yield the lines for a terminal of so many characters, or for a file."""
        room = PARAGRAPH_WIDTH if width is None else min(width, PARAGRAPH_WIDTH)
        yield self.title
        for sentence in self.sentences:
            yield "\n".join(wrap_text(sentence, room, breaks_words=False))
        for table in self.tables:
            yield ""
            yield table.lay_out(width).strip("\n")
            if table.more > 0:
                yield f"{pluralize(table.more, 'more row')}: pound report, or pound show"
        if self.tables and self.notes:
            yield ""
        for note in self.notes:
            yield "\n".join(wrap_text(note, room, breaks_words=False))

    def to_json(self) -> str:
        """Return it as JSON, for `read_summary`."""
        return json.dumps(asdict(self))


def read_summary(text: str) -> Summary | None:
    """Return a summary that `to_json` wrote; None where the text is none."""
    try:
        fields = json.loads(text)
        tables = tuple(_read_table(table) for table in fields["tables"])
        return Summary(str(fields["title"]), tuple(fields["sentences"]), tables, tuple(fields["notes"]))
    except (ValueError, KeyError, TypeError):
        return None


def _read_table(fields: dict) -> TextTable:
    return TextTable(
        str(fields["caption"]),
        tuple(fields["heads"]),
        tuple(fields["is_right"]),
        tuple(map(tuple, fields["rows"])),
        int(fields["more"]),
        tuple(fields["is_optional"]),
    )


@functools.cache
def program_digest() -> str:
    """Return the SHA-256 of the sources of this package: another program may word a summary otherwise."""
    package = Path(__file__).parents[1]
    sha = hashlib.sha256()
    for source in sorted(package.rglob("*.py")):
        sha.update(str(source.relative_to(package)).encode() + b"\0" + source.read_bytes())
    return sha.hexdigest()
