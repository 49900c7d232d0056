"""Collect what is doubtful in a study: of every key the worst, at its line."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any

from pounding_cli.errors import Issue, KeyPath
from pounding_cli.study.text.file import Mark, get, locate, place_issue


@dataclass
class Doubts:
    """Collects issues by the keys that they are of, each at its line.

    by_key : of every key its issues, each with its excess
    """

    file: str
    by_key: dict[KeyPath, dict[Issue, float]] = field(default_factory=dict)
    _keys: dict[Mark, KeyPath] = field(default_factory=dict)

    def add(self, tree: Any, issues: Iterable[Issue]) -> None:
        """Note issues of a study whose file is `tree`.

        A value that several buildings or cases take from one place of the file counts for the first of them.
        """
        for issue in issues:
            key = issue.of or issue.path
            if get(tree, *issue.path) is not None:
                key = self._keys.setdefault(locate(tree, issue.path), key)
            placed = place_issue(tree, self.file, issue)
            self.by_key.setdefault(key, {}).setdefault(placed, issue.excess)

    def start_anew(self) -> Doubts:
        """Return an empty collector, for which a value counts for the same key as here."""
        return Doubts(self.file, _keys=dict(self._keys))

    def add_where(self, where: str) -> None:
        """Say in every issue where it arises; where : a point of the sweep in words."""
        for key, issues in self.by_key.items():
            self.by_key[key] = {
                replace(issue, message=f"{issue.message} (where {where})"): excess for issue, excess in issues.items()
            }

    def extend(self, others: Doubts, only_new: bool = False) -> None:
        """Note the issues of another collector; only_new : of keys of which nothing is noted here."""
        for key, issues in others.by_key.items():
            if not (only_new and key in self.by_key):
                self.by_key.setdefault(key, {}).update(issues)

    def iter_merged(self) -> Iterator[Issue]:
        """Yield one issue a key: the worst, which counts the others."""
        for issues in self.by_key.values():
            worst = max(issues, key=issues.__getitem__)
            others = len(issues) - 1
            more = f"; and {others} more like it" if others else ""
            yield replace(worst, message=worst.message + more)
