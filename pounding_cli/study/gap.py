"""`pound gap`: the study with nothing between its buildings, so that their largest closings are what is required."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from itertools import pairwise, product

from pounding_cli.model.links import APART, Link, LinkPlace
from pounding_cli.model.meetings import meetings
from pounding_cli.study.expand import expand
from pounding_cli.study.load import Study, validated
from pounding_cli.study.plan import Plan
from pounding_cli.study.sections import Point
from pounding_cli.study.source import Node
from pounding_cli.study.sweep import SweepAxis

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
            links += [Link.apart(left, s.left_floor, s.right_floor, s.left_at, s.right_at) for s in strikes]
        return tuple(links)

    return dataclasses.replace(expand(apart, links_of), workflow="gap")


def gaps_of_cases(plan: Plan, point: Point) -> Iterator[tuple[str, dict[LinkPlace, float]]]:
    """The cases of the study at a point of a plan of `expand_gap`, each with its gaps [m] by place; once for every set
    of gaps that the sweep of the study gives it. Places are named as those of a plan of `expand_gap`.

    Left out are cases in which something acts between the buildings before a gap has closed, so that they do not move
    alone, and those without links.
    """
    study, choices, kept = plan.study.written, list[range | list[int]](), iter(point)
    assert study is not None
    for axis in study.resolver.axes:
        own, keys = _kept(axis)
        there: range | list[int] = range(len(keys))
        if own:
            wanted = next(kept)
            number = {key: place for place, key in enumerate(dict.fromkeys(keys))}
            there = [place for place in there if number[keys[place]] == wanted]
        choices.append(there if any(path[0] == "cases" for path in axis.paths) else there[:1])
    for case in study.model.cases:
        seen = set()
        for whole in product(*choices):
            links = study.resolver.links(whole, case) or ()
            if not links or not all(link.law.subtracts_gap for link in links):
                continue
            gaps: dict[LinkPlace, float] = {}
            for link in links:
                columns = "left columns" if link.left_at < 1.0 else "right columns" if link.right_at < 1.0 else ""
                place = link.left, link.left_floor, link.right_floor, columns
                gaps[place] = min(link.gap, gaps.get(place, link.gap))
            if (key := tuple(gaps.items())) not in seen:
                seen.add(key)
                yield case, gaps


def _kept(axis: SweepAxis) -> tuple[list[int], list[tuple[str, ...]]]:
    """Which keys of an axis change buildings or motions, and the values of those keys at every point of it."""
    kept = [number for number, path in enumerate(axis.paths) if path[0] not in _BETWEEN]
    return kept, [tuple(str(nodes[number].plain()) for number in kept) for nodes in axis.nodes]


def _with_nothing_between(study: Study) -> Study:
    """The study with one case, in which nothing stands between the buildings, and without the axes of links."""
    root = study.resolver.root
    axes = []
    for axis in study.resolver.axes:
        kept, keys = _kept(axis)
        values = dict(zip(keys, axis.nodes, strict=True))
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
