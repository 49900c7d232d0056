"""Tables of texts as a terminal prints them, in as many characters as it has."""

from __future__ import annotations

import io
from dataclasses import dataclass, replace
from typing import Literal

from pounding_cli.texts import wrap_text

PIPE_WIDTH = 250
"""Characters of a line where no terminal sets them: nothing is cut or wrapped."""

MIN_TEXT_WIDTH = 24
"""Characters to which a column of texts may be wrapped."""

MAX_WRAPPED_LINES = 3
"""Lines of a cell beyond which a table becomes blocks."""

MIN_BLOCK_WIDTH = 12
"""Characters that a value in a block has at least beside its label; with less it stands below the label."""

MAX_HEADINGS = 3
"""Columns at most that name the block of a row."""

_SPACE = 3
"""Characters between two columns."""


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
        there is none for the others either, every row becomes a block of lines. Without a terminal nothing is left out.
        """
        if width is None:
            needed = self._min_width(wraps=False)
            return self._lay_out_grid(max(PIPE_WIDTH, needed))
        table = self
        left_out: list[str] = []
        while not table._fits(width) and any(table.is_optional):
            place = len(table.is_optional) - 1 - table.is_optional[::-1].index(True)
            left_out.insert(0, table.heads[place])
            table = table._without(place)
        if not table._fits(width):
            return self._lay_out_blocks(width)
        text = table._lay_out_grid(width)
        if not left_out:
            return text
        note = f"Left out for lack of room: {', '.join(left_out)}"
        return text + "\n".join(wrap_text(note, width)) + "\n"

    def _fits(self, width: int) -> bool:
        """Return whether a grid of so many characters cuts no cell, and wraps none into many lines."""
        if self._min_width() > width:
            return False
        if self._min_width(wraps=False) <= width:
            return True
        lines = [len(wrap_text(line, MIN_TEXT_WIDTH)) for row in self.rows for cell in row for line in cell.split("\n")]
        return max(lines, default=1) <= MAX_WRAPPED_LINES

    def _min_width(self, wraps: bool = True) -> int:
        """Return how many characters the columns need.

        wraps : whether texts are wrapped to MIN_TEXT_WIDTH
        """
        widths = [self._column_width(place, wraps) for place in range(len(self.heads))]
        return sum(widths) + _SPACE * len(widths)

    def _column_width(self, place: int, wraps: bool) -> int:
        lines = [line for row in self.rows for line in row[place].split("\n")]
        natural = max(map(_measure, [self.heads[place], *lines]))
        if not wraps or self._keeps_lines(place):
            return natural
        words = [word for line in [self.heads[place], *lines] for word in line.split()]
        longest_word = max(map(_measure, words), default=0)
        return min(natural, max(MIN_TEXT_WIDTH, longest_word))

    def _keeps_lines(self, place: int) -> bool:
        """Return whether the lines of a column are never wrapped: numbers, and names at the left."""
        return self.is_right[place] or place == 0

    def _without(self, place: int) -> TextTable:
        def cut(values: tuple) -> tuple:
            return values[:place] + values[place + 1 :]

        rows = tuple(map(cut, self.rows))
        return replace(
            self, heads=cut(self.heads), is_right=cut(self.is_right), rows=rows, is_optional=cut(self.is_optional)
        )

    def _lay_out_grid(self, width: int) -> str:
        """Return the caption, the headings above a rule, and the rows, with texts wrapped to their columns."""
        from rich import box
        from rich.console import Console
        from rich.table import Table

        table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
        for place, column_width in enumerate(self._choose_widths(width)):
            justify: Literal["right", "left"] = "right" if self.is_right[place] else "left"
            table.add_column(self.heads[place], justify=justify, width=column_width, overflow="fold")
        for row in self.rows:
            table.add_row(*row)
        drawn = io.StringIO()
        Console(file=drawn, width=width, markup=False, highlight=False).print(table)  # [cm] is a unit
        caption = wrap_text(self.caption, width) if self.caption else []
        return "".join(f"{line.rstrip()}\n" for line in [*caption, *drawn.getvalue().splitlines()])

    def _choose_widths(self, width: int) -> list[int]:
        """Return the width of every column: that of its cells, or less for the widest texts where there is no room."""
        places = range(len(self.heads))
        widths = [self._column_width(place, wraps=False) for place in places]
        least = [self._column_width(place, wraps=True) for place in places]
        excess = sum(widths) + _SPACE * len(widths) - width
        while excess > 0:
            widest = max(places, key=lambda place: widths[place] - least[place])
            if widths[widest] == least[widest]:
                break
            widths[widest] -= 1
            excess -= 1
        return widths

    def _lay_out_blocks(self, width: int) -> str:
        """Return a block of lines for every row: its names at the left as heading, then a line a column."""
        heading_count = self._count_headings()
        lines = wrap_text(self.caption, width) if self.caption else []
        heads = self.heads[heading_count:]
        label_width = max(map(_measure, heads), default=0)
        is_beside = width - label_width - 4 >= MIN_BLOCK_WIDTH
        for row in self.rows:
            lines.append("")
            names = zip(self.heads[:heading_count], row[:heading_count], strict=True)
            lines += wrap_text(", ".join(f"{head} {cell}" for head, cell in names if cell), width)
            for head, cell in zip(heads, row[heading_count:], strict=True):
                text = "; ".join(filter(None, cell.split("\n")))
                if is_beside:
                    label = "  " + head + " " * (label_width - _measure(head) + 2)
                    values = wrap_text(text, width - len(label)) or [""]
                    lines += [(label + values[0]).rstrip(), *(" " * (label_width + 4) + each for each in values[1:])]
                else:
                    lines += [f"  {each}" for each in wrap_text(head, width - 2)]
                    lines += [f"    {each}" for each in wrap_text(text, width - 4)]
        return "\n".join(lines) + "\n"

    def _count_headings(self) -> int:
        """Return how many columns at the left name a row: those of one line before the first number, at most three."""
        count = 0
        for place, is_right in enumerate(self.is_right):
            has_lines = any("\n" in row[place] for row in self.rows)
            if is_right or has_lines or count == MAX_HEADINGS:
                break
            count += 1
        return max(1, min(count, len(self.heads) - 1))


def _measure(text: str) -> int:
    """Return how many characters of a terminal a text takes."""
    from rich.cells import cell_len

    return cell_len(text)
