"""What the scripts of the page draw: quantities over heights and the sweep, and kept histories of moving buildings."""

from __future__ import annotations

import base64
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from pounding_cli.laws import link_symbol
from pounding_cli.report.evidence import MOST_CASES, Evidence, build_evidence, list_points
from pounding_cli.report.style import for_page, looks
from pounding_cli.report.sweep import SweptAxis, meaningless, swept_axes
from pounding_cli.results.columns import column_of
from pounding_cli.study.display import key_words
from pounding_cli.variables import RESPONSE_VARIABLES

if TYPE_CHECKING:
    from pounding_cli.results.results import ResultTables

MOST_VALUES = 120_000
"""Numbers that a page carries; of more only means and the largest over the height, then fewer quantities."""
MEAN = "mean"
"""What stands for all motions in the list of motions."""
MOST_BYTES = 12_000_000
"""What all series together may take on the page, as text."""


def explored(results: ResultTables, shown: Evidence) -> dict[str, Any]:
    """Axes and quantities; none of these where none has room or a number.

    `mean`, `low`, `high` of a quantity: over case, motion, analysis, building or pair, level and the points of the
    sweep, the last fastest; None where there is nothing; low and high have one motion, the mean. Its `levels` are
    storeys or floors, [0] where only the largest over the height is here. `void`: over case, analysis and points how
    many motions have numbers without meaning. `cut`: what the page leaves out, in words.
    """
    axes, data, cut = swept_axes(results), results.data.sel(case=shown.cases[:MOST_CASES]), list[str]()
    dims, arrays, motions = [axis.keys[0] for axis in axes], dict[str, xr.DataArray](), shown.names("record")
    for variable in sorted((v for v in RESPONSE_VARIABLES if v.charts and v.name in data), key=lambda v: not v.ratio):
        values = by_floor(data, variable.name) if variable.dims[-1] == "link" else data[variable.name]
        if (values.fillna(0.0) != 0).any():
            arrays[variable.name] = values
    size = sum(values.size for values in arrays.values()) * (3 / len(motions) + (len(motions) > 1))
    whole = size <= MOST_VALUES
    if not whole:
        cut = ["only the largest over the height", "only means over the motions"]
        sizes = np.cumsum([3 * a.size / a.shape[-1] / len(motions) for a in arrays.values()])
        names = [name for name, end in zip(arrays, sizes.tolist(), strict=True) if end <= MOST_VALUES]
        cut += [f"{len(names)} of {len(arrays)} quantities"] * (len(names) < len(arrays))
        arrays = {name: arrays[name] for name in names}
    said = "" if arrays else "Nothing to draw: no time history of this study ended."
    if cut:
        said = f"This sweep is large: the page has {', '.join(cut)}; tables/ has all."
    if cut and not arrays:
        said = "The sweep is too large to look around here; tables/ has all numbers."
    looked = [for_page(look) for look in looks(data["case"].values.tolist()).values()]
    void = meaningless(data["flags"]).sum("record").transpose("case", "analysis", *dims)
    return {
        "axes": [
            {
                "label": axis_words(axis), "numeric": axis.numeric, "names": axis.names,
                "values": [rounded(value) for value in axis.coordinates.tolist()],
            }
            for axis in axes
        ],
        "quantities": [_quantity(name, values, whole, dims, results) for name, values in arrays.items()],
        "cases": data["case"].values.tolist(), "looks": looked, "analyses": shown.analyses,
        "motions": [MEAN, *(motions if whole and len(motions) > 1 else [])], "void": void.values.ravel().tolist(),
        "cut": said, "heights": whole, "building": shown.main_building,
        "point": [axis.points.index(tuple(shown.point[key] for key in axis.keys)) for axis in axes],
    }  # fmt: skip


def axis_words(axis: SweptAxis) -> str:
    """What the keys of an axis are, with their units, and the keys in brackets."""
    return ", ".join(f"{u.label(key_words(key))} ({key})" for key, u in zip(axis.keys, axis.units, strict=True))


def _quantity(name: str, values: xr.DataArray, whole: bool, dims: list[str], results: ResultTables) -> dict[str, Any]:
    """One quantity, in the unit it is shown in."""
    *_, where, level = map(str, values.dims)
    how = column_of(name, results.units)
    values = values.reset_coords(drop=True) / how.unit.factor
    found = {"mean": values.mean("record"), "low": values.min("record"), "high": values.max("record")}
    if not whole:
        place = abs(found["mean"]).fillna(-1.0).argmax(level)
        found = {key: of.isel({level: place}).drop_vars(level).expand_dims(level) for key, of in found.items()}
    found = {key: of.expand_dims(record=[MEAN]) for key, of in found.items()}
    if whole and values.sizes["record"] > 1:
        found["mean"] = xr.concat([found["mean"], values], "record")
    order = ("case", "record", "analysis", where, level, *dims)
    packed = {key: [rounded(v) for v in of.transpose(*order).values.ravel().tolist()] for key, of in found.items()}
    levels = values[level].values.tolist() if whole else [0]
    about = {"key": name, "label": how.head, "text": how.text or how.label, "level": level, "levels": levels}
    return about | {"where": where, "places": values[where].values.tolist()} | packed


