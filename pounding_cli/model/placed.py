"""Scenes by digest that other processes are told of by a number."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping

from pounding_cli.model.scene import Scene


class Placed(Mapping[str, Scene]):
    """Scenes by digest, built when asked for. A forked process that looks digests up would copy the memory in which
    they stand, since Python counts who uses them: it is told the place of a scene instead, a number."""

    @abstractmethod
    def place(self, digest: str) -> int:
        """Where a scene stands.  Raises `KeyError`."""

    @abstractmethod
    def at(self, place: int) -> Scene:
        """The scene at a place."""

    def __getitem__(self, digest: str) -> Scene:
        return self.at(self.place(digest))
