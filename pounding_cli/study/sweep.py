"""The axes of a sweep: dotted keys with the values they take, substituted into the file's tree."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from pounding_cli.numbers import Unit
from pounding_cli.study.problems import Problems, keys_at, nearest
from pounding_cli.study.ranges import axis_values
from pounding_cli.study.schema import StudyModel
from pounding_cli.study.source import Mark, Node
from pounding_cli.workflows import WORKFLOWS

FIXED = (
    "title",
    "group",
    "analyses",
    "accuracy",
    "method",
    "time_step",
    "estimate",
    "claims",
    "report",
    "keep",
    "sweep",
    "bracket",
    "uncertain",
    *(name for name, workflow in WORKFLOWS.items() if workflow.is_section),
)
"""Keys that are one for the whole study."""

MOST_POINTS = 2_000_000
MOST_AXES = 20


@dataclass(frozen=True)
class SweepAxis:
    """One axis: its keys, and for every point the node each key takes.

    units : each key is shown in; of an axis without them, those that the nodes are written in
    """

    names: tuple[str, ...]
    nodes: Sequence[tuple[Node, ...]]
    units: tuple[Unit, ...] = ()

    @property
    def paths(self) -> tuple[tuple[str, ...], ...]:
        """The keys as paths."""
        return tuple(tuple(name.split(".")) for name in self.names)

    def __len__(self) -> int:
        return len(self.nodes)


def read_axes(root: Node, problems: Problems) -> tuple[SweepAxis, ...]:
    """The axes under `sweep:`: each key of a mapping is one; keys of one entry of a list move together."""
    sweep = root.get("sweep")
    if sweep is None or sweep.value is None:
        return ()
    if sweep.is_mapping:
        groups = [[key] for key in sweep.value]
        holders = [sweep] * len(groups)
    elif sweep.is_list:
        holders = [node for node in sweep.value if node.is_mapping and node.value]
        for node in sweep.value:
            if not (node.is_mapping and node.value):
                problems.add(
                    node.mark,
                    "an axis is a mapping of keys to lists",
                    "write `- {impact.restitution: [0.4, 0.5]}`",
                )
        groups = [list(holder.value) for holder in holders]
    else:
        problems.add(sweep.mark, "'sweep' is not a mapping", "write `sweep: {impact.restitution: [0.4, 0.5]}`")
        return ()
    if len(groups) > MOST_AXES:
        problems.add(sweep.mark, f"the sweep has {len(groups)} axes", f"keep it to {MOST_AXES}")
        return ()
    axes: list[SweepAxis] = []
    seen: dict[str, int] = {}
    for holder, names in zip(holders, groups, strict=True):
        columns: list[list[Node]] = []
        for name in names:
            mark = (holder.keys or {})[name]
            known = is_sweepable(name, mark, root, problems)
            values = axis_values(name, holder.value[name], StudyModel, problems) if known else None
            if name in seen:
                problems.add(mark, f"'{name}' is an axis twice; first in line {seen[name]}", "remove one of the two")
            elif known and values is not None:
                columns.append(values)
            seen.setdefault(name, mark[0])
        if len(columns) < len(names):
            continue
        if len({len(column) for column in columns}) > 1:
            lengths = ", ".join(f"{name} has {len(column)}" for name, column in zip(names, columns, strict=True))
            problems.add(
                holder.mark,
                f"keys that move together need as many values each: {lengths}",
                "give as many values of each",
            )
            continue
        axes.append(SweepAxis(tuple(names), tuple(zip(*columns, strict=True))))
    points = 1
    for axis in axes:
        points *= len(axis)
    if points > MOST_POINTS:
        problems.add(
            sweep.mark,
            f"the sweep has {points} points",
            f"keep it to {MOST_POINTS}: make axes shorter, or let keys move together in a list entry",
        )
        return ()
    return tuple(axes)


def is_sweepable(name: str, mark: Mark, root: Node, problems: Problems, what: str = "sweep axis") -> bool:
    """Whether a dotted key can take other values at other points; why it cannot is noted at `mark`.

    what : what the messages call it
    """
    path = tuple(name.split("."))
    whole = path[0] in ("records", "buildings", "impact", "cases", "laws") and len(path) < (
        3 if path[0] in ("buildings", "cases", "laws") else 2
    )
    meant = _meant(path, root)
    if path[0] in FIXED and len(path) > 1 and meant:  # a case or a building called as a section, e.g. gap
        problems.add(mark, f"{what} '{name}': no such key", f"did you mean '{meant}'?")
        return False
    if path[0] in FIXED or path[:2] == ("records", "use") or path[-1] == "like":
        cannot = "be an axis" if what == "sweep axis" else "vary"
        problems.add(mark, f"'{name}' cannot {cannot}: it is one for the whole study", "run one study for each value")
        return False
    for place, step in enumerate(path):
        known = keys_at(StudyModel, path[:place], root)
        above = root.get(*path[:place])
        if above is not None and above.is_list and step.isdigit() and int(step) < len(above.value):
            continue
        if above is not None and above.value is not None and not above.is_mapping and step in known:
            before = ".".join(path[:place])
            said = "a list" if above.is_list else f"'{above.text}'"
            hint = f"give '{before}' as a mapping with '{step}' in it, or remove it there"
            problems.add(mark, f"{what} '{name}': '{before}' is {said} in this study and has no key '{step}'", hint)
            return False
        if step not in known:
            before = ".".join(path[:place])
            where = f" under '{before}'" if before else ""
            hint = f"did you mean '{meant}'?" if meant and not place else nearest(step, known)
            problems.add(mark, f"{what} '{name}': no key '{step}'{where}", hint)
            return False
    if whole:
        problems.add(
            mark,
            f"{what} '{name}' is a whole section",
            f"name one value in it, e.g. `{name}.{_first(name, root)}`",
        )
        return False
    return True


def _meant(path: tuple[str, ...], root: Node) -> str:
    """The key that ends in what was written where its beginning was left out: soft.period, restitution, pga; or ""."""
    named = [
        (section, name)
        for section in ("buildings", "cases")
        if (node := root.get(section)) is not None and node.is_mapping
        for name in node.value
    ]
    for before in (("buildings",), ("cases",), ("impact",), *named, ("records", "scale"), ("records",)):
        whole = (*before, *path)
        if all(step in keys_at(StudyModel, whole[:place], root) for place, step in enumerate(whole)):
            return ".".join(whole)
    return ""


def _first(name: str, root: Node) -> str:
    names = keys_at(StudyModel, tuple(name.split(".")), root)
    return names[-1] if names else "KEY"
