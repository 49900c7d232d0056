"""Join what the parts of a scene did, each solved by itself, to what the scene did."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from pounding_cli.model.effects import DroppedEffect, effects_of
from pounding_cli.model.links import link_label, link_places
from pounding_cli.model.parts import PartScene
from pounding_cli.model.scene import Scene
from pounding_cli.solver.flags import build_collapse_flag, list_flags
from pounding_cli.solver.response import (
    COLLAPSED,
    COLUMNS,
    DONE,
    LINKS,
    Flag,
    Response,
    building_names,
    count_lines,
    no_peaks,
)


def join_responses(scene: Scene, parts: Sequence[PartScene], responses: Sequence[Response]) -> Response:
    """Return the response of a scene from those of its parts.

    Every peak is that of its part. Where a part has no result the scene has none. Where parts collapse the scene has
    collapsed, first where the first of them did; each part has its peaks up to its own collapse, and those that stand
    to the end of the motion.

    Parameters
    ----------
    parts, responses : of the scene (`divide_scene`), and what each of them did
    """
    storeys = tuple(building.storeys for building in scene.buildings)
    effects = effects_of(scene)
    facts: dict[str, Any] = {
        "storeys": storeys,
        "steps": sum(each.steps for each in responses),
        "events": sum(each.events for each in responses),
        "orders": sum(each.orders for each in responses),
        "seconds": sum(each.seconds for each in responses),
        "effects": effects.kept,
        "dropped": (*effects.dropped, *_list_open_gaps(responses)),
        "final": _join_final(scene, parts, [each.final for each in responses]),
        "final_turns": _join_final(scene, parts, [each.final_turns for each in responses]),
    }
    failed = [each for each in responses if not each.has_result]
    if failed:
        no_energy = dict.fromkeys(failed[0].energy, math.nan)
        return replace(failed[0], **facts, peaks=_build_empty_peaks(scene), energy=no_energy, flags=())
    return replace(
        responses[0],
        **facts,
        status=COLLAPSED if any(each.status == COLLAPSED for each in responses) else DONE,
        peaks=_join_peaks(scene, parts, responses),
        energy=_join_energies([each.energy for each in responses]),
        flags=tuple(_join_flags(parts, responses)),
        error_estimate=float(np.max([each.error_estimate for each in responses])),
        sensitivity=float(np.max([each.sensitivity for each in responses])),
        rest_error=max(each.rest_error for each in responses),
        closing_to_rest=_join_links(scene, parts, [each.closing_to_rest for each in responses]),
    )


States = tuple[tuple[np.ndarray, np.ndarray], ...]
"""Displacements and velocities, one pair of arrays a building."""


def _join_final(scene: Scene, parts: Sequence[PartScene], states: Sequence[States]) -> States:
    """Return the states at the end, one a building; none where a response was kept without."""
    final: dict[int, tuple[np.ndarray, np.ndarray]] = {}
    for each, of_part in zip(parts, states, strict=True):
        final.update(enumerate(of_part, each.part.first))
    return tuple(final[place] for place in range(len(scene.buildings)) if place in final)


def _list_open_gaps(responses: Iterable[Response]) -> list[DroppedEffect]:
    """Return the links that never act among what the parts leave out."""
    return [dropped for each in responses for dropped in each.dropped if dropped.links]


def _build_empty_peaks(scene: Scene) -> np.void:
    """Return the peaks of a scene before anything of it is known: NaN."""
    storeys = [building.storeys for building in scene.buildings]
    lines = max(building.lines for building in scene.buildings)
    return no_peaks(storeys, len(scene.links), lines)


def _join_peaks(scene: Scene, parts: Sequence[PartScene], responses: Sequence[Response]) -> np.void:
    """Return the peaks of a scene from those of its parts."""
    peaks = _build_empty_peaks(scene)
    for each, response in zip(parts, responses, strict=True):
        places = each.part.places
        link_numbers = list(each.part.link_numbers)
        for name in building_names(response.peaks):
            values = response.peaks[name]
            room = (slice(0, size) for size in values.shape[1:])  # a part may have fewer storeys and lines
            peaks[name][(places, *room)] = values
        for name in (*LINKS, *COLUMNS):
            peaks[name][link_numbers] = response.peaks[name]
    return peaks


def _join_links(scene: Scene, parts: Sequence[PartScene], values: Sequence[np.ndarray]) -> np.ndarray:
    """Return values of the links of all parts in the order of the scene's links; none where a part has none."""
    whole = np.full(len(scene.links), np.nan)
    for each, of_part in zip(parts, values, strict=True):
        if of_part.size == len(each.part.link_numbers):
            whole[list(each.part.link_numbers)] = of_part
    return whole


