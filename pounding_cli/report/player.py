"""Kept histories for the page's player: their series as 32-bit floats, the buildings and links they move."""

from __future__ import annotations

import base64
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.laws import drawn
from pounding_cli.report.evidence import Evidence, at_point, points_of
from pounding_cli.report.explorer import rounded

if TYPE_CHECKING:
    from pounding_cli.results.histories import History
    from pounding_cli.results.results import Results

MOST_BYTES = 12_000_000
"""What all series together may take on the page, as text."""
MOST_STEPS = 20_000
"""Samples a series; finer ones are thinned."""


def players(results: Results) -> list[dict[str, Any]]:
    """The kept scenes as the player reads them, as many as a page has room for: first those with contacts, of these the
    inelastic."""
    scenes: list[dict[str, Any]] = []
    left = MOST_BYTES
    for row in results.histories().to_dict("records"):
        at = {keys[0]: points_of(results, keys).index(tuple(row[key] for key in keys)) for keys in results.swept}
        evidence = at_point(results, at)
        place = {"case": row["case"], "analysis": row["analysis"], "record": row["record"]}
        scene = _scene(results.history(**place, **evidence.point), evidence, place)
        if len(scene["series"]) <= left or not scenes:  # of those that do not fit a shorter one may
            left -= len(scene["series"])
            scenes.append(scene)
    return sorted(scenes, key=lambda scene: (not scene["contact"], scene["analysis"] != "inelastic"))


def _scene(history: History, evidence: Evidence, place: Mapping[str, str]) -> dict[str, Any]:
    """One scene: `series` has the ground, of every building its floors, and its sway and rocking where its foundation
    moves, and the force of every link."""
    steps = history.time.size
    stride = -(-steps // MOST_STEPS)
    series, buildings, links = [history.ground_acceleration[::stride]], [], []
    for number, (name, rows) in enumerate(evidence.buildings.groupby("building", sort=False)):
        foundation = [history.sway[:, number], history.rocking[:, number]]
        moves = any(np.any(each != 0) for each in foundation)
        floors = history.displacement[:, number, : len(rows)].T
        series += [each[::stride] for each in (*floors, *(foundation if moves else ()))]
        buildings.append({
            "name": name, "period": rounded(float(rows["period"].iloc[0])), "slab": float(rows["slab"].iloc[0]),
            "wall": bool(evidence.of_study(str(name)).get("wall")),
            "heights": [rounded(height) for height in rows["height"]],
            "yield": [rounded(drift) for drift in rows["yield_shear"] / rows["stiffness"]], "foundation": moves,
        })  # fmt: skip
    rows = evidence.link[evidence.link["case"] == place["case"]].drop_duplicates("link")
    known = dict(zip(rows["link"], rows.to_dict("records"), strict=True))
    for number, name in enumerate(history.links):
        if row := known.get(name):
            series.append(_largest(history.link_force[:, number], stride))
            links.append({
                "left": history.buildings.index(row["left"]), "right": history.buildings.index(row["right"]),
                "floor": int(row["floor"]), "right_floor": int(row["right_floor"]), "drawn": drawn(row["kind"]),
                "gap": float(row["gap"]), "left_at": float(row.get("left_at", 1.0)),
                "right_at": float(row.get("right_at", 1.0)),
            })  # fmt: skip
    unit = evidence.unit("acceleration")
    packed = np.ascontiguousarray(series, dtype="<f4")
    forces = packed[len(packed) - len(links) :]
    return {
        **place, "label": ", ".join(filter(None, (evidence.label, *place.values()))), "stride": stride,
        "dt": float(history.time[1] - history.time[0]) * stride if steps > 1 else 1.0, "count": packed.shape[1],
        "acceleration": {"unit": unit.name, "factor": 1 / unit.factor}, "buildings": buildings, "links": links,
        "contact": any(force.any() for link, force in zip(links, forces, strict=True) if link["drawn"] != "bar"),
        "series": base64.b64encode(packed.tobytes()).decode("ascii"),
    }  # fmt: skip


def _largest(force: np.ndarray, stride: int) -> np.ndarray:
    """The force of largest size in every `stride` samples, with its sign: no impact is lost by thinning."""
    padded = np.concatenate([force, np.zeros(-force.size % stride, force.dtype)]).reshape(-1, stride)
    return padded[np.arange(len(padded)), np.abs(padded).argmax(axis=1)]
