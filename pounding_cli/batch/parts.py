"""Scenes of parts that nothing links: what is solved are their parts, each of them once."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from pounding_cli.batch.apart import add_open_gaps
from pounding_cli.model.parts import PartScene, divide_scene
from pounding_cli.model.scene import Scene
from pounding_cli.results.responses import Row, decode_response, encode_response, read_status, solution_key
from pounding_cli.solver.parts import join_responses
from pounding_cli.solver.response import OUTCOMES, Response

if TYPE_CHECKING:
    from pounding_cli.batch.cache import Cache
    from pounding_cli.study.run_plan import Plan


def list_parts(plan: Plan) -> list[bytes]:
    """Return the digests of all parts of the divided scenes of a plan."""
    return list(DividedScenes(plan, np.flatnonzero(plan.divided)).part_scenes)


class SceneList:
    """Scenes to solve: those of a plan by their numbers there, and behind them parts of its divided scenes.

    parts : of divided scenes that are no scenes of the plan, by digest
    """

    def __init__(self, plan: Plan, parts: Mapping[bytes, Scene]) -> None:
        self.plan = plan
        self._parts = list(parts.values())
        self._part_digests = list(parts)

    @property
    def part_numbers(self) -> np.ndarray:
        """The numbers of the parts."""
        return np.arange(len(self.plan), len(self.plan) + len(self._parts))

    def scenes(self, numbers: np.ndarray) -> Iterator[Scene]:
        """Yield some scenes by number."""
        count = len(self.plan)
        of_plan = self.plan.scenes(numbers[numbers < count])
        for number in numbers.tolist():
            yield next(of_plan) if number < count else self._parts[number - count]

    def digest(self, number: int) -> bytes:
        """Return the digest of a scene by number."""
        count = len(self.plan)
        return self.plan.digests[number].tobytes() if number < count else self._part_digests[number - count]


class DividedScenes:
    """Divided scenes of a plan that are to be solved, and the responses of their parts as they come.

    Parameters
    ----------
    numbers : of these scenes in the plan

    Attributes
    ----------
    part_scenes : every different part as a scene of its own, by digest
    """

    def __init__(self, plan: Plan, numbers: np.ndarray) -> None:
        self.part_scenes: dict[bytes, Scene] = {}
        self._scenes: dict[int, Scene] = {}
        self._parts: dict[int, tuple[PartScene, ...]] = {}
        self._waiting: dict[int, int] = {}  # different parts of each scene whose response is not there yet
        self._users: defaultdict[bytes, list[int]] = defaultdict(list)
        self._responses: dict[bytes, Response] = {}
        self._unpaid_seconds: dict[bytes, float] = {}  # of parts solved now, until a scene is charged with them
        for number, scene in zip(numbers.tolist(), plan.scenes(numbers), strict=True):
            parts = divide_scene(scene)
            by_digest = {bytes.fromhex(part.scene.digest): part.scene for part in parts}
            self._scenes[number] = scene
            self._parts[number] = parts
            self._waiting[number] = len(by_digest)
            self.part_scenes |= by_digest
            for digest in by_digest:
                self._users[digest].append(number)

    def list_unknown(self, known: Mapping[bytes, int]) -> dict[bytes, Scene]:
        """Return the parts whose response is not there, by digest, without those that are solved anyway.

        known : digests of scenes that are solved anyway
        """
        return {
            digest: scene
            for digest, scene in self.part_scenes.items()
            if digest not in known and digest not in self._responses
        }

    def load(self, cache: Cache, plan: Plan) -> dict[int, Row]:
        """Return the responses of scenes of which a cache has all parts, by number; one that failed is not there."""
        found: dict[bytes, Row] = {}
        for rows in cache.iter_rows(solution_key(plan), list(self.part_scenes)):
            found |= {digest: row for digest, row in rows.items() if read_status(row) in OUTCOMES}
        return self.add(found)

    def add(self, rows: Mapping[bytes, Row], charged: Sequence[bytes] = ()) -> dict[int, Row]:
        """Take in responses of parts, and return those of the scenes that have all of theirs now, by number.

        Parameters
        ----------
        rows : responses by digest; those of other scenes are passed over
        charged : digests of parts whose time belongs to the first scene that has them
        """
        ready = []
        for digest, row in rows.items():
            if digest not in self.part_scenes or digest in self._responses:
                continue
            storeys = tuple(building.storeys for building in self.part_scenes[digest].buildings)
            response = decode_response(row, storeys)
            self._responses[digest] = response
            if digest in charged:
                self._unpaid_seconds[digest] = response.seconds
            for number in self._users[digest]:
                self._waiting[number] -= 1
                if not self._waiting[number]:
                    ready.append(number)
        return {number: encode_response(self._join(number)) for number in ready}

    def _join(self, number: int) -> Response:
        """Return the response of a scene from those of its parts."""
        responses = []
        for part in self._parts[number]:
            digest = bytes.fromhex(part.scene.digest)
            response = replace(self._responses[digest], seconds=self._unpaid_seconds.pop(digest, 0.0))
            responses.append(add_open_gaps(part.scene, response))
        return join_responses(self._scenes[number], self._parts[number], responses)
