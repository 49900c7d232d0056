"""What a terminal prints of a report, as texts that are kept beside results and need neither these nor pandas."""

from __future__ import annotations

import functools
import hashlib
import io
import json
import sys
import textwrap
from dataclasses import asdict, dataclass
from pathlib import Path

from pounding_cli.numbers import pluralize

PIPE_WIDTH = 250
"""Characters of a line where no terminal sets them: nothing is cut or wrapped."""

PARAGRAPH_WIDTH = 118
"""Characters of a line of a paragraph."""


@dataclass(frozen=True)
class TextTable:
    """A table of texts as they are printed.

    caption : above it; "" for none
    heads : of the columns
    is_right : of every column whether it is aligned to the right
    rows : cells, row by row
    more : rows of the table that are left out here
    """

    caption: str
    heads: tuple[str, ...]
    is_right: tuple[bool, ...]
    rows: tuple[tuple[str, ...], ...]
    more: int = 0

    def lay_out(self, width: int | None) -> str:
        """Return the lines of the table for a terminal of so many characters; of its own width unless given."""
        from rich import box
        from rich.console import Console
        from rich.table import Table

        table = Table(box=box.SIMPLE_HEAD, pad_edge=False, title=self.caption or None, title_justify="left")
        for place, (head, is_right) in enumerate(zip(self.heads, self.is_right, strict=True)):
            table.add_column(head, justify="right" if is_right else "left", no_wrap=place == 0)
        for row in self.rows:
            table.add_row(*row)
        drawn = io.StringIO()
        Console(file=drawn, width=width, markup=False).print(table)  # [cm] is a unit
        return drawn.getvalue()


@dataclass(frozen=True)
class Summary:
    """Title, tables and paragraphs of a report's answer."""

    title: str
    tables: tuple[TextTable, ...]
    paragraphs: tuple[str, ...]

    def print(self) -> None:
        """Print it."""
        width = None if sys.stdout.isatty() else PIPE_WIDTH
        print(self.title)
        for table in self.tables:
            print(table.lay_out(width), end="")
            if table.more > 0:
                print(f"{pluralize(table.more, 'more row')}: pound report, or pound show")
        for paragraph in self.paragraphs:
            print(textwrap.fill(paragraph, PARAGRAPH_WIDTH, break_long_words=False, break_on_hyphens=False))

    def to_json(self) -> str:
        """Return it as JSON, for `read_summary`."""
        return json.dumps(asdict(self))


def read_summary(text: str) -> Summary | None:
    """Return a summary that `to_json` wrote; None where the text is none."""
    try:
        fields = json.loads(text)
        tables = [
            TextTable(
                str(table["caption"]), tuple(table["heads"]), tuple(table["is_right"]),
                tuple(map(tuple, table["rows"])), int(table["more"]),
            )
            for table in fields["tables"]
        ]  # fmt: skip
        return Summary(str(fields["title"]), tuple(tables), tuple(fields["paragraphs"]))
    except (ValueError, KeyError, TypeError):
        return None


@functools.cache
def program_digest() -> str:
    """Return the SHA-256 of the sources of this package: another program may word a summary otherwise."""
    package = Path(__file__).parents[1]
    sha = hashlib.sha256()
    for source in sorted((*package.rglob("*.py"), *package.rglob("*.csv"))):
        sha.update(str(source.relative_to(package)).encode() + b"\0" + source.read_bytes())
    return sha.hexdigest()
