"""`pound gap`: the study with nothing between its buildings, so that their largest closings are what is required."""

from __future__ import annotations

import dataclasses
from itertools import pairwise

from pounding_cli.model.links import APART, Link
from pounding_cli.model.meetings import meetings
from pounding_cli.study.expand import expand
from pounding_cli.study.load import Study, validated
from pounding_cli.study.plan import Plan
from pounding_cli.study.sections import Point
from pounding_cli.study.source import Node

_BETWEEN = ("cases", "impact", "laws")
"""Sections that say what stands between the buildings."""

_ASIDE = ("bracket", "keep", "report", "claims", "uncertain")
"""Sections without a meaning where no case is run."""


def expand_gap(study: Study) -> Plan:
    """The scenes whose closings are the required separations: every motion and analysis, each building alone.

    Swept keys of links are left out; those of buildings and motions stay.

    Raises
    ------
    InputError : a combination of swept values is not sound
    """
    apart = _with_nothing_between(study)

    def links_of(point: Point, case: str) -> tuple[Link, ...]:
        row = apart.resolver.group(point)
        assert row is not None  # the study was validated at every point
        links: list[Link] = []
        for left, pair in enumerate(pairwise(row.buildings)):
            floors, strikes = meetings(*pair)  # slabs beside columns too, whether or not their share is known
            links += [Link.apart(left, *both) for both in floors]
            # fault: gap-beside-columns
            links += [Link.apart(left, s.left_floor, s.right_floor, s.left_at, s.right_at) for s in strikes]
        return tuple(links)

    return dataclasses.replace(expand(apart, links_of), workflow="gap")


def _with_nothing_between(study: Study) -> Study:
    """The study with one case, in which nothing stands between the buildings, and without the axes of links."""
    root = study.resolver.root
    axes = []
    for axis in study.resolver.axes:
        kept = [number for number, path in enumerate(axis.paths) if path[0] not in _BETWEEN]
        values = {tuple(str(nodes[number].plain()) for number in kept): nodes for nodes in axis.nodes}
        if kept:
            columns = {axis.names[n]: Node([nodes[n] for nodes in values.values()], root.mark) for n in kept}
            axes.append(Node(columns, root.mark, keys=dict.fromkeys(columns, root.mark)))
    sections = {name: node for name, node in root.value.items() if name not in _ASIDE}
    nothing = Node({"link": Node("none", root.mark, "none")}, root.mark, keys={"link": root.mark})
    sections["cases"] = Node({APART: nothing}, root.mark, keys={APART: root.mark})
    sections["sweep"] = Node(axes, root.mark)
    tree = Node(sections, root.mark, keys=dict.fromkeys(sections, root.mark) | (root.keys or {}))
    found = validated(study.path, study.text, tree)
    return dataclasses.replace(found, warnings=study.warnings, from_data=study.from_data, written=study)
