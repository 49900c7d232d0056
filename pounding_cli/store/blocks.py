"""The tables of a results file, block by block of rows, so that a study of any size takes little memory."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pounding_cli.digests import DigestList, runs
from pounding_cli.model.links import columns_struck
from pounding_cli.model.placed import among
from pounding_cli.model.scene import Analysis
from pounding_cli.numbers import counted
from pounding_cli.solver.response import COLLAPSED, DONE
from pounding_cli.store.codec import parse
from pounding_cli.store.dense import Shape, empty
from pounding_cli.store.packed import Slabs
from pounding_cli.store.parts import Alike, PartStore
from pounding_cli.store.statistics import over_records, ratio, trust_of_means
from pounding_cli.variables import PLACE, RATIOS, RESPONSES, SCENES, STATISTICS

if TYPE_CHECKING:
    from pounding_cli.study import Plan
    from pounding_cli.study.plan import LinkSeen

BLOCK_BYTES = 8 << 20
"""Numbers gathered at a time [bytes], about."""


def _fields(part: str, alone: bool = False) -> dict[str, str]:
    """Variable -> its field, of one part of a response."""
    found = ((v.name, *v.of.split(".")) for v in RESPONSES if v.of and v.alone == alone)
    return {name: field for name, of, field in found if of == part}


_BUILDING_FIELDS, _LINK_FIELDS, _COLUMN_FIELDS = map(_fields, ("building", "link", "columns"))
_ALONE_FIELDS = _fields("building", alone=True)

_OVER_RECORDS = frozenset(v.name for v in STATISTICS)

Arrays = dict[str, np.ndarray]

Heights = tuple[tuple[str, ...], Slabs]
"""Dimensions and values of the storey heights, as `facts` has them."""


@dataclass(frozen=True)
class Cut:
    """How the rows are cut: whole in the dimensions after the first `before + 1`, `step` at a time in that one.

    Records are never parted: their statistics need them together.
    """

    before: int
    step: int


@dataclass(frozen=True)
class Block:
    """The values of consecutive rows.

    at : where they stand along the swept axes, case, analysis and record (the last ones whole)
    data : variable -> array with what is left of the dimensions
    """

    at: tuple[int | slice, ...]
    data: Arrays


def cut_of(shape: Shape) -> Cut:
    """Blocks of about BLOCK_BYTES."""
    dims = shape.rows
    doubles = sum(math.prod(shape.of(v.dims[3:])) for v in (*RESPONSES, *SCENES))
    most = max(1, BLOCK_BYTES // (8 * max(1, doubles)))
    for before in range(len(dims) - 1):
        whole = math.prod(dims[before + 1 :])
        if whole <= most:
            return Cut(before, min(dims[before], most // whole))
    return Cut(len(dims) - 2, 1)


def blocks(plan: Plan, responses: PartStore, shape: Shape, heights: Heights) -> Iterator[Block]:
    """Every variable of RESPONSES, SCENES and STATISTICS for all rows in their order."""
    cut, dims = cut_of(shape), shape.rows
    row = 0
    whole = dims[cut.before + 1 :]
    for at in np.ndindex(dims[: cut.before]):
        for begin in range(0, dims[cut.before], cut.step):
            end = min(begin + cut.step, dims[cut.before])
            first, row = row, row + (end - begin) * math.prod(whole)
            height = _height(heights, shape, (*at, slice(begin, end)))
            data = _filled(plan, slice(first, row), responses, shape, height)
            for name, array in data.items():
                ahead = whole[:-1] if name in _OVER_RECORDS else whole
                data[name] = array.reshape(end - begin, *ahead, *array.shape[1:])
            yield Block((*at, slice(begin, end)), data)
            del data, array  # before the next ones are made


def _height(heights: Heights, shape: Shape, at: tuple[int | slice, ...]) -> np.ndarray:
    """The storey heights of the rows of a block that stands `at`, shape (rows, building, storey)."""
    dims, values = heights
    taken = [place if isinstance(place, slice) else slice(place, place + 1) for place in at]
    taken += [slice(0, size) for size in shape.rows[len(taken) :]]
    there = dict(zip(shape.axes, taken, strict=False))
    found = values[tuple(there.get(dim, slice(0, shape.sizes[dim])) for dim in dims)]
    rows = tuple(each.stop - each.start for each in taken)
    kept = (size if dim in dims else 1 for dim, size in zip((*shape.axes, *PLACE), rows, strict=True))
    levels = found.shape[-2:]
    return np.broadcast_to(found.reshape(*kept, *levels), (*rows, *levels)).reshape(-1, *levels)


def _filled(plan: Plan, some: slice, responses: PartStore, shape: Shape, height: np.ndarray) -> Arrays:
    """The variables of some rows, rows first; statistics have one row for all records."""
    found, group, inside, digests = _taken(plan, some, responses)
    rows = len(group)
    variables = (v for v in (*RESPONSES, *SCENES) if v.name not in shape.left_out)
    arrays = {v.name: empty(v, (rows, *shape.of(v.dims[3:]))) for v in variables}
    arrays["scene"][:] = digests
    columns = {place: number for number, place in enumerate(shape.links)}
    layout, layouts = _layouts(plan, some)
    for alike in runs(group[:, 0] * len(layouts) + layout):
        if group[alike[0], 0] < 0:
            continue
        line, _, values = found[group[alike[0], 0]]
        values = values[inside[alike, 0]]
        _put_scene(arrays, alike, line, values)
        _put_peaks(arrays, alike, line, values)
        _put_links(arrays, alike, line, values, [columns[link.place] for link in layouts[layout[alike[0]]]])
    alone_errors = np.full((rows, len(plan.buildings)), np.nan)
    for place, building in enumerate(plan.buildings):
        for alike in runs(group[:, 1 + place]):
            if group[alike[0], 1 + place] < 0:
                continue
            line, _, values = found[group[alike[0], 1 + place]]
            values = values[inside[alike, 1 + place]]
            _put_alone(arrays, alike, place, line, values)
            alone_errors[alike, place] = values[:, parse(line).columns["error_estimate"]]
            status = parse(line).facts["status"]
            if status == COLLAPSED:
                _flag(arrays["flags"], alike.tolist(), f"{building} alone collapsed: its ratios are left out")
            elif status != DONE:
                _flag(arrays["flags"], alike.tolist(), f"{building} alone: {status}, ratios refused")
    for variable in RESPONSES:
        if variable.ratio:
            value, alone = variable.ratio
            arrays[variable.name][:] = ratio(arrays[value], arrays[alone])
            zero = (arrays[alone] == 0).any(axis=(-2, -1))
            if alone == "mu0":  # no storey of an elastic analysis yields: nobody asks for its ductility
                zero &= _inelastic(plan, some)
            _flag(arrays["flags"], np.flatnonzero(zero).tolist(), f"{alone} = 0: ratio refused")
        elif variable.formula is not None:
            with np.errstate(all="ignore"):
                arrays[variable.name][:] = variable.formula(arrays)
    arrays["drift_ratio"][:] = arrays["drift"] / height
    _flag_columns(arrays, plan, shape)
    return arrays | _statistics(arrays, alone_errors, shape)


def _inelastic(plan: Plan, some: slice) -> np.ndarray:
    """Which of some rows are of an inelastic analysis, shape (rows,)."""
    number = np.arange(some.start, some.stop) // len(plan.records) % len(plan.analyses)
    return np.array([analysis == Analysis.INELASTIC for analysis in plan.analyses])[number]


def _taken(plan: Plan, some: slice, responses: PartStore) -> tuple[list[Alike], np.ndarray, np.ndarray, np.ndarray]:
    """The responses that some rows name, the scene of the row and those of the buildings alone.

    Returns
    -------
    found : responses of one header line each
    group, inside : which of `found` it is, -1 for one that nobody asked for, and its place there; shape
        (rows, 1 + buildings)
    digests : of the scenes of the rows, "" for one that nobody asked for, shape (rows,)
    """
    scenes = plan.rows.scenes[some]
    used, number = np.unique(scenes, return_inverse=True)
    number = number.reshape(scenes.shape)
    table = plan.rows.table
    asked = np.flatnonzero((used >= 0) & among(plan.scenes, DigestList(table.digests, used)))  # maybe not all
    found = responses.alike(DigestList(table.digests, used[asked]))
    group, inside = np.full(len(used), -1), np.zeros(len(used), np.int64)
    for place, each in enumerate(found):
        group[asked[each.which]], inside[asked[each.which]] = place, np.arange(len(each.which))
    names = np.array(table.texts(used), dtype=object)
    names[group < 0] = ""
    return found, group[number], inside[number], names[number[:, 0]]


def _layouts(plan: Plan, some: slice) -> tuple[np.ndarray, list[tuple[LinkSeen, ...]]]:
    """Of some rows the number of their links among the different ones, gaps left out, shape (rows,); and these."""
    rows = plan.rows
    each = len(plan.analyses) * len(plan.records)
    sets, number = np.unique(rows.links[np.arange(some.start, some.stop) // each], return_inverse=True)
    layout = np.zeros(len(sets), np.int64)
    layouts: list[tuple[LinkSeen, ...]] = []
    for links, alike, _ in rows.sets.alike(sets):
        layout[alike] = len(layouts)
        layouts.append(links)
    return layout[number], layouts


def _put_scene(arrays: Arrays, numbers: np.ndarray, line: str, values: np.ndarray) -> None:
    """Status, cost, energies and sentences, as far as the response has them."""
    header = parse(line)
    for variable in SCENES:
        name = variable.name
        if name in header.columns:
            arrays[name][numbers] = values[:, header.columns[name]]
        elif name in header.facts:
            fact = header.facts[name]
            arrays[name][numbers] = "\n".join(fact) if isinstance(fact, tuple) else fact


def _put_peaks(arrays: Arrays, numbers: np.ndarray, line: str, values: np.ndarray) -> None:
    """Peaks of scenes that are done, and who collapsed in the others; their peaks are NaN, whatever they reached."""
    header = parse(line)
    if header.facts["status"] == COLLAPSED:
        who = values[:, header.columns["collapse_building"]].astype(int)
        arrays["collapsed"][numbers, who] = values[:, header.columns["collapse_storey"]]
    if not header.has_peaks:
        return
    for place, spans in enumerate(header.buildings):
        for name, field in _BUILDING_FIELDS.items():
            _put(arrays[name], numbers, place, values[:, spans[field]])


def _put_links(arrays: Arrays, numbers: np.ndarray, line: str, values: np.ndarray, chosen: list[int]) -> None:
    header = parse(line)
    if header.has_peaks and chosen:
        for name, field in _LINK_FIELDS.items():
            arrays[name][numbers[:, None], chosen] = values[:, header.links[field]]
        struck = [chosen[int(link)] for link in values[0, header.columns_struck["link"]]]
        for name, field in _COLUMN_FIELDS.items() if struck else ():
            arrays[name][numbers[:, None], struck] = values[:, header.columns_struck[field]]


def _put_alone(arrays: Arrays, numbers: np.ndarray, place: int, line: str, values: np.ndarray) -> None:
    header = parse(line)
    if header.facts["status"] == COLLAPSED:
        arrays["collapsed0"][numbers, place] = values[:, header.columns["collapse_storey"]]
    if header.has_peaks:
        for name, field in _ALONE_FIELDS.items():
            _put(arrays[name], numbers, place, values[:, header.buildings[0][field]])


def _put(array: np.ndarray, numbers: np.ndarray, place: int, found: np.ndarray) -> None:
    """What a building has: a number, or one of every storey or floor."""
    if array.ndim == 2:
        array[numbers, place] = found[:, 0]
    else:
        array[numbers, place, : found.shape[1]] = found


def _flag_columns(arrays: Arrays, plan: Plan, shape: Shape) -> None:
    """Say in a scene's flags which columns a blow takes beyond their strength."""
    if "shear_demand" not in arrays:
        return
    demand = np.where(arrays["impacts"] > 0, arrays["shear_demand"], np.nan)  # a storey that yields has 1 by itself
    for row in np.flatnonzero((demand > 1).any(axis=-1)).tolist():
        places = [columns_struck(shape.links[link]) for link in np.flatnonzero(demand[row] > 1).tolist()]
        worst = int(np.nanargmax(demand[row]))
        building, storey = columns_struck(shape.links[worst])
        more = len(set(places)) - 1
        _flag(
            arrays["flags"],
            [row],
            f"columns overloaded by a blow: {plan.buildings[building]} storey {storey}, {demand[row, worst]:.3g} times "
            f"their share of the yield shear" + (f", and {counted(more, 'more storey')}" if more else ""),
        )


def _flag(flags: np.ndarray, numbers: list[int], sentence: str) -> None:
    """Say in a scene's flags which of its ratios are missing and why."""
    for number in numbers:
        flags[number] = f"{flags[number]}\n{sentence}" if flags[number] else sentence


def _statistics(arrays: Arrays, alone_errors: np.ndarray, shape: Shape) -> Arrays:
    found: Arrays = {}
    records = shape.sizes["record"]
    # a ratio is at most as wrong as both of its peaks together
    errors = (arrays["error_estimate"][:, None] + alone_errors).reshape(-1, records, len(alone_errors[0]), 1)
    sensitivities = arrays["sensitivity"].reshape(-1, records, 1, 1)
    for name in RATIOS:
        values = arrays[name].reshape(-1, records, *arrays[name].shape[1:])
        found |= {f"{name}_{statistic}": v for statistic, v in over_records(values, axis=1).items()}
        trust = trust_of_means(values, errors, sensitivities, axis=1)
        found |= {f"{name}_mean_{what}": v for what, v in trust.items()}
    return {v.name: found[v.name] for v in STATISTICS}
