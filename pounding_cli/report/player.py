"""Kept histories for the page's player: their series as 32-bit floats, the buildings and links they move."""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.laws import drawn
from pounding_cli.report.evidence import Evidence
from pounding_cli.report.explorer import rounded

if TYPE_CHECKING:
    from pounding_cli.results.histories import History
    from pounding_cli.results.results import Results

MOST_BYTES = 12_000_000
"""What all series together may take on the page, as text."""
MOST_STEPS = 20_000
"""Samples a series; finer ones are thinned."""
_PER_NUMBER = 4 * 4 / 3
"""Bytes a 32-bit float takes in base64."""


def players(results: Results, evidences: Sequence[Evidence]) -> list[dict[str, Any]]:
    """The kept scenes as the player reads them, as many as a page has room for: those with contacts first."""
    scenes: list[dict[str, Any]] = []
    left = float(MOST_BYTES)
    for row in results.histories().to_dict("records"):
        evidence = _evidence(row, evidences)
        place = {"case": row["case"], "analysis": row["analysis"], "record": row["record"]}
        history = results.history(**place, **evidence.point)
        scene, size = _scene(history, evidence, place)
        if size > left and scenes:
            continue  # a shorter one may still fit
        left -= size
        scenes.append(scene)
    return sorted(scenes, key=_first)


def _first(scene: Mapping[str, Any]) -> tuple[bool, bool]:
    """Order of the scenes: those with contacts first, of these the inelastic; else as in the file."""
    return (not scene["contact"], scene["analysis"] != "inelastic")


def _evidence(row: Mapping[Any, Any], evidences: Sequence[Evidence]) -> Evidence:
    """The point of the sweep a kept scene belongs to."""
    return next(e for e in evidences if all(_same(row[key], value) for key, value in e.point.items()))


def _same(one: Any, other: Any) -> bool:
    return bool(one == other) or str(one) == str(other)


def _scene(history: History, evidence: Evidence, place: Mapping[str, str]) -> tuple[dict[str, Any], float]:
    """One scene and the bytes its series take."""
    steps = history.time.size
    stride = -(-steps // MOST_STEPS)
    buildings = _buildings(history, evidence)
    links = _links(history, evidence, place["case"])
    series = [history.ground_acceleration[::stride]]
    for number, building in enumerate(buildings):
        series += list(history.displacement[::stride, number, : len(building["heights"])].T)
        if building["foundation"]:
            series += [history.sway[::stride, number], history.rocking[::stride, number]]
    series += [_largest(history.link_force[:, link["column"]], stride) for link in links]
    unit = evidence.unit("acceleration")
    packed = np.ascontiguousarray(series, dtype="<f4")
    scene = {
        **place,
        "label": ", ".join(filter(None, (evidence.label, *place.values()))),
        "dt": float(history.time[1] - history.time[0]) * stride if steps > 1 else 1.0,
        "count": int(packed.shape[1]),
        "stride": stride,
        "acceleration": {"unit": unit.name, "factor": 1 / unit.factor},
        "buildings": buildings,
        "links": links,
        "contact": any(np.any(history.link_force[:, one["column"]]) for one in links if one["drawn"] != "bar"),
        "series": base64.b64encode(packed.tobytes()).decode("ascii"),
    }
    return scene, packed.size * _PER_NUMBER


def _buildings(history: History, evidence: Evidence) -> list[dict[str, Any]]:
    """Name, period, storey heights [m], yield drifts [m], and whether the foundation moves, left to right."""
    found = []
    for number, name in enumerate(history.buildings):
        rows = evidence.buildings[evidence.buildings["building"] == name].sort_values("storey")
        moves = np.any(history.sway[:, number] != 0) or np.any(history.rocking[:, number] != 0)
        found.append(
            {
                "name": name,
                "period": float(rows["period"].iloc[0]),
                "heights": [rounded(height) for height in rows["height"]],
                "yield": [rounded(drift) for drift in rows["yield_shear"] / rows["stiffness"]],
                "foundation": bool(moves),
                "slab": float(rows["slab"].iloc[0]) if "slab" in rows else 0.0,
            }
        )
    return found


def _links(history: History, evidence: Evidence, case: str) -> list[dict[str, Any]]:
    """The case's links: their place in `history.link_force`, buildings by place from 0, floors from 1, law, gap [m],
    where it ends in the storeys below its floors, as part of their height."""
    rows = evidence.link[evidence.link["case"] == case].drop_duplicates("link")
    place = {name: number for number, name in enumerate(history.buildings)}
    column = {name: number for number, name in enumerate(history.links)}
    return [
        {
            "column": column[row["link"]],
            "left": place[row["left"]],
            "right": place[row["right"]],
            "floor": int(row["floor"]),
            "right_floor": int(row["right_floor"]),
            "drawn": drawn(row["kind"]),
            "gap": float(row["gap"]),
            "left_at": float(row.get("left_at", 1.0)),
            "right_at": float(row.get("right_at", 1.0)),
        }
        for row in rows.to_dict("records")
        if row["link"] in column
    ]


def _largest(force: np.ndarray, stride: int) -> np.ndarray:
    """The force of largest size in every `stride` samples, with its sign: no impact is lost by thinning."""
    if stride == 1:
        return force
    padded = np.concatenate([force, np.zeros(-force.size % stride, force.dtype)]).reshape(-1, stride)
    return padded[np.arange(len(padded)), np.abs(padded).argmax(axis=1)]
