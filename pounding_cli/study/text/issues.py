"""Issues of parts of a study, by path; line and column are found at the edge."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from pounding_cli.errors import Issue, KeyPath


class IssuesFound(Exception):
    """Raised by what builds a part of a study.

    issues : what is wrong; with its line where it stands in another file, as that of a motion
    """

    def __init__(self, issues: Iterable[Issue]) -> None:
        self.issues = tuple(issues)
        super().__init__("\n".join(each.message for each in self.issues))

    def below(self, *path: str | int) -> IssuesFound:
        """Return the same issues of a part that stands at `path`."""
        placed = [each if each.is_placed else replace(each, path=(*path, *each.path)) for each in self.issues]
        return IssuesFound(placed)


@dataclass
class Issues:
    """Collects issues with the points of the sweep at which they arise.

    points : of every issue and the axes that it was found on, the points of these axes
    """

    points: dict[tuple[Issue, tuple[int, ...]], dict[tuple[int, ...], None]] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.points)

    def add(self, axes: tuple[int, ...], index: tuple[int, ...], issues: Iterable[Issue]) -> None:
        """Note issues at a point of some axes."""
        for issue in issues:
            self.points.setdefault((issue, axes), {})[index] = None

    def add_written(self, issues: Iterable[Issue]) -> None:
        """Note issues of the study as it is written."""
        self.add((), (), issues)

    def check(self) -> None:
        """Raise IssuesFound if anything was noted."""
        if self.points:
            raise IssuesFound(issue for issue, _ in self.points)


def drop_idle_axes(
    axes: tuple[int, ...], points: Iterable[tuple[int, ...]], sizes: Sequence[int]
) -> list[Mapping[int, int]]:
    """Return the places on the axes that decide about an issue, of every combination of them.

    An axis does not decide where the issue arises at all values of it.

    sizes : lengths of all axes of the sweep
    """
    remaining = dict.fromkeys(points)
    deciding = list(axes)
    for place in reversed(range(len(axes))):
        without = dict.fromkeys((*point[:place], *point[place + 1 :]) for point in remaining)
        if len(without) * sizes[axes[place]] == len(remaining):
            remaining = without
            del deciding[place]
    return [dict(zip(deciding, point, strict=True)) for point in remaining]


def to_issues(refused: Any, path: KeyPath) -> list[Issue]:
    """Return the problems of an InputError as issues of the value at `path`; those inside a file keep their place."""
    issues: list[Issue] = []
    for problem in refused.problems:
        if problem.line:
            issues.append(problem)
        else:
            file = f"{problem.file}: " if problem.file else ""
            issues.append(Issue(path, f"{file}{problem.message}", problem.hint))
    return issues
