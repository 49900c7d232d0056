"""Results built by hand: every ratio follows a stated formula, so a report's numbers are known beforehand."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise, product
from typing import Any

import numpy as np
import pandas as pd

from pounding_cli.numbers import Unit

RECORDS = ("elcentro", "taft", "eureka", "olympia", "parkfield")
PERIODS = {"stiff": 0.36, "soft": 0.60, "soft-1": 0.60, "soft-2": 0.60}
SCALES = {"elcentro": 1.0, "taft": 1.75, "eureka": 1.33, "olympia": 1.25, "parkfield": 0.82}
CASES = {
    "touching": ("pounding", 0.0),
    "gap": ("pounding", 0.05),
    "infill": ("infill", 0.05),
    "connected": ("connector", 0.05),
    "infill_1_10": ("infill", 0.05),
    "infill_1_100": ("infill", 0.05),
}
LEVEL = {
    "touching": 1.4,
    "gap": 1.2,
    "infill": 1.38,
    "connected": 1.5,
    "infill_1_10": 1.40,
    "infill_1_100": 1.45,
}
"""V/V0 of the stiff building, mean over motions and storeys."""
MOTIONS = (0.92, 0.96, 0.98, 1.02, 1.12)
"""Factor of every motion: their mean is 1, their median is not, and they lie unevenly around it."""
PUSH = {
    "touching": 12.0,
    "gap": 9.0,
    "infill": 2.0,
    "connected": 1.1,
    "infill_1_10": 2.2,
    "infill_1_100": 2.6,
}
"""Floor acceleration over that alone."""


class FakeResults:
    """The tables of a results file without the file; what the store's `Results` offers to a report."""

    assumed_heights = ()

    def struck(self):
        return pd.DataFrame()

    def __init__(self, **parts: Any) -> None:
        self.title: str = parts["title"]
        self.study_text: str = "title: hand-made\n"
        self.resolved: dict[str, Any] = parts["resolved"]
        self.buildings: pd.DataFrame = parts["buildings"]
        self.spectrum_match = None
        self.workflow = "run"
        self.answers: tuple[str, ...] = ()
        self.units: Mapping[str, Unit] = dict.fromkeys(("gap", "max_closing"), Unit("mm", 1e-3, "m")) | dict.fromkeys(
            ("acceleration", "acceleration0", "pga"), Unit("g", 9.80665, "m/s2")
        )
        self.attrs: Mapping[str, Any] = {"package_version": "0.1.0"}
        self._frames: dict[str, pd.DataFrame] = parts["frames"]

    def storey(self) -> pd.DataFrame:
        return self._frames["storey"]

    def floor(self) -> pd.DataFrame:
        return self._frames["floor"]

    def link(self) -> pd.DataFrame:
        return self._frames["link"]

    def scene(self) -> pd.DataFrame:
        return self._frames["scene"]

    def summary(self) -> pd.DataFrame:
        return self._frames["summary"]

    def records(self) -> pd.DataFrame:
        return self._frames["records"]


