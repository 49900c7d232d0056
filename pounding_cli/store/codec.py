"""A response as a line of JSON and a row of numbers, and back, bit for bit."""

from __future__ import annotations

import json
from dataclasses import fields
from typing import Any

import numpy as np

from pounding_cli.solve.response import BuildingResponse, LinkResponse, Response

_BUILDING_ARRAYS = tuple(f.name for f in fields(BuildingResponse) if f.name not in ("sway", "rocking"))
_LINK_ARRAYS = tuple(f.name for f in fields(LinkResponse))
_ELSEWHERE = ("buildings", "links", "final")
_HEAD = tuple(f.name for f in fields(Response) if f.name not in _ELSEWHERE)
_SENTENCES = {f.name for f in fields(Response) if str(f.type).startswith("tuple[str")}


def encode(response: Response) -> tuple[str, np.ndarray]:
    """Head (JSON: counts, status, cost, sentences) and numbers, shape (k,); the end state is not kept."""
    head: dict[str, Any] = {name: getattr(response, name) for name in _HEAD}
    head["storeys"] = [int(b.shear.size) for b in response.buildings]
    head["n_links"] = int(response.links.impacts.size)
    columns = [np.atleast_1d(getattr(b, name)) for b in response.buildings for name in _BUILDING_ARRAYS]
    columns += [np.array([value for b in response.buildings for value in (b.sway, b.rocking)], float)]
    columns += [np.atleast_1d(getattr(response.links, name)) for name in _LINK_ARRAYS]
    return json.dumps(head, default=_plain), np.concatenate([c.astype(float) for c in columns])


def decode(head: str, numbers: np.ndarray) -> Response:
    """The response that `encode` took apart.

    Raises
    ------
    ValueError, KeyError, TypeError : head and numbers do not belong together
    """
    facts: dict[str, Any] = json.loads(head)
    storeys, n_links = facts.pop("storeys"), facts.pop("n_links")
    sizes = [n for n in storeys for _ in _BUILDING_ARRAYS] + [2 * len(storeys)]
    sizes += [n_links] * len(_LINK_ARRAYS)
    if numbers.shape != (sum(sizes),):
        raise ValueError(f"expected {sum(sizes)} numbers, found {numbers.size}")
    pieces = iter(np.split(numbers, np.cumsum(sizes)[:-1]))
    arrays: list[dict[str, Any]] = [{name: next(pieces) for name in _BUILDING_ARRAYS} for _ in storeys]
    feet = next(pieces).reshape(-1, 2)
    buildings = tuple(
        BuildingResponse(**array, sway=float(foot[0]), rocking=float(foot[1]))
        for array, foot in zip(arrays, feet, strict=True)
    )
    links = LinkResponse(**{name: next(pieces) for name in _LINK_ARRAYS})
    for name in _SENTENCES:
        facts[name] = tuple(facts[name])
    return Response(buildings=buildings, links=links, **facts)


def failed(storeys: list[int], n_links: int, status: str, advice: str, method: str, tolerance: float) -> Response:
    """The response of a scene that gave none: NaN everywhere, and why."""
    columns: list[dict[str, Any]] = [{name: np.full(n, np.nan) for name in _BUILDING_ARRAYS} for n in storeys]
    buildings = tuple(BuildingResponse(**column) for column in columns)
    links = LinkResponse(**{name: np.full(n_links, np.nan) for name in _LINK_ARRAYS})
    return Response(buildings, links, status, advice, method, tolerance, steps=0, events=0, seconds=0.0)


def _plain(value: object) -> object:
    """NumPy scalars and str subclasses as what JSON knows."""
    return value.item() if isinstance(value, np.generic) else str(value)
