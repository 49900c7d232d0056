"""Scenes by digest that other processes are told of by a number."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from pounding_cli.model.scene import Scene


class Placed(Mapping[str, Scene]):
    """Scenes by digest, built when asked for. A forked process that looks digests up would copy the memory in which
    they stand, since Python counts who uses them: it is told the place of a scene instead, a number."""

    @abstractmethod
    def place(self, digest: str) -> int:
        """Where a scene stands.  Raises `KeyError`."""

    def places(self, digests: Sequence[str]) -> list[int]:
        """Where scenes stand.  Raises `KeyError`."""
        return [self.place(digest) for digest in digests]

    @abstractmethod
    def at(self, place: int) -> Scene:
        """The scene at a place."""

    def has(self, digests: Sequence[str]) -> np.ndarray:
        """Whether each scene is there, shape (digests,)."""
        return np.array([digest in self for digest in digests], bool)

    def __getitem__(self, digest: str) -> Scene:
        return self.at(self.place(digest))


def found(scenes: Mapping[str, Any], digests: Sequence[str]) -> Callable[[str], Any]:
    """What gives each of some scenes, built when it is asked for; they are looked up together."""
    if not isinstance(scenes, Placed):
        return scenes.__getitem__
    places = dict(zip(digests, scenes.places(digests), strict=True))
    return lambda digest: scenes.at(places[digest])


def among(scenes: Mapping[str, Scene], digests: Sequence[str]) -> np.ndarray:
    """Whether each digest is that of one of the scenes, shape (digests,)."""
    if isinstance(scenes, Placed):
        return scenes.has(digests)
    return np.array([digest in scenes for digest in digests], bool)
