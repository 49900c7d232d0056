"""The data that the scripts of a page draw: quantities over heights and the sweep, histories of moving buildings."""

from __future__ import annotations

import base64
import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from pounding_cli.laws import is_damper, link_symbol
from pounding_cli.report.evidence import MAX_PAGE_CASES, Evidence, build_evidence, list_points
from pounding_cli.report.plans import PlanOutline, find_link_ends, has_plans, read_outlines
from pounding_cli.report.style import looks, to_page_look
from pounding_cli.report.sweep import SweptAxis, find_meaningless, list_swept_axes
from pounding_cli.results.columns import column_of
from pounding_cli.study.display import key_words
from pounding_cli.variables import RESPONSE_VARIABLES

if TYPE_CHECKING:
    from pounding_cli.results.histories import History
    from pounding_cli.results.results import ResultTables

MOST_VALUES = 120_000
"""Numbers that a page carries; of more only means and the largest over the height, then fewer quantities."""
MEAN = "mean"
"""Entry for all motions in the list of motions."""
TWIST_REMARK = "; of floors that twist"
"""Begins the part of the meaning of a quantity that only studies with plans need."""
MOST_BYTES = 12_000_000
"""Size of all series of a page together, as text."""


def build_explorer_data(results: ResultTables, evidence: Evidence) -> dict[str, Any]:
    """Return axes and quantities; no quantities where none has room or a number.

    `mean`, `low`, `high` of a quantity: over case, motion, analysis, building or pair, level and the points of the
    sweep, the last fastest; None where there is nothing; low and high have one motion, the mean. Its `levels` are
    storeys or floors, [0] where only the largest over the height is here. `void`: over case, analysis and points the
    count of motions whose numbers are not meaningful. `cut`: a sentence on what the page leaves out.
    """
    axes = list_swept_axes(results)
    data = results.data.sel(case=evidence.cases[:MAX_PAGE_CASES])
    dims = [axis.keys[0] for axis in axes]
    motions = evidence.names("record")
    arrays = _select_arrays(data)
    size = sum(values.size for values in arrays.values()) * (3 / len(motions) + (len(motions) > 1))
    is_whole = size <= MOST_VALUES
    quantity_count = len(arrays)
    if not is_whole:
        sizes = np.cumsum([3 * values.size / values.shape[-1] / len(motions) for values in arrays.values()])
        names = [name for name, end in zip(arrays, sizes.tolist(), strict=True) if end <= MOST_VALUES]
        arrays = {name: arrays[name] for name in names}
    void = find_meaningless(data["flags"]).sum("record").transpose("case", "analysis", *dims)
    return {
        "axes": [_pack_axis(axis) for axis in axes],
        "quantities": [_pack_quantity(name, values, is_whole, dims, results) for name, values in arrays.items()],
        "cases": data["case"].values.tolist(),
        "looks": [to_page_look(look) for look in looks(data["case"].values.tolist()).values()],
        "analyses": evidence.analyses,
        "motions": [MEAN, *(motions if is_whole and len(motions) > 1 else [])],
        "void": void.values.ravel().tolist(),
        "cut": _describe_cut(is_whole, len(arrays), quantity_count),
        "heights": is_whole,
        "building": evidence.main_building,
        "point": [axis.points.index(tuple(evidence.point[key] for key in axis.keys)) for axis in axes],
    }


def _select_arrays(data: xr.Dataset) -> dict[str, xr.DataArray]:
    """Return the quantities that the explorer offers and that have a number, ratios first."""
    variables = [variable for variable in RESPONSE_VARIABLES if variable.charts and variable.name in data]
    arrays = {}
    for variable in sorted(variables, key=lambda variable: not variable.ratio):
        values = data[variable.name]
        if variable.dims[-1] == "link":
            values = group_links_by_floor(data, variable.name)
        elif variable.dims[-1] == "line":
            values = stack_lines(values)
        if (values.fillna(0.0) != 0).any():
            arrays[variable.name] = values
    return arrays


def _describe_cut(is_whole: bool, drawn_count: int, quantity_count: int) -> str:
    """Return a sentence on the quantities that a page leaves out; "" where it has all."""
    if not quantity_count:
        return "Nothing to draw: no time history of this study ended."
    if is_whole:
        return ""
    if not drawn_count:
        return "The sweep is too large to look around here; tables/ has all numbers."
    parts = ["only the largest over the height", "only means over the motions"]
    if drawn_count < quantity_count:
        parts.append(f"{drawn_count} of {quantity_count} quantities")
    return f"This sweep is large: the page has {', '.join(parts)}; tables/ has all."


def _pack_axis(axis: SweptAxis) -> dict[str, Any]:
    """Return an axis as the explorer reads it."""
    values = [round_for_page(value) for value in axis.coordinates.tolist()]
    return {"label": format_axis(axis), "numeric": axis.numeric, "names": axis.names, "values": values}


