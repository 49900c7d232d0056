"""Issues of parts of a study, by path; line and column are found at the edge."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from pounding_cli.errors import InputError, Issue, KeyPath


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
        """Raise InputError if anything was noted."""
        if self.points:
            raise InputError(issue for issue, _ in self.points)


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


def to_issues(refused: InputError, path: KeyPath) -> list[Issue]:
    """Return the issues of what is wrong with the value at `path`; those with a place of their own keep it."""
    issues: list[Issue] = []
    for problem in refused.issues:
        if problem.is_placed or problem.path:
            issues.append(problem)
        else:
            file = f"{problem.file}: " if problem.file else ""
            issues.append(Issue(path, f"{file}{problem.message}", problem.hint))
    return issues
