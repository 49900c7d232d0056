"""Tables of texts as a terminal prints them, in as many characters as it has."""

from __future__ import annotations

import io
import textwrap
from dataclasses import dataclass, replace

PIPE_WIDTH = 250
"""Characters of a line where no terminal sets them: nothing is cut or wrapped."""

MIN_TEXT_WIDTH = 24
"""Characters to which a column of texts may be wrapped."""

_SPACE = 3
"""Characters between two columns."""

_EDGES = 2
"""Characters before the first column and behind the last one."""


@dataclass(frozen=True)
class TextTable:
    """A table of texts.

    caption : above it; "" for none
    heads : of the columns
    is_right : of every column whether it is aligned to the right
    rows : cells, row by row
    more : rows of the table that are left out here
    is_optional : of every column whether it may be left out where there is no room
    """

    caption: str
    heads: tuple[str, ...]
    is_right: tuple[bool, ...]
    rows: tuple[tuple[str, ...], ...]
    more: int = 0
    is_optional: tuple[bool, ...] = ()

    def lay_out(self, width: int | None) -> str:
        """Return the lines of the table for a terminal of so many characters; `PIPE_WIDTH` unless given.

        Where there is no room for all columns, optional ones are left out, the last ones first, and named below; where
        there is none for the others either, every row becomes a block of lines.
        """
        width = PIPE_WIDTH if width is None else width
        table = self
        left_out: list[str] = []
        while table._min_width() > width and any(table.is_optional):
            place = len(table.is_optional) - 1 - table.is_optional[::-1].index(True)
            left_out.insert(0, table.heads[place])
            table = table._without(place)
        if table._min_width() > width:
            return self._lay_out_blocks(width)
        text = table._lay_out_grid(width)
        if not left_out:
            return text
        note = f"Left out at this width: {', '.join(left_out)}"
        return f"{text}{textwrap.fill(note, width, break_long_words=False, break_on_hyphens=False)}\n"

    def _min_width(self) -> int:
        """Return how many characters the columns need, with texts wrapped to MIN_TEXT_WIDTH."""
        widths = [self._column_width(place) for place in range(len(self.heads))]
        return sum(widths) + _SPACE * (len(widths) - 1) + _EDGES

    def _column_width(self, place: int) -> int:
        from rich.cells import cell_len

        lines = [line for row in self.rows for line in row[place].split("\n")]
        natural = max(map(cell_len, [self.heads[place], *lines]))
        if self.is_right[place] or place == 0:
            return natural
        words = [word for line in [self.heads[place], *lines] for word in line.split()]
        longest_word = max(map(cell_len, words), default=0)
        return min(natural, max(MIN_TEXT_WIDTH, longest_word))

    def _without(self, place: int) -> TextTable:
        def cut(values: tuple) -> tuple:
            return values[:place] + values[place + 1 :]

        rows = tuple(map(cut, self.rows))
        return replace(
            self, heads=cut(self.heads), is_right=cut(self.is_right), rows=rows, is_optional=cut(self.is_optional)
        )

    def _lay_out_grid(self, width: int) -> str:
        from rich import box
        from rich.console import Console
        from rich.table import Table

        table = Table(box=box.SIMPLE_HEAD, pad_edge=False, title=self.caption or None, title_justify="left")
        for place, (head, is_right) in enumerate(zip(self.heads, self.is_right, strict=True)):
            table.add_column(head, justify="right" if is_right else "left", no_wrap=is_right or place == 0)
        for row in self.rows:
            table.add_row(*row)
        drawn = io.StringIO()
        Console(file=drawn, width=width, markup=False).print(table)  # [cm] is a unit
        return "".join(f"{line.rstrip()}\n" for line in drawn.getvalue().splitlines())

    def _lay_out_blocks(self, width: int) -> str:
        """Return a block of lines for every row: its texts at the left as heading, then a line a column."""
        first = next((place for place, right in enumerate(self.is_right) if right), min(2, len(self.heads) - 1))
        heading_count = max(1, min(first, 2))
        lines = [self.caption] if self.caption else []
        label_width = max(map(len, self.heads[heading_count:]), default=0)
        for row in self.rows:
            lines += ["", ", ".join(filter(None, row[:heading_count]))]
            for head, cell in zip(self.heads[heading_count:], row[heading_count:], strict=True):
                text = "; ".join(filter(None, cell.split("\n")))
                indent = " " * (label_width + 4)
                lines += textwrap.wrap(
                    text, width, initial_indent=f"  {head:<{label_width}}  ", subsequent_indent=indent,
                    break_long_words=False, break_on_hyphens=False,
                ) or [f"  {head}"]  # fmt: skip
        return "\n".join(lines) + "\n"
