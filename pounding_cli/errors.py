"""The errors a user can cause, each saying where, what is wrong and what to write instead."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

from pounding_cli.notes import NOTES, Severity

KeyPath = tuple[str | int, ...]
"""Keys and places in lists from the top of a study down to a value."""


@dataclass(frozen=True)
class Issue:
    """One thing that is wrong with the input, doubtful in it, or limits what numbers say.

    path : of the value in a study, from which its line is found at the edge; () elsewhere
    message, hint : what is wrong, and what to write instead
    at_key : whether it stands at the key of the value, not at the value
    offset : characters from the beginning of the value to what is wrong
    file, line, column : where it stands, from 1; in Python data the file is the dotted key, and the line 0
    code : its entry in the catalogue of notes; "" of a refusal, which needs none
    of : path of the key of which the value is one of several: the worst of them is told; () of one that has its own
    excess : how far a doubtful value is beyond what is usual, larger where it is worse
    """

    path: KeyPath
    message: str
    hint: str = ""
    at_key: bool = False
    offset: int = 0
    file: str = ""
    line: int = 0
    column: int = 0
    code: str = ""
    of: KeyPath = ()
    excess: float = 0.0

    def __post_init__(self) -> None:
        if self.code and self.code not in NOTES:
            raise KeyError(self.code)

    def to_data(self) -> dict[str, Any]:
        """Return what is wrong and where, without the path in the study that the place was found by."""
        return {name: getattr(self, name) for name in ("code", "message", "hint", "file", "line", "column")}

    @property
    def severity(self) -> Severity:
        """How bad it is, by its entry in the catalogue."""
        return NOTES[self.code].severity if self.code else Severity.ERROR

    @property
    def is_placed(self) -> bool:
        """True if its line is known: it is of a study at the edge, or stands in another file, as that of a motion."""
        return self.line > 0

    def __str__(self) -> str:
        place = self.file
        if self.line:
            place += f":{self.line}:{self.column}"
        message = f"[{self.code}] {self.message}" if self.code else self.message
        text = f"{place}: {message}" if place else message
        return f"{text}\n    {self.hint}" if self.hint else text


class InputError(ValueError):
    """The input was refused (exit code 2); `issues` lists everything wrong, all in one go.

    What reads a part of a study raises it with paths from there; `below` puts that part in its place, and the edge
    finds the lines. `InputError(message, hint)` is that of one issue of the whole part.
    """

    def __init__(self, issues: Issue | str | Iterable[Issue], hint: str = "") -> None:
        if isinstance(issues, str):
            issues = Issue((), issues, hint)
        if isinstance(issues, Issue):
            issues = [issues]
        self.issues: tuple[Issue, ...] = tuple(issues)
        super().__init__("\n".join(map(str, self.issues)))

    def about(self, text: str) -> InputError:
        """Return the same issues, each with the text in front that it is a part of."""
        return InputError(replace(each, message=f"'{text}': {each.message}") for each in self.issues)

    def below(self, *path: str | int) -> InputError:
        """Return the same issues of a part that stands at `path`; those inside another file keep their place."""
        return InputError(each if each.is_placed else replace(each, path=(*path, *each.path)) for each in self.issues)

    def __reduce__(self) -> tuple[type[InputError], tuple[tuple[Issue, ...]]]:
        """Whole, as it comes from a worker."""
        return type(self), (self.issues,)