def format_axis(axis: SweptAxis) -> str:
    """Return the meaning of the keys of an axis with their units, and the keys in brackets."""
    parts = [f"{unit.label(key_words(key))} ({key})" for key, unit in zip(axis.keys, axis.units, strict=True)]
    return ", ".join(parts)


def _pack_quantity(
    name: str, values: xr.DataArray, is_whole: bool, dims: list[str], results: ResultTables
) -> dict[str, Any]:
    """Return a quantity as the explorer reads it, in the unit of its label."""
    *_, where, level = map(str, values.dims)
    column = column_of(name, results.units)
    values = values.reset_coords(drop=True) / column.unit.factor
    spread = {"mean": values.mean("record"), "low": values.min("record"), "high": values.max("record")}
    if not is_whole:
        largest = abs(spread["mean"]).fillna(-1.0).argmax(level)
        for kind, numbers in spread.items():
            spread[kind] = numbers.isel({level: largest}).drop_vars(level).expand_dims(level)
    spread = {kind: numbers.expand_dims(record=[MEAN]) for kind, numbers in spread.items()}
    if is_whole and values.sizes["record"] > 1:
        spread["mean"] = xr.concat([spread["mean"], values], "record")
    text = column.text or column.label
    if "plan_low" not in results.arrays:
        text = text.partition(TWIST_REMARK)[0]
    order = ("case", "record", "analysis", where, level, *dims)
    packed = {}
    for kind, numbers in spread.items():
        packed[kind] = [round_for_page(number) for number in numbers.transpose(*order).values.ravel().tolist()]
    return {
        "key": name,
        "label": column.head,
        "text": text,
        "level": level,
        "levels": values[level].values.tolist() if is_whole else [0],
        "where": where,
        "places": values[where].values.tolist(),
        **packed,
    }


def group_links_by_floor(data: xr.Dataset, name: str) -> xr.DataArray:
    """Return a variable of the links over pair and floor: of several links between the same floors the largest."""
    values = data[name]
    floors = data["link_floor"].values.tolist()
    levels = sorted(set(floors))  # 0 is a base
    neighbours = zip(data["link_left"].values, data["link_right"].values, strict=True)
    pairs = [f"{left} | {right}" for left, right in neighbours]
    places = list(dict.fromkeys(pairs))
    largest = np.full((*values.shape[:-1], len(places), len(levels)), np.nan)
    for number, (pair, floor) in enumerate(zip(pairs, floors, strict=True)):
        at = (..., places.index(pair), levels.index(floor))
        largest[at] = np.fmax(largest[at], values.values[..., number])
    coords = {dim: data[dim] for dim in values.dims[:-1]} | {"pair": places, "floor": levels}
    return xr.DataArray(largest, coords, (*values.dims[:-1], "pair", "floor"))


def stack_lines(values: xr.DataArray) -> xr.DataArray:
    """Return values of frame lines over `frame line`, such as "corner, line 1", and storey, lines without any left out.

    values : over building, storey and line, and further dimensions before these
    """
    further = values.dims[:-3]
    stacked = values.transpose(*further, "building", "line", "storey")
    names = [f"{building}, line {line}" for building in values["building"].values for line in values["line"].values]
    whole = stacked.values.reshape(*stacked.shape[:-3], len(names), -1)
    is_there = np.isfinite(whole).any(axis=(*range(len(further)), -1))
    coords: dict[Any, Any] = {dim: values[dim] for dim in further} | {"storey": values["storey"]}
    coords["frame line"] = [name for name, kept in zip(names, is_there, strict=True) if kept]
    return xr.DataArray(whole[..., is_there, :], coords, (*further, "frame line", "storey"))


def round_for_page(value: float) -> float | int | None:
    """Return a number with six digits, a whole one as an integer; None where there is none."""
    if not math.isfinite(value):
        return None
    short = float(f"{value:.6g}")
    return int(short) if short.is_integer() and abs(short) < 1e15 else short


def build_player_scenes(results: ResultTables) -> list[dict[str, Any]]:
    """Return the kept time histories as the player reads them, as many as a page has room for.

    Those with contacts come first, of these the inelastic ones.
    """
    scenes: list[dict[str, Any]] = []
    room = MOST_BYTES
    for row in results.histories().to_dict("records"):
        index = {}
        for keys in results.swept:
            index[keys[0]] = list_points(results, keys).index(tuple(row[key] for key in keys))
        place = {name: row[name] for name in ("case", "analysis", "record")}
        scene = _pack_scene(build_evidence(results, index), place)
        size = len(scene["series"])
        if size <= room:  # of those that do not fit a shorter one may
            room -= size
            scenes.append(scene)
    return sorted(scenes, key=lambda scene: (not scene["contact"], scene["analysis"] != "inelastic"))


