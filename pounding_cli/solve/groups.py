"""A row of buildings falls apart where nothing closes: its groups are solved alone, each once, and the rest is proof.

If the groups of a row, run one by one, never close a link between two of them, then no force crosses from one to the
other: their responses *are* the response of the row, which is unique. The proof needs no more than bounds of the
displacements in every segment of the motion, and those come with the very runs that give the baselines."""

from __future__ import annotations

import dataclasses
import threading
from collections import OrderedDict
from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np

from pounding_cli.model.effects import effects_of
from pounding_cli.model.links import Kind, Link
from pounding_cli.model.scene import Scene
from pounding_cli.solve.response import LinkResponse, Response, composed_method

ERRORS = 10.0
"""By so many accuracies, relative to the floors' own displacements, a gap must stay open to count as never closed."""

MEMORY = 64 * 2**20
"""Envelopes kept for the scenes that follow [bytes]."""


class GroupSolver:
    """Solves scenes in the smallest groups that do not meet, and keeps what the next scenes may need again.

    Parameters
    ----------
    respond : (scene, watch) -> Response, with its envelopes where asked to watch
    accuracy : relative error of its peaks [-]

    What it answers depends on the scene alone, never on what came before. Threads may share it.
    """

    def __init__(self, respond: Callable[[Scene, bool], Response], accuracy: float) -> None:
        self._respond = respond
        self._accuracy = accuracy
        self._kept: OrderedDict[str, Response] = OrderedDict()
        self._bytes = 0
        self._unbooked = 0.0
        self._lock = threading.Lock()

    def __call__(self, scene: Scene) -> Response:
        """The response of a scene. Its seconds include groups of several buildings that were solved on the way: those
        are no scenes of their own, as buildings alone are."""
        if not scene.links and len(scene.buildings) == 1:
            return dataclasses.replace(self._watched(scene), envelopes=())
        response = self.by_proof(scene) or self._respond(scene, False)
        with self._lock:
            beside, self._unbooked = self._unbooked, 0.0
        return dataclasses.replace(response, seconds=response.seconds + beside) if beside else response

    def by_proof(self, scene: Scene) -> Response | None:
        """The response of a row that falls apart, from the groups it falls into; None if all of it may meet."""
        groups = _first_groups(scene)
        while len(groups) > 1:
            parts = [self._watched(_cut_out(scene, group)) for group in groups]
            if any(part.status != "done" for part in parts):
                return None
            reach = [
                _reach(scene, left, right, a, b, self._accuracy)
                for (left, right), (a, b) in zip(pairwise(groups), pairwise(parts), strict=True)
            ]
            meeting = [number for number, bounds in enumerate(reach) if bounds is None]
            if not meeting:
                return _composed(scene, groups, parts, [bounds for bounds in reach if bounds is not None])
            groups = _merged(groups, meeting)
        return None

    def _watched(self, scene: Scene) -> Response:
        """The response with its envelopes, from memory if it is there."""
        with self._lock:
            if scene.digest in self._kept:
                self._kept.move_to_end(scene.digest)
                return self._kept[scene.digest]
        response = self._respond(scene, True)
        with self._lock:
            self._unbooked += response.seconds if len(scene.buildings) > 1 else 0.0
            if scene.digest not in self._kept:
                self._kept[scene.digest] = response
                self._bytes += _size(response)
            while self._bytes > MEMORY and len(self._kept) > 1:
                self._bytes -= _size(self._kept.popitem(last=False)[1])
        return response


def sure_parts(scene: Scene) -> list[Scene]:
    """The groups of several buildings that a row is taken apart into before anything is known of its responses."""
    groups = _first_groups(scene)
    return [_cut_out(scene, group) for group in groups if len(group) > 1] if len(groups) > 1 else []


Reach = dict[Link, float]
"""Of every link between two groups that never meet: what its closing u_l - u_r stays below [m]."""


def _between(scene: Scene, left: int) -> list[Link]:
    return [link for link in scene.links if link.left == left]


def _move_alike(scene: Scene, link: Link) -> bool:
    """Whether the link joins the same floor of two equal buildings: as long as nothing else pushes them, it is not
    closed by anything."""
    a, b = scene.buildings[link.left], scene.buildings[link.left + 1]
    return link.left_floor == link.right_floor and a.digest == b.digest


def _sure_to_meet(scene: Scene) -> list[int]:
    """Pairs, by the place of the left building, with a link that a first movement may already close."""
    return sorted(
        {
            link.left
            for link in scene.links
            if (link.kind is not Kind.POUNDING or link.gap == 0) and not _move_alike(scene, link)
        }
    )


