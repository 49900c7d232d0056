"""`pound gap`: the study with nothing between its buildings, so that their largest closings are what is required."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from itertools import pairwise, product

from pounding_cli.model.links import APART, Link, LinkPlace
from pounding_cli.model.meetings import meetings
from pounding_cli.study.axes import SweepAxis
from pounding_cli.study.expand import expand
from pounding_cli.study.file import Items, Map
from pounding_cli.study.plan import Plan
from pounding_cli.study.study import Point, Study

_BETWEEN = ("cases", "impact", "laws")
"""Sections that say what stands between the buildings."""

_ASIDE = ("keep", "report", "claims", "uncertain")
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
        row = apart.group(point)
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
    for axis in study.swept:
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
            links = study.links(whole, case) or ()
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
    return kept, [tuple(str(values[number]) for number in kept) for values in axis.given]


def _with_nothing_between(study: Study) -> Study:
    """The study with one case, in which nothing stands between the buildings, and without the axes of links."""
    root, mark = study.root, study.root.mark
    axes = Items((), mark)
    for axis in study.swept:
        kept, keys = _kept(axis)
        values = dict(zip(keys, axis.given, strict=True))
        if kept:
            columns = {
                axis.names[n]: Items([row[n] for row in values.values()], mark, [mark] * len(values)) for n in kept
            }
            axes.append(Map(columns, mark, dict.fromkeys(columns, (mark, mark))))
            axes.marks.append(mark)
    marks = dict.fromkeys(("cases", "sweep"), (mark, mark)) | root.marks
    tree = Map({name: node for name, node in root.items() if name not in _ASIDE}, mark, marks)
    nothing = Map({"link": "none"}, mark, {"link": (mark, mark)})
    tree["cases"] = Map({APART: nothing}, mark, {APART: (mark, mark)})
    tree["sweep"] = axes
    return Study(study.path, study.text, tree, written=study)