def _pack_scene(evidence: Evidence, place: Mapping[str, str]) -> dict[str, Any]:
    """Return a time history as the player reads it.

    `series` has the ground, of every building its floors, and its sway and rocking where its foundation moves, then of
    every building whose floors twist their rotations, and the force of every link.
    """
    history = evidence.results.history(*place.values(), **evidence.point)
    twist = history.dataset["twist"].values if "twist" in history.dataset else None
    outlines = read_outlines(evidence) if twist is not None and has_plans(evidence) else []
    buildings, motions = _pack_buildings(evidence, history)
    for number, outline in enumerate(outlines):
        turns = np.asarray(twist)[:, number, : len(buildings[number]["heights"])]
        turns = turns[:, np.isfinite(turns).all(axis=0)]  # none where the floors do not twist
        buildings[number]["plan"] = _pack_plan(outline, has_turns=turns.size > 0)
        motions += list(turns.T)
    links, forces = _pack_links(evidence, history, place["case"], outlines)
    series = np.ascontiguousarray([history.ground_acceleration, *motions, *forces], dtype="<f4")
    strikes = [force.any() for link, force in zip(links, forces, strict=True) if link["drawn"] != "bar"]
    unit = evidence.unit("acceleration")
    return {
        **place,
        "label": ", ".join(filter(None, (evidence.label, *place.values()))),
        "dt": float(history.time[1] - history.time[0]) if history.time.size > 1 else 1.0,
        "count": series.shape[1],
        "acceleration": {"unit": unit.name, "factor": 1 / unit.factor},
        "buildings": buildings,
        "links": links,
        "contact": any(strikes),
        "series": base64.b64encode(series.tobytes()).decode("ascii"),
    }


def _pack_buildings(evidence: Evidence, history: History) -> tuple[list[dict[str, Any]], list[np.ndarray]]:
    """Return the buildings of a time history, and the series of their floors and foundations [m], [rad]."""
    buildings = []
    series: list[np.ndarray] = []
    for number, (name, rows) in enumerate(evidence.buildings.groupby("building", sort=False)):
        foundation = [history.sway[:, number], history.rocking[:, number]]
        moves = any(np.any(motion != 0) for motion in foundation)
        series += list(history.displacement[:, number, : len(rows)].T)
        if moves:
            series += foundation
        yield_drifts = rows["yield_shear"] / rows["stiffness"]
        buildings.append(
            {
                "name": name,
                "period": round_for_page(float(rows["period"].iloc[0])),
                "slab": float(rows["slab"].iloc[0]),
                "wall": bool(evidence.building_of_study(str(name)).get("wall")),
                "heights": [round_for_page(height) for height in rows["height"]],
                "yield": [round_for_page(drift) for drift in yield_drifts],
                "foundation": moves,
            }
        )
    return buildings, series


def _pack_plan(outline: PlanOutline, has_turns: bool) -> dict[str, Any]:
    """Return a building from above as the player reads it; places are along the street [m].

    has_turns : whether its floors twist in this time history
    """
    lines = {"lines": outline.lines, "across": outline.across}
    return {
        "low": round_for_page(outline.low),
        "high": round_for_page(outline.high),
        "centre": round_for_page(outline.centre if outline.has_plan else 0.5 * (outline.low + outline.high)),
        "depth": round_for_page(outline.depth),
        "known": outline.is_wall or (outline.has_plan and not outline.depth_source),
        "wall": outline.is_wall,
        "turns": has_turns,
    } | {
        way: [
            {
                "place": round_for_page(line.place),
                "share": round_for_page(line.share),
                "yield": [round_for_page(drift) for drift in line.yield_drifts.tolist()],
            }
            for line in some
        ]
        for way, some in lines.items()
    }


def _pack_links(
    evidence: Evidence, history: History, case: str, outlines: Sequence[PlanOutline]
) -> tuple[list[dict[str, Any]], list[np.ndarray]]:
    """Return the links of a time history, and their forces [N].

    outlines : of the buildings from above, where floors twist
    """
    placed = evidence.data.sel(case=case)
    rows = evidence.link[evidence.link["case"] == case].drop_duplicates("link")
    row_of = dict(zip(rows["link"], rows.to_dict("records"), strict=True))
    links = []
    forces = []
    for number, name in enumerate(history.links):
        row = row_of.get(name)
        if row is None:
            continue
        forces.append(history.link_force[:, number])
        left = history.buildings.index(row["left"])
        ends = find_link_ends(placed.sel(link=name), outlines[left], outlines[left + 1]) if outlines else None
        links.append(
            {
                "left": left,
                "right": history.buildings.index(row["right"]),
                "floor": int(row["floor"]),
                "right_floor": int(row["right_floor"]),
                "drawn": link_symbol(row["kind"]),
                "damper": is_damper(row["kind"]),
                "gap": float(row["gap"]),
                "left_at": float(row.get("left_at", 1.0)),
                "right_at": float(row.get("right_at", 1.0)),
                "places": ends,
            }
        )
    return links, forces