def _join_energies(energies: Sequence[Mapping[str, float]]) -> dict[str, float]:
    """Return the sums of the energies of all parts [J]; the residual [-] is that of the part that closes worst."""
    joined = {name: sum(energy[name] for energy in energies) for name in energies[0]}
    if "residual" in joined:
        joined["residual"] = max((energy["residual"] for energy in energies), key=abs)
    return joined


def _join_flags(parts: Sequence[PartScene], responses: Sequence[Response]) -> Iterator[Flag]:
    """Yield the flags of all parts, collapses first; of a code that names no place the worst alone."""
    placed: list[Flag] = []
    worst_by_code: dict[str, Flag] = {}
    for each, response in zip(parts, responses, strict=True):
        of_places = list_placed_flags(each.scene, response)
        placed += of_places
        for flag in list_other_flags(of_places, response):
            if flag.code not in worst_by_code or flag.severity > worst_by_code[flag.code].severity:
                worst_by_code[flag.code] = flag
    yield from sorted(placed, key=lambda flag: flag.code != "collapse")
    yield from worst_by_code.values()


def list_placed_flags(scene: Scene, response: Response) -> list[Flag]:
    """Return the flags that name buildings, in the names of a scene, from the numbers of its response."""
    collapses = []
    for place in response.fallen_buildings:
        peaks = response.buildings[place]
        collapses.append(build_collapse_flag(scene.buildings[place].name, peaks.collapse_storey, peaks.collapse_time))
    return [*collapses, *list_flags(scene, response.peaks)]


def list_other_flags(placed: Iterable[Flag], response: Response) -> list[Flag]:
    """Return the flags of a response of other codes than those that name buildings."""
    codes = {flag.code for flag in placed}
    return [flag for flag in response.flags if flag.code not in codes]


def join_histories(scene: Scene, parts: Sequence[PartScene], histories: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Return the history of a scene from those of its parts, which share their output times.

    Energies are sums. It ends where the first of the parts does, at a collapse or at the end of the motion.
    """
    count = min(history["time"][1].size for history in histories)
    axes = _list_axes(scene)
    joined: dict[str, Any] = {}
    fields: dict[str, Any] = {}
    for history in histories:  # floors of some parts alone may twist
        fields = {**history, **fields}
    for name, (dims, values, attrs) in fields.items():
        if name in axes:
            joined[name] = dims, axes[name], attrs
        elif dims == ("time",) and name.startswith("energy_"):
            joined[name] = dims, sum(history[name][1][:count] for history in histories), attrs
        elif dims == ("time",):
            joined[name] = dims, values[:count], attrs
        else:
            joined[name] = dims, _join_series(name, dims[1:], count, axes, parts, histories), attrs
    return joined


def _list_axes(scene: Scene) -> dict[str, np.ndarray]:
    """Return the names of buildings and links, and the numbers of storeys and floors, of the history of a scene."""
    names = [building.name for building in scene.buildings]
    numbers = np.arange(1, max(building.storeys for building in scene.buildings) + 1)
    links = [link_label(names, place) for place in link_places(scene.links)]
    return {
        "building": np.array(names, object),
        "storey": numbers,
        "floor": numbers,
        "link": np.array(links, object),
        "line": np.arange(1, count_lines(_build_empty_peaks(scene)) + 1),
    }


def _join_series(
    name: str,
    dims: Sequence[str],
    count: int,
    axes: Mapping[str, np.ndarray],
    parts: Sequence[PartScene],
    histories: Sequence[Mapping[str, Any]],
) -> np.ndarray:
    """Return a quantity of buildings or links over time, shape (count, *lengths of the axes)."""
    whole = np.full((count, *(axes[dim].size for dim in dims)), np.nan)
    for each, history in zip(parts, histories, strict=True):
        if name not in history:
            continue
        values = history[name][1][:count]
        if dims[0] == "link":
            whole[:, list(each.part.link_numbers)] = values
        else:
            room = (slice(0, size) for size in values.shape[2:])
            whole[(slice(None), each.part.places, *room)] = values
    return whole