def make(
    group: Sequence[str] = ("stiff", "soft"),
    cases: Sequence[str] = tuple(CASES)[:4],
    records: Sequence[str] = RECORDS,
    storeys: Mapping[str, int] | None = None,
    axis: tuple[str, Sequence[Any]] | None = None,
    v_ratio: Callable[[str, str, int, int], float] | None = None,
    sources: Mapping[str, str] | None = None,
    resolved: Mapping[str, Any] | None = None,
    flags: str = "",
) -> FakeResults:
    """Five-storey buildings unless said otherwise; mean ratios at storey s are level x (1 + 0.02 (s - 3)).

    v_ratio : (case, building, storey, record number) -> V/V0 and mu/mu0, instead of the formula
    axis : (key, values) of one swept key; ratios grow by 10 % a value
    """
    heights = dict.fromkeys(group, 5) | dict(storeys or {})
    sweep = [(axis[0], number, value) for number, value in enumerate(axis[1])] if axis else [("", 0, None)]
    storey, floor, link, scene = [], [], [], []
    for (key, number, value), case, analysis, (place, record) in product(
        sweep, cases, ("elastic", "inelastic"), enumerate(records)
    ):
        at = {key: value} if key else {}
        head = {**at, "case": case, "analysis": analysis, "record": record}
        scene.append(_scene(head, flags))
        for building in group:
            for level in range(1, heights[building] + 1):
                ratio = (v_ratio or _ratio)(case, building, level, place) * (1 + 0.1 * number)
                mu = ratio * (1.2 if analysis == "inelastic" and building == "stiff" else 1.0)
                v0, mu0 = 1e6 * (6 - level), 2.0
                storey.append(
                    {
                        **head,
                        "building": building,
                        "storey": level,
                        "V": ratio * v0,
                        "V0": v0,
                        "V_ratio": ratio,
                    }
                    | {"mu": mu * mu0, "mu0": mu0, "mu_ratio": mu, "drift": 0.01 * mu, "drift0": 0.01}
                    | {"residual_drift": 0.0}
                )
                push = PUSH[case] * (1 + 0.1 * (place - 2))
                floor.append(
                    {**head, "building": building, "floor": level, "acceleration": 5.0 * push}
                    | {"acceleration0": 5.0, "acceleration_ratio": push, "displacement": 0.02}
                )
        link += _links(head, group, heights, case, place)
    frames = {
        name: pd.DataFrame(rows)
        for name, rows in zip(("storey", "floor", "link", "scene"), (storey, floor, link, scene), strict=True)
    }
    frames["summary"] = (
        frames["storey"]
        .groupby(
            [*([axis[0]] if axis else []), "case", "analysis", "building", "storey"],
            sort=False,
            as_index=False,
        )["V_ratio"]
        .mean()
    )
    labels = dict.fromkeys(records, "stand-in") | dict(sources or {})
    frames["records"] = pd.DataFrame(
        {"record": name, "source": labels[name], "digest": name, "scale": SCALES[name], "window": 10.0}
        | {"pga": 3.4, "arias": 1.139}
        for name in records
    )
    buildings = pd.DataFrame(
        {"building": name, "place": place, "storey": level, "mass": 2e5, "height": 3.0, "stiffness": 1e9}
        | {"yield_shear": 1e6, "period": PERIODS[name], "base_shear_ratio": 0.1, "separation": 0.069}
        for place, name in enumerate(group)
        for level in range(1, heights[name] + 1)
    )
    return FakeResults(
        title="Two systems side by side",
        resolved={"claims": "fig6", **(resolved or {})},
        buildings=buildings,
        frames=frames,
    )


def _ratio(case: str, building: str, storey: int, place: int) -> float:
    """The stated formula; soft buildings get the reciprocal level."""
    level = LEVEL[case] if building == "stiff" else 1 / LEVEL[case]
    return level * (1 + 0.02 * (storey - 3)) * MOTIONS[place]


def _scene(head: Mapping[str, Any], flags: str) -> dict[str, Any]:
    return {**head, "status": "done", "advice": "", "method": "taylor", "accuracy": 1e-6, "steps": 900} | {
        "time_step": np.nan, "events": 40, "seconds": 0.004, "energy_residual": 1e-9,
        "error_estimate": 1e-7, "sensitivity": np.nan,
        "effects": "", "dropped": "", "flags": flags,
    }  # fmt: skip


def _links(
    head: Mapping[str, Any], group: Sequence[str], heights: Mapping[str, int], case: str, place: int
) -> list[dict[str, Any]]:
    kind, gap = CASES[case]
    rows = []
    for left, right in pairwise(group):
        for floor in range(1, min(heights[left], heights[right]) + 1):
            if kind == "connector" and floor not in (3, 5):
                continue
            rows.append(
                {**head, "link": f"{left}|{right} {floor}", "left": left, "right": right, "floor": floor}
                | {
                    "kind": kind,
                    "gap": gap,
                    "impacts": 7,
                    "peak_force": 1e6 * PUSH[case] * floor * (1 + 0.1 * place),
                }
                | {"max_closing": 0.8 * gap, "impulse": 1e5, "contact_time": 0.3, "right_floor": floor}
            )
    return rows
