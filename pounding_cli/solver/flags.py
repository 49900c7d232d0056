"""The flags of a scene: what a reader of its peaks should know about them."""

from __future__ import annotations

import numpy as np

from pounding_cli.model.meetings import face_each_other
from pounding_cli.model.scene import Scene
from pounding_cli.model.wall import Wall
from pounding_cli.notes import NOTES
from pounding_cli.solver.response import Flag

PASSING_SHARE = 0.1
"""Part of a storey height by which floors may press into each other before they count as passing through [-]."""


def list_flags(scene: Scene, peaks: np.void) -> tuple[Flag, ...]:
    """Return a flag for each base and each link that moved further than it can, and for floors that pass through.

    A base moves further than its isolators can, and a link is compressed beyond its thickness or its gap (paper, after
    eqs 9 and 10); the severity of the flag is how far beyond [m]. Where another link lets the floors strike, nothing is
    left out. The ends of a joint that are not as high as each other have no gap between them: there it is enough that
    links let these neighbours strike where they face each other.
    """
    flags = list[Flag]()
    for building, sway in zip(scene.buildings, peaks["sway"].tolist(), strict=True):
        isolation = None if building.foundation is None else building.foundation.isolation
        if isolation is not None and sway > isolation.capacity:
            beyond = sway - isolation.capacity
            detail = f"{building.name}, by {1000 * beyond:.3g} mm"
            flags.append(Flag("isolators", detail, beyond))
    striking = [link for link in scene.links if link.law.subtracts_gap]
    striking_ends = {link.ends for link in striking}
    striking_pairs = {link.left for link in striking}
    for link, closing in zip(scene.links, peaks["max_closing"].tolist(), strict=True):
        if not (closing > link.gap and link.law.beyond_gap):
            continue
        left, right = scene.buildings[link.left : link.left + 2]
        lets_strike = link.ends in striking_ends
        if link.left in striking_pairs and not face_each_other(link, left, right):
            lets_strike = True
        code = link.law.beyond_gap
        if NOTES[code].can_be_accepted or not lets_strike:
            beyond = closing - link.gap
            place = f"{link.law.name} of {left.name} | {right.name}, floor {link.left_floor}"
            flags.append(Flag(code, f"{place}, by {1000 * beyond:.3g} mm", beyond))
    return (*flags, *list_passing_floors(scene, peaks))


def list_passing_floors(scene: Scene, peaks: np.void) -> list[Flag]:
    """Return a flag for each contact that closed its gap by more than `PASSING_SHARE` of a storey height.

    Parameters
    ----------
    peaks : record of `peaks_type` with the largest closing of every link [m]
    """
    flags = []
    for link, closing in zip(scene.links, peaks["max_closing"].tolist(), strict=True):
        if not link.law.subtracts_gap:
            continue
        left = scene.buildings[link.left]
        right = scene.buildings[link.left + 1]
        ends = ((left, link.left_floor), (right, link.right_floor))
        frames = [(building, floor) for building, floor in ends if not isinstance(building, Wall)]
        heights = [float(building.height[max(floor - 1, 0)]) for building, floor in frames]
        beyond = closing - link.gap
        if heights and beyond > PASSING_SHARE * min(heights):
            place = f"{left.name} | {right.name}, floor {link.left_floor}"
            flags.append(Flag("passing", f"{place}, by {1000 * beyond:.3g} mm", beyond))
    return flags


def build_collapse_flag(building: str, storey: int, time: float) -> Flag:
    """Return the flag of a storey of a building that collapsed, counted from 1, at a time [s]."""
    return Flag("collapse", f"{building} storey {storey}, at {time:.4g} s", severity=-time)  # the earlier, the worse
