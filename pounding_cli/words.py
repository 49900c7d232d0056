"""Numbers in the sentences a user reads."""

from __future__ import annotations


def counted(number: int, one: str, many: str = "") -> str:
    """A number with what is counted: `1 scene`, `2 scenes`; `many` where an s does not make the plural."""
    return f"{number} {one if number == 1 else many or one + 's'}"
