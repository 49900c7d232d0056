"""Figures of a sweep: maps over its two longest axes, or curves where it has one."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from pounding_cli.errors import InputError, Problem
from pounding_cli.numbers import Unit, counted
from pounding_cli.report.axes import SweptAxis, swept_axes
from pounding_cli.report.curves import draw_curves
from pounding_cli.report.evidence import Evidence, Tables, motion_sentence
from pounding_cli.report.figures import RESPONSES, plotted_cases
from pounding_cli.report.maps import draw_maps
from pounding_cli.report.quantity import LEVELS, Choice, Panels, over_sweep, table_of

WORST = "worst"
"""What is said in place of a case or building for the largest over all of them."""
MOST_CASES = 12
"""Cases of one figure; further ones are drawn when asked for."""
MOST_BUILDINGS = 6
"""Buildings that get a figure of their own unasked."""


@dataclass(frozen=True)
class Asked:
    """What is drawn over a sweep; what is not said is drawn for all there are.

    quantities : names of the tables' columns; V/V0 elastic and mu/mu0 inelastic unless given
    choice : the places that are fixed; its case and building may be WORST
    at : swept key -> value (SI, as in the tables) at which an axis is cut
    """

    quantities: tuple[str, ...] = ()
    choice: Choice = field(default_factory=lambda: Choice(""))
    at: Mapping[str, Any] = field(default_factory=dict)


def sweep_figures(results: Tables, shown: Evidence, asked: Asked | None = None) -> dict[str, Figure]:
    """The figures by file name; none where nothing is swept.

    shown : the point at which axes that are neither drawn nor cut by `asked.at` are taken

    Raises
    ------
    InputError : something asked for is not there
    """
    asked = asked or Asked()
    drawn, cut = _drawn_axes(swept_axes(results), shown, asked.at)
    if not drawn:
        if asked.quantities:
            what = "all swept keys are fixed" if asked.at else "nothing is swept"
            raise InputError(Problem(f"{what}, so there is nothing to draw {asked.quantities[0]} over", "see `sweep:`"))
        return {}
    kind, draw = ("map", draw_maps) if len(drawn) == 2 else ("sweep", draw_curves)
    drawing = _without_swept_periods(results, shown)
    figures = {}
    for name, choices in _choices(results, shown, asked):
        panels = [_panels(results, shown, choice, drawn, cut) for choice in choices]
        panels = [panel for panel in panels if panel.by_case]
        if panels:
            building = str(choices[0].building)
            group = [building] if building in shown.group else []
            title = f"{building} over the sweep" if group else "Over the sweep"
            figures[f"{name}-{kind}"] = draw(drawing, group, title, panels, _said(shown, panels, drawn, cut))
    return figures


def _without_swept_periods(results: Tables, shown: Evidence) -> Evidence:
    """The same without the periods that change over the sweep, for the drawing of the group."""
    changing = results.buildings.groupby("building")["period"].transform("nunique") > 1
    names = set(results.buildings.loc[changing, "building"])
    periods = shown.buildings["period"].mask(shown.buildings["building"].isin(names))
    return replace(shown, buildings=shown.buildings.assign(period=periods))


def _drawn_axes(
    axes: Sequence[SweptAxis], shown: Evidence, at: Mapping[str, Any]
) -> tuple[tuple[SweptAxis, ...], dict[str, Any]]:
    """The one or two axes that are drawn, the longer last, and the values of the keys of all others."""
    free = [axis for axis in axes if len(axis) > 1 and at.keys().isdisjoint(axis.keys)]
    drawn = sorted(sorted(free, key=len, reverse=True)[:2], key=len)
    cut = {key: shown.point[key] for axis in axes if axis not in drawn for key in axis.keys} | dict(at)
    return tuple(drawn), cut


def _choices(results: Tables, shown: Evidence, asked: Asked) -> Iterator[tuple[str, list[Choice]]]:
    """Name and quantities of every figure."""
    fixed = asked.choice
    buildings: list[str] = [fixed.building] if fixed.building else list(shown.group)[:MOST_BUILDINGS]
    analyses = [fixed.analysis] if fixed.analysis else shown.analyses
    if not asked.quantities:
        for building in buildings:
            pairs = [(quantity, analysis) for analysis, quantity, _ in RESPONSES if analysis in analyses]
            yield building, [replace(fixed, quantity=q, analysis=a, building=building) for q, a in pairs]
    for quantity in asked.quantities:
        of_buildings = table_of(quantity) in ("storey", "floor") or fixed.building is not None
        places: list[str | None] = [*buildings] if of_buildings else [None]
        for place in places:
            name = f"{place}-{quantity}" if place else quantity
            yield name, [replace(fixed, quantity=quantity, analysis=a, building=place) for a in analyses]


def _panels(
    results: Tables, shown: Evidence, choice: Choice, drawn: Sequence[SweptAxis], cut: Mapping[str, Any]
) -> Panels:
    """A quantity by case; cases that have none of it are left out, unless they were asked for."""
    cases: list[str] = [choice.case] if choice.case else plotted_cases(shown)[:MOST_CASES]
    building = None if choice.building == WORST and WORST not in shown.group else choice.building
    by_case, refused = {}, None
    for case in cases:
        named = None if case == WORST and WORST not in shown.cases else case
        try:
            over = over_sweep(results, replace(choice, case=named, building=building), drawn, cut)
        except InputError as error:
            refused = error
            continue
        if np.isfinite(over.mean).any():
            by_case[case if named else "worst of all cases"] = over
    if not by_case and refused:
        raise refused
    return Panels(str(choice.analysis).capitalize(), by_case)


def _said(shown: Evidence, panels: Sequence[Panels], axes: Sequence[SweptAxis], cut: Mapping[str, Any]) -> str:
    """What is drawn, in a sentence without its full stop."""
    choice = next(iter(panels[0].by_case.values())).choice
    motions = shown.records["record"].nunique()
    what = f"Mean over the {counted(motions, 'motion')}" if choice.record is None else f"Under {choice.record}"
    chosen = [f"{name} {getattr(choice, name)}" for name in ("storey", "floor", "link") if getattr(choice, name)]
    free = [name for name in LEVELS[choice.table] if getattr(choice, name) is None and name != "analysis"]
    if choice.table == "link":
        free = [] if chosen else [name for name in free if name != "floor"]
    worst = f"at the {' and '.join(free)} where it is largest" if free else ""
    where = " ".join((*(f"at {place}" for place in chosen), worst)).strip()
    others = ", ".join(f"{key} = {shown.units.get(key, Unit()).text(value)}" for key, value in cut.items())
    said = f"{what}, {where}".rstrip(", ") + (f"; {others}" if others else "")
    return f"{motion_sentence(shown.records)} {said}"
