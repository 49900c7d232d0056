"""Some responses as one block of bytes: what a worker sends, and what a part file holds."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pounding_cli.solve.response import Response
from pounding_cli.store.codec import encode, parse

_MAGIC = b"pound part 2\n"
_SHA = 64


@dataclass(frozen=True, eq=False)
class Chunk:
    """Responses taken apart.

    digests : of the scenes; lines : the header line of each scene (see `codec`), equal lines being one object
    numbers : of one scene after another, shape (k,)
    """

    digests: Sequence[str]
    lines: Sequence[str]
    numbers: np.ndarray

    @classmethod
    def of(cls, responses: Mapping[str, Response]) -> Chunk:
        """The chunk of responses by scene digest."""
        coded = [encode(response) for response in responses.values()]
        same: dict[str, str] = {}
        found = [same.setdefault(text, text) for text, _ in coded]
        return cls(list(responses), found, np.concatenate([numbers for _, numbers in coded] or [np.zeros(0)]))

    @classmethod
    def joined(cls, chunks: Sequence[Chunk]) -> Chunk:
        """Chunks, one behind the other, as one."""
        same: dict[str, str] = {}
        found = [same.setdefault(text, text) for chunk in chunks for text in chunk.lines]
        digests = [digest for chunk in chunks for digest in chunk.digests]
        return cls(digests, found, np.concatenate([chunk.numbers for chunk in chunks]))

    def __len__(self) -> int:
        return len(self.digests)

    @cached_property
    def starts(self) -> np.ndarray:
        """Where the numbers of each scene begin, and where the last end; shape (scenes + 1,)."""
        return np.cumsum([0, *(parse(text).size for text in self.lines)])

    @property
    def seconds(self) -> np.ndarray:
        """Time in the solver [s], shape (scenes,)."""
        places = [parse(text).columns["seconds"] for text in self.lines]
        return self.numbers[self.starts[:-1] + np.array(places, int)]

    @property
    def is_done(self) -> list[bool]:
        """Whether each scene has a result."""
        return [parse(text).is_done for text in self.lines]

    def row(self, place: int) -> np.ndarray:
        """The numbers of one scene."""
        return self.numbers[self.starts[place] : self.starts[place + 1]]

    def only(self, places: Sequence[int]) -> Chunk:
        """The chunk of some of the scenes."""
        rows = [self.row(place) for place in places]
        return Chunk(
            [self.digests[place] for place in places],
            [self.lines[place] for place in places],
            np.concatenate(rows or [np.zeros(0)]),
        )

    def to_bytes(self, key: str) -> bytes:
        """A magic line, the SHA-256 of the rest, a line of JSON, the numbers as little-endian doubles."""
        distinct = list(dict.fromkeys(self.lines))
        number = {text: place for place, text in enumerate(distinct)}
        head = {
            "key": key,
            "digests": list(self.digests),
            "lines": distinct,
            "words": [number[text] for text in self.lines],
        }
        body = json.dumps(head).encode() + b"\n" + self.numbers.astype("<f8").tobytes()
        return _MAGIC + hashlib.sha256(body).hexdigest().encode() + b"\n" + body

    @classmethod
    def from_bytes(cls, content: bytes, key: str, asked: Sequence[str] = ()) -> Chunk | None:
        """The chunk, or None where it was made under another key.

        asked : the digests that it was made for; where it has these, they are not held twice

        Raises
        ------
        ValueError, KeyError, TypeError, IndexError : damaged
        """
        begin = len(_MAGIC) + _SHA + 1
        sha = hashlib.sha256(memoryview(content)[begin:]).hexdigest()
        if content[:begin] != _MAGIC + sha.encode() + b"\n":
            raise ValueError("damaged part")
        end = content.index(b"\n", begin)
        head = json.loads(content[begin:end])
        if head["key"] != key:
            return None
        lines = head["lines"]
        if not all(isinstance(digest, str) and len(digest) <= _SHA and digest.isascii() for digest in head["digests"]):
            raise ValueError("damaged part")
        numbers = np.frombuffer(content, "<f8", offset=end + 1)
        digests, mine = head["digests"], asked[: len(head["digests"])]
        chunk = cls(mine if mine == digests else digests, [lines[place] for place in head["words"]], numbers)
        if len(chunk.digests) != len(chunk.lines) or chunk.starts[-1] != numbers.size:
            raise ValueError("damaged part")
        return chunk