def _first_groups(scene: Scene) -> list[range]:
    """Every building by itself, but for those that are sure to meet."""
    return _merged([range(b, b + 1) for b in range(len(scene.buildings))], _sure_to_meet(scene))


def _merged(groups: list[range], meeting: Sequence[int]) -> list[range]:
    """The groups with each one in `meeting` joined to the next."""
    joined = [groups[0]]
    for number, group in enumerate(groups[1:]):
        if number in meeting:
            joined[-1] = range(joined[-1].start, group.stop)
        else:
            joined.append(group)
    return joined


def _cut_out(scene: Scene, group: range) -> Scene:
    """The group by itself."""
    links = tuple(
        dataclasses.replace(link, left=link.left - group.start) for link in scene.links if link.left in group[:-1]
    )
    return Scene(scene.buildings[group.start : group.stop], links, scene.motion, scene.analysis, scene.tail)


def _reach(scene: Scene, left: range, right: range, a: Response, b: Response, accuracy: float) -> Reach | None:
    """Bounds of the closings between two neighbouring groups; None if one may close."""
    bounds: Reach = {}
    alone = len(left) == len(right) == 1
    for link in _between(scene, left[-1]):
        if alone and _move_alike(scene, link):
            bounds[link] = 0.0
            continue
        if not (a.envelopes and b.envelopes):
            return None
        top = a.envelopes[-1].top[:, link.left_floor - 1]
        bottom = b.envelopes[0].bottom[:, link.right_floor - 1]
        error = ERRORS * accuracy * float(np.max(np.abs(top)) + np.max(np.abs(bottom)))
        bounds[link] = float(np.max(top - bottom))
        if link.kind is not Kind.POUNDING or bounds[link] + error >= link.gap:
            return None
    return bounds


def _composed(scene: Scene, groups: list[range], parts: list[Response], reach: list[Reach]) -> Response:
    """The response of the row from those of its groups; what these cost is booked when they are solved."""
    found: dict[Link, tuple[float, ...]] = {}
    for group, part in zip(groups, parts, strict=True):
        inside = [link for link in scene.links if link.left in group[:-1]]
        found |= zip(inside, zip(*dataclasses.astuple(part.links), strict=True), strict=True)
    still = {link: bound for bounds in reach for link, bound in bounds.items()}
    rows = [found.get(link, (0, 0.0, still.get(link, 0.0), 0.0, 0.0)) for link in scene.links]
    columns = zip(*rows, strict=True) if rows else [()] * 5
    names = [field.name for field in dataclasses.fields(LinkResponse)]
    links = LinkResponse(
        **{n: np.array(c, int if n == "impacts" else float) for n, c in zip(names, columns, strict=True)}
    )
    effects = tuple(dict.fromkeys(effect for part in parts for effect in part.effects))
    sentences = (_sentence(scene, bounds) for bounds in reach)
    return Response(
        tuple(building for part in parts for building in part.buildings),
        links,
        "done",
        "",
        composed_method(parts),
        parts[0].tolerance,
        steps=0,
        events=0,
        seconds=0.0,
        energy=_summed([part.energy for part in parts]),
        flags=tuple(dict.fromkeys(flag for part in parts for flag in part.flags)),
        effects=effects,
        dropped=(*effects_of(scene).dropped, *(sentence for sentence in sentences if sentence)),
        error_estimate=float(np.max([part.error_estimate for part in parts])),
        sensitivity=float(np.max([part.sensitivity for part in parts])),
        final=tuple(end for part in parts for end in part.final),
    )


def _sentence(scene: Scene, bounds: Reach) -> str:
    """Why the links between two groups were not simulated."""
    if not bounds:
        return ""
    left = next(iter(bounds)).left
    names = " | ".join(building.name for building in scene.buildings[left : left + 2])
    if all(bound == 0 for bound in bounds.values()):
        return f"links {names}: equal buildings move alike, so nothing closes"
    least = min(link.gap - bound for link, bound in bounds.items())
    return f"links {names}: the gap never closes, at least {least * 1000:.3g} mm of it stay open"


def _summed(ledgers: list[dict[str, float]]) -> dict[str, float]:
    """The ledgers of groups as one; what is missing is summed before it is made relative."""
    book = {key: sum(ledger[key] for ledger in ledgers) for key in ledgers[0] if key != "residual"}
    missing = book["input"] - sum(value for key, value in book.items() if key != "input")
    scale = max(abs(value) for value in book.values())
    return book | {"residual": missing / scale if scale > 0 else 0.0}


def _size(response: Response) -> int:
    return sum(envelope.top.nbytes + envelope.bottom.nbytes for envelope in response.envelopes)
