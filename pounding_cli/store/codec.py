"""A response as a header line and numbers, and back, bit for bit.

The header (status, sentences, which numbers follow) is the same for most scenes of a study, so it is kept once."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import lru_cache
from operator import attrgetter
from typing import Any

import numpy as np

from pounding_cli.solver.response import (
    DONE,
    OUTCOMES,
    BuildingResponse,
    ColumnResponse,
    LinkResponse,
    Response,
    nothing,
)

_BUILDING_ARRAYS = tuple(f.name for f in fields(BuildingResponse) if f.name not in ("sway", "rocking"))
_LINK_ARRAYS = tuple(f.name for f in fields(LinkResponse))
_COLUMN_ARRAYS = tuple(f.name for f in fields(ColumnResponse))
_COUNTS = tuple(f.name for f in fields(Response) if f.type == "int")
_SCALARS = tuple(f.name for f in fields(Response) if f.type in ("int", "float"))
_TEXTS = tuple(f.name for f in fields(Response) if f.type == "str")
_SENTENCES = tuple(f.name for f in fields(Response) if str(f.type).startswith("tuple[str"))
_texts_of, _sentences_of, _scalars_of = (attrgetter(*names) for names in (_TEXTS, _SENTENCES, _SCALARS))
_arrays_of_building, _arrays_of_links = attrgetter(*_BUILDING_ARRAYS), attrgetter(*_LINK_ARRAYS)


@dataclass(frozen=True)
class Header:
    """What a header line says: the facts of a response, and where its numbers stand.

    facts : status, advice, method; sentences as tuples
    columns : place of every scalar, and of the energies as `energy_<name>`
    buildings : for every building, the span of each of its arrays and of sway and rocking (spans of one)
    links, columns_struck : the span of each array
    size : numbers in all
    """

    facts: dict[str, Any]
    columns: dict[str, int]
    buildings: tuple[dict[str, slice], ...]
    links: dict[str, slice]
    columns_struck: dict[str, slice]
    size: int

    @property
    def is_done(self) -> bool:
        """Whether the scene has a result: it ended with the motion, or with a collapse."""
        return self.facts["status"] in OUTCOMES

    @property
    def has_peaks(self) -> bool:
        """Whether its largest values are those of the whole motion."""
        return self.facts["status"] == DONE


def encode(response: Response) -> tuple[str, np.ndarray]:
    """The header line (JSON) and the numbers, shape (k,); the end state and the samples are not kept."""
    line = _line(
        _texts_of(response),
        _sentences_of(response),
        tuple(response.energy),
        tuple([b.shear.size for b in response.buildings]),
        response.links.impacts.size,
        response.columns.link.size,
    )
    columns: list[Sequence[float] | np.ndarray] = [(*_scalars_of(response), *response.energy.values())]
    for b in response.buildings:
        columns += _arrays_of_building(b)
        columns.append((b.sway, b.rocking))
    columns += _arrays_of_links(response.links)
    if response.columns.link.size:
        columns += [getattr(response.columns, name) for name in _COLUMN_ARRAYS]
    return line, np.concatenate(columns, dtype=float)


@lru_cache(maxsize=1024)
def _line(
    texts: tuple[str, ...],
    sentences: tuple[tuple[str, ...], ...],
    energy: tuple[str, ...],
    storeys: tuple[int, ...],
    links: int,
    struck: int,
) -> str:
    """The header line of a response: the same object for all that say the same."""
    said: dict[str, Any] = {name: str(text) for name, text in zip(_TEXTS, texts, strict=True)}
    said |= {name: list(map(str, some)) for name, some in zip(_SENTENCES, sentences, strict=True)}
    said |= {"energy": list(energy), "storeys": list(storeys), "links": links}
    return json.dumps(said | ({"columns": struck} if struck else {}))


@lru_cache(maxsize=1024)
def parse(text: str) -> Header:
    """What a header line says.

    Raises
    ------
    ValueError, KeyError, TypeError : it is not one
    """
    facts: dict[str, Any] = json.loads(text)
    names = [*_SCALARS, *(f"energy_{_text(name)}" for name in facts.pop("energy"))]
    storeys, n_links = map(_count, facts.pop("storeys")), _count(facts.pop("links"))
    n_struck = _count(facts.pop("columns", 0))
    facts = {name: _text(facts[name]) for name in _TEXTS} | {
        name: tuple(_text(sentence) for sentence in facts[name]) for name in _SENTENCES
    }
    end = len(names)

    def spans(sizes: dict[str, int]) -> dict[str, slice]:
        nonlocal end
        found = {}
        for name, size in sizes.items():
            found[name] = slice(end, end + size)
            end += size
        return found

    buildings = tuple(spans(dict.fromkeys(_BUILDING_ARRAYS, n) | {"sway": 1, "rocking": 1}) for n in storeys)
    links = spans(dict.fromkeys(_LINK_ARRAYS, n_links))
    struck = spans(dict.fromkeys(_COLUMN_ARRAYS, n_struck))
    return Header(facts, {name: place for place, name in enumerate(names)}, buildings, links, struck, end)


def _text(value: Any) -> str:
    """A text that a results file can hold."""
    if not isinstance(value, str) or "\0" in value:
        raise ValueError("a text of a response's header that is none")
    value.encode("utf-8")
    return value


def _count(value: Any) -> int:
    """A number of storeys or links."""
    if type(value) is not int or value < 0:
        raise ValueError("a number of storeys or links that is none")
    return value


def decode(text: str, numbers: np.ndarray) -> Any:
    """The response that `encode` took apart.

    Raises
    ------
    ValueError, KeyError, TypeError : header and numbers do not belong together
    """
    header = parse(text)
    if numbers.shape != (header.size,):
        raise ValueError(f"expected {header.size} numbers, found {numbers.size}")
    scalars: dict[str, Any] = {name: float(numbers[place]) for name, place in header.columns.items()}
    energy = {name[len("energy_") :]: scalars.pop(name) for name in header.columns if name.startswith("energy_")}
    scalars |= {name: int(scalars[name]) for name in _COUNTS}
    buildings = tuple(
        BuildingResponse(
            **{name: numbers[spans[name]].copy() for name in _BUILDING_ARRAYS},
            sway=float(numbers[spans["sway"]][0]),
            rocking=float(numbers[spans["rocking"]][0]),
        )
        for spans in header.buildings
    )
    links = LinkResponse(**{name: numbers[header.links[name]].copy() for name in _LINK_ARRAYS})
    struck = {name: numbers[header.columns_struck[name]].copy() for name in _COLUMN_ARRAYS}
    columns = ColumnResponse(**struck | {"link": struck["link"].astype(np.int64)})
    return Response(buildings=buildings, links=links, energy=energy, columns=columns, **scalars, **header.facts)


def failed(
    storeys: list[int], n_links: int, status: str, advice: str, method: str, accuracy: float, time_step: float
) -> Response:
    """The response of a scene that gave none: NaN everywhere, and why."""
    buildings, links, columns = nothing(storeys, n_links, 0)
    return Response(buildings, links, status, advice, method, accuracy, 0, 0, 0.0, time_step=time_step, columns=columns)