def by_floor(data: xr.Dataset, name: str) -> xr.DataArray:
    """A variable of the links over pair and floor: of several links between the same floors the largest."""
    values, floors = data[name], data["link_floor"].values.tolist()
    levels = sorted(set(floors))  # 0 is a base
    pairs = [f"{one} | {other}" for one, other in zip(data["link_left"].values, data["link_right"].values, strict=True)]
    places = list(dict.fromkeys(pairs))
    found = np.full((*values.shape[:-1], len(places), len(levels)), np.nan)
    for number, (pair, floor) in enumerate(zip(pairs, floors, strict=True)):
        at = (..., places.index(pair), levels.index(floor))
        found[at] = np.fmax(found[at], values.values[..., number])
    coords = {dim: data[dim] for dim in values.dims[:-1]} | {"pair": places, "floor": levels}
    return xr.DataArray(found, coords, (*values.dims[:-1], "pair", "floor"))


def rounded(value: float) -> float | int | None:
    """A number with six digits; None where there is none, a whole one as an integer."""
    if not math.isfinite(value):
        return None
    short = float(f"{value:.6g}")
    return int(short) if short.is_integer() and abs(short) < 1e15 else short


def players(results: ResultTables) -> list[dict[str, Any]]:
    """The kept scenes as the player reads them, as many as a page has room for: first those with contacts, of these the
    inelastic."""
    scenes, left = list[dict[str, Any]](), MOST_BYTES
    for row in results.histories().to_dict("records"):
        at = {keys[0]: list_points(results, keys).index(tuple(row[key] for key in keys)) for keys in results.swept}
        scene = _scene(build_evidence(results, at), {name: row[name] for name in ("case", "analysis", "record")})
        if len(scene["series"]) <= left:  # of those that do not fit a shorter one may
            left -= len(scene["series"])
            scenes.append(scene)
    return sorted(scenes, key=lambda scene: (not scene["contact"], scene["analysis"] != "inelastic"))


def _scene(evidence: Evidence, place: Mapping[str, str]) -> dict[str, Any]:
    """One scene: `series` has the ground, of every building its floors, and its sway and rocking where its foundation
    moves, and the force of every link."""
    history = evidence.results.history(*place.values(), **evidence.point)
    series, buildings, links = [history.ground_acceleration], [], []
    for number, (name, rows) in enumerate(evidence.buildings.groupby("building", sort=False)):
        foundation = [history.sway[:, number], history.rocking[:, number]]
        moves = any(np.any(each != 0) for each in foundation)
        floors = history.displacement[:, number, : len(rows)].T
        series += [*floors, *(foundation if moves else ())]
        buildings.append({
            "name": name, "period": rounded(float(rows["period"].iloc[0])), "slab": float(rows["slab"].iloc[0]),
            "wall": bool(evidence.building_of_study(str(name)).get("wall")),
            "heights": [rounded(height) for height in rows["height"]],
            "yield": [rounded(drift) for drift in rows["yield_shear"] / rows["stiffness"]], "foundation": moves,
        })  # fmt: skip
    rows = evidence.link[evidence.link["case"] == place["case"]].drop_duplicates("link")
    known = dict(zip(rows["link"], rows.to_dict("records"), strict=True))
    for number, name in enumerate(history.links):
        if row := known.get(name):
            series.append(history.link_force[:, number])
            links.append({
                "left": history.buildings.index(row["left"]), "right": history.buildings.index(row["right"]),
                "floor": int(row["floor"]), "right_floor": int(row["right_floor"]), "drawn": link_symbol(row["kind"]),
                "gap": float(row["gap"]), "left_at": float(row.get("left_at", 1.0)),
                "right_at": float(row.get("right_at", 1.0)),
            })  # fmt: skip
    unit = evidence.unit("acceleration")
    packed = np.ascontiguousarray(series, dtype="<f4")
    forces = packed[len(packed) - len(links) :]
    return {
        **place, "label": ", ".join(filter(None, (evidence.label, *place.values()))),
        "dt": float(history.time[1] - history.time[0]) if history.time.size > 1 else 1.0, "count": packed.shape[1],
        "acceleration": {"unit": unit.name, "factor": 1 / unit.factor}, "buildings": buildings, "links": links,
        "contact": any(force.any() for link, force in zip(links, forces, strict=True) if link["drawn"] != "bar"),
        "series": base64.b64encode(packed.tobytes()).decode("ascii"),
    }  # fmt: skip
