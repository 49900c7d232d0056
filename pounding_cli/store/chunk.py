"""Some responses as one block of bytes: what a worker sends, and what a part file holds."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pounding_cli.solver.response import Response
from pounding_cli.store.codec import Header, encode, parse

_MAGIC = b"pound part 2\n"
_SHA = 64


def starts_of(texts: Sequence[str], words: np.ndarray) -> np.ndarray:
    """Where the numbers of each scene begin, and where the last end; shape (scenes + 1,).

    texts : header lines; words : of each scene the number of its header line, shape (scenes,)
    """
    return np.concatenate([[0], np.cumsum(np.array([parse(text).size for text in texts], np.int64)[words])])


@dataclass(frozen=True, eq=False)
class Chunk:
    """Responses taken apart.

    digests : of the scenes
    texts : the different header lines (see `codec`)
    words : of each scene the number of its header line, shape (scenes,)
    numbers : of one scene after another, shape (k,)
    """

    digests: Sequence[str]
    texts: Sequence[str]
    words: np.ndarray
    numbers: np.ndarray

    @classmethod
    def of(cls, responses: Mapping[str, Response]) -> Chunk:
        """The chunk of responses by scene digest."""
        texts: dict[str, int] = {}
        words, rows = [], []
        for response in responses.values():
            text, row = encode(response)
            words.append(texts.setdefault(text, len(texts)))
            rows.append(row)
        return cls(list(responses), list(texts), np.array(words, np.int64), np.concatenate(rows or [np.zeros(0)]))

    @classmethod
    def saying(cls, digests: Sequence[str], texts: Sequence[str], words: np.ndarray, numbers: np.ndarray) -> Chunk:
        """The chunk of responses whose header lines are some of `texts`; the others are left out."""
        used, words = np.unique(words, return_inverse=True)
        return cls(digests, [texts[number] for number in used.tolist()], words, numbers)

    @classmethod
    def joined(cls, chunks: Sequence[Chunk]) -> Chunk:
        """Chunks, one behind the other, as one."""
        texts: dict[str, int] = {}
        words = []
        for chunk in chunks:
            numbers = [texts.setdefault(text, len(texts)) for text in chunk.texts]
            words.append(np.array(numbers, np.int64)[chunk.words])
        digests = [digest for chunk in chunks for digest in chunk.digests]
        return cls(digests, list(texts), np.concatenate(words), np.concatenate([chunk.numbers for chunk in chunks]))

    def __len__(self) -> int:
        return len(self.digests)

    @property
    def lines(self) -> list[str]:
        """The header line of each scene."""
        return [self.texts[word] for word in self.words.tolist()]

    @cached_property
    def starts(self) -> np.ndarray:
        """Where the numbers of each scene begin, and where the last end; shape (scenes + 1,)."""
        return starts_of(self.texts, self.words)

    @cached_property
    def seconds(self) -> np.ndarray:
        """Time in the solver [s], shape (scenes,)."""
        places = self._of_texts(lambda header: header.columns["seconds"])
        return self.numbers[self.starts[:-1] + places[self.words]]

    @property
    def is_done(self) -> np.ndarray:
        """Whether each scene has a result, shape (scenes,)."""
        return self._of_texts(lambda header: header.is_done)[self.words] > 0

    def _of_texts(self, what: Callable[[Header], int]) -> np.ndarray:
        return np.array([what(parse(text)) for text in self.texts], np.int64)

    def row(self, place: int) -> np.ndarray:
        """The numbers of one scene."""
        return self.numbers[self.starts[place] : self.starts[place + 1]]

    def only(self, places: Sequence[int]) -> Chunk:
        """The chunk of some of the scenes."""
        rows = [self.row(place) for place in places]
        digests = [self.digests[place] for place in places]
        words = self.words[np.array(places, np.int64)]
        return Chunk.saying(digests, self.texts, words, np.concatenate(rows or [np.zeros(0)]))

    def to_bytes(self, key: str) -> bytes:
        """A magic line, the SHA-256 of the rest, a line of JSON, the numbers as little-endian doubles."""
        head = {"key": key, "digests": list(self.digests), "lines": list(self.texts), "words": self.words.tolist()}
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
        texts, words, digests = head["lines"], np.array(head["words"]), head["digests"]
        if not "".join(digests).isascii() or max(map(len, digests), default=0) > _SHA:
            raise ValueError("damaged part")
        if words.shape != (len(digests),):
            raise ValueError("damaged part")
        if words.size and (words.dtype.kind != "i" or not 0 <= words.min() <= words.max() < len(texts)):
            raise ValueError("damaged part")
        numbers, mine = np.frombuffer(content, "<f8", offset=end + 1), asked[: len(digests)]
        chunk = cls(mine if mine == digests else digests, texts, words.astype(np.int64), numbers)
        if chunk.starts[-1] != numbers.size:
            raise ValueError("damaged part")
        return chunk
