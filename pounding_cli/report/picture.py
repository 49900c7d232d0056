"""What a film shows of a scene: elevations, yield drifts, links, words; from a scene or from a results file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from pounding_cli.model.scene import Scene
from pounding_cli.numbers import Unit
from pounding_cli.solve.histories import History

if TYPE_CHECKING:
    import pandas as pd

    from pounding_cli.store import Results


@dataclass(frozen=True)
class DrawnLink:
    """A link in the picture: place of its left building, its floors from 1, law, gap [m], and where it ends in the
    storeys below these floors, as part of their height."""

    left: int
    left_floor: int
    right_floor: int
    kind: str
    gap: float
    left_at: float = 1.0
    right_at: float = 1.0


@dataclass(frozen=True)
class Picture:
    """What moves: shapes by building, left to right.

    elevation : of the floors [m]; yield_drift : of the storeys [m], inf where they stay elastic
    links : one for each column of the history's forces, None where the scene has none
    title, words : above the picture: the study; case, analysis, motion
    acceleration : the unit that of the ground is shown in
    slabs : thickness of the floors' slabs by building [m]; zero unless given
    """

    elevation: tuple[np.ndarray, ...]
    yield_drift: tuple[np.ndarray, ...]
    links: tuple[DrawnLink | None, ...]
    title: str
    words: str
    acceleration: Unit
    slabs: tuple[float, ...] = ()


def picture_of_scene(scene: Scene, title: str, words: str, acceleration: Unit) -> Picture:
    """The picture of a scene, links in its order."""
    elastic = scene.analysis == "elastic"
    return Picture(
        tuple(building.elevation for building in scene.buildings),
        tuple(np.full(b.storeys, np.inf) if elastic else b.yield_drift for b in scene.buildings),
        tuple(
            DrawnLink(k.left, k.left_floor, k.right_floor, str(k.kind), k.gap, k.left_at, k.right_at)
            for k in scene.links
        ),
        title,
        words,
        acceleration,
        tuple(building.slab for building in scene.buildings),
    )


def picture_of_results(results: Results, place: Mapping[str, Any], history: History) -> Picture:
    """The picture of a kept scene; `place` as `Results.kept` gives it, links in the order of its history."""

    def here(frame: pd.DataFrame) -> pd.DataFrame:
        for name in (*results.axes, "case", "analysis", "record"):
            if name in frame.columns:
                frame = frame[frame[name] == place[name]]
        return frame

    storeys = here(results.buildings).groupby("place", sort=True)
    elastic = place["analysis"] == "elastic"
    drifts = [(rows["yield_shear"] / rows["stiffness"]).to_numpy() for _, rows in storeys]
    order = list(dict.fromkeys(results.buildings["building"]))
    links: dict[str, DrawnLink] = {}
    for row in here(results.link()).to_dict("records"):
        left = order.index(row["left"])
        at = row.get("left_at", 1.0), row.get("right_at", 1.0)
        links[row["link"]] = DrawnLink(left, row["floor"], row["right_floor"], row["kind"], row["gap"], *at)
    source = here(results.records())["source"].iloc[0]
    return Picture(
        tuple(rows["height"].cumsum().to_numpy() for _, rows in storeys),
        tuple(np.full(each.size, np.inf) if elastic else each for each in drifts),
        tuple(links.get(label) for label in history.links),
        results.title,
        in_words({name: results.value_label(name, place[name]) for name in results.axes}, place, source),
        results.units["acceleration"],
        tuple(float(rows["slab"].iloc[0]) if "slab" in rows else 0.0 for _, rows in storeys),
    )


def in_words(swept: Mapping[str, str], place: Mapping[str, str], source: str) -> str:
    """Where a scene stands, and whether its motion is real; `swept`: values of swept keys as people read them."""
    values = [f"{name} = {value}" for name, value in swept.items()]
    return ", ".join((*values, place["case"], place["analysis"], f"{place['record']} ({source})"))
