"""The responses of a run: in memory while they are few, else in `FILE.h5.parts/`, each part whole or not there."""

from __future__ import annotations

import errno
import itertools
import os
import shutil
import sys
import uuid
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from pounding_cli.digests import DigestMap, DigestTable, pieces, runs
from pounding_cli.model.placed import among
from pounding_cli.model.scene import Scene
from pounding_cli.outputs import parts_of
from pounding_cli.solver.response import Response
from pounding_cli.store.chunk import Chunk, starts_of
from pounding_cli.store.codec import Header, decode, parse
from pounding_cli.store.packed import deflate
from pounding_cli.store.seal import open_regular

_SPAN = 1 << 24
"""More than the scenes of one chunk."""

_AT_ONCE = 1 << 14
"""Scenes looked up together."""

IN_MEMORY = 8 << 20
"""Numbers of chunks on disk that stay in memory [bytes]: those of a run of some 10,000 scenes, which then are not read
back to be written."""

_FEW = 4
"""Where less than this part of a chunk is asked for, its numbers are copied."""


class PartStore(Mapping[str, Response]):
    """Responses by scene digest; a run that was stopped goes on from its parts.

    Only where each response stands is held in memory once the chunks are on disk.

    Parameters
    ----------
    output : the results file the parts belong to
    key : `solution_key`; parts with another key are not read
    table : the digests that most responses have, which are not held once more
    """

    def __init__(self, output: Path, key: str, table: DigestTable | None = None) -> None:
        self.folder = parts_of(output)
        self.key = key
        self._chunks: list[_Held] = []
        self._unsaved: dict[int, bytes] = {}
        self._room = IN_MEMORY
        self._table = table
        self._where = DigestMap(table)

    @classmethod
    def of(cls, responses: Mapping[str, Response]) -> PartStore:
        """Responses at hand, in memory."""
        store = cls(Path("-"), "")
        store.add(Chunk.of(responses))
        return store

    def load(self) -> list[Path]:
        """Find the scenes that are done in the parts on disk; those of another key are passed over.

        Returns the parts that are damaged.
        """
        damaged = []
        digests: list[str] = []
        places: list[np.ndarray] = []

        def put() -> None:  # looked up together: one part's by themselves take several times as long
            self._where.put(digests, np.concatenate(places or [np.zeros(0, np.int64)]))
            digests.clear()
            places.clear()

        for path in sorted(self.folder.glob("*.part")):
            try:
                chunk = Chunk.from_bytes(_content(path), self.key)
            except Exception:  # whatever is wrong with it, its scenes can be solved
                damaged.append(path)
                continue
            if chunk is not None:
                good = chunk.is_done
                digests += itertools.compress(chunk.digests, good)
                places.append(self._take_in(_Held(chunk, path)) + np.flatnonzero(good))
            if len(digests) >= _AT_ONCE:
                put()
        put()
        return damaged

    def add(self, chunk: Chunk, content: bytes = b"") -> None:
        """Take a chunk in, for now in memory; `content`: its bytes, where they are at hand."""
        if len(chunk):
            self._unsaved[len(self._chunks)] = content
            self._where.put(chunk.digests, self._take_in(_Held(chunk, None)) + np.arange(len(chunk)))

    def only(self, wanted: Mapping[str, Scene]) -> None:
        """Forget every other scene."""
        where, self._where = self._where, DigestMap(self._table)
        for some in where.pieces():
            texts = some[:]
            kept = [texts[place] for place in np.flatnonzero(among(wanted, some)).tolist()]
            self._where.put(kept, where.of(kept))

    def flush(self) -> None:
        """Bring to disk what is in memory only.

        Raises
        ------
        OSError : the disk is full, or the folder cannot be written; no part is left half written
        """
        self._join([number for number in self._unsaved if len(self._chunks[number].words) == 1])
        for number, content in list(self._unsaved.items()):
            chunk = self._chunks[number].chunk
            assert chunk is not None
            self._room -= chunk.numbers.nbytes
            path = self._write(content or chunk.to_bytes(self.key))
            self._chunks[number] = _Held(chunk, path, self._room >= 0)
            del self._unsaved[number]

    def has(self, digests: Iterable[str]) -> np.ndarray:
        """Whether each scene is there, shape (digests,)."""
        return np.concatenate([self._where.of(some) >= 0 for some in pieces(digests)] or [np.zeros(0, bool)])

    def saved(self, wanted: Iterable[str]) -> int:
        """How many of some scenes are on disk."""
        unsaved = list(self._unsaved)
        where = (self._where.of(some) for some in pieces(wanted))
        return sum(int(((some >= 0) & ~np.isin(some // _SPAN, unsaved)).sum()) for some in where)

    def remove(self) -> None:
        """Delete the parts: the results file has everything."""
        shutil.rmtree(self.folder, ignore_errors=True)

    # What is there

    def __len__(self) -> int:
        return len(self._where)

    def __iter__(self) -> Iterator[str]:
        return iter(self._where)

    def pieces(self) -> Iterator[Sequence[str]]:
        """The digests, some at a time."""
        return self._where.pieces()

    def __contains__(self, digest: object) -> bool:
        return digest in self._where

    def __getitem__(self, digest: str) -> Response:
        ((text, numbers),) = self.take([digest])
        return decode(text, numbers)

    def header(self, digest: str) -> Header:
        """What is known of a response without its numbers."""
        return parse(self.lines([digest])[0][0])

    def lines(self, digests: Iterable[str]) -> tuple[list[str], np.ndarray]:
        """The different header lines of many responses, and of each response the number of its line."""
        found: dict[str, int] = {}
        words = []
        for some in pieces(digests, _AT_ONCE):
            mine = np.empty(len(some), np.int32)
            for held, asked, places in self._by_chunk(self._all_places(some)):
                numbers = np.array([found.setdefault(text, len(found)) for text in held.texts], np.int32)
                mine[asked] = numbers[held.words[places]]
            words.append(mine)
        texts, all_words = list(found), np.concatenate([*words, np.zeros(0, np.int32)])
        used, first = np.unique(all_words, return_index=True)
        order = used[np.argsort(first)]  # as they come first
        place = np.zeros(len(texts), np.int64)
        place[order] = np.arange(len(order))
        return [texts[number] for number in order.tolist()], place[all_words]

    def is_done(self, digests: Iterable[str]) -> np.ndarray:
        """Whether each of many scenes has a result, shape (digests,)."""
        lines, words = self.lines(digests)
        return np.array([parse(line).is_done for line in lines], bool)[words]

    def seconds(self, digests: Collection[str]) -> float:
        """Time of scenes in the solver, all together [s]."""
        found = (self._by_chunk(self._all_places(some)) for some in pieces(digests, _AT_ONCE))
        return float(sum(held.seconds[places].sum() for chunks in found for held, _, places in chunks))

    def storeys(self, digests: Iterable[str]) -> int:
        """Storeys of the tallest building of some scenes."""
        spans = (spans["shear"] for line in self.lines(digests)[0] for spans in parse(line).buildings)
        return max((span.stop - span.start for span in spans), default=0)

    def take(self, digests: Collection[str]) -> list[tuple[str, np.ndarray]]:
        """Header lines and numbers of many responses; every part is read once.

        Raises
        ------
        OSError : a part cannot be read any more, or was damaged since it was written
        """
        found: list[tuple[str, np.ndarray]] = [("", np.zeros(0))] * len(digests)
        for held, asked, places in self._by_chunk(self._all_places(digests)):
            numbers = held.numbers()
            few = len(places) < len(held.words) / _FEW  # that would hold all the numbers of the chunk
            starts = held.starts
            begins, ends = starts[places].tolist(), starts[places + 1].tolist()
            words = held.words[places].tolist()
            for number, word, begin, end in zip(asked.tolist(), words, begins, ends, strict=True):
                row = numbers[begin:end]
                found[number] = held.texts[word], row.copy() if few else row
        return found

    def numbers(self, digests: Iterable[str], sizes: np.ndarray) -> np.ndarray:
        """The numbers of many responses, one after another, shape (sum of `sizes`,); as `take`.

        sizes : how many each has, shape (digests,)
        """
        ends = np.cumsum(sizes)
        found = np.empty(int(ends[-1]) if ends.size else 0)
        for held, asked, places in self._by_chunk(self._all_places(digests)):
            numbers, starts = held.numbers(), held.starts
            parted = np.flatnonzero((np.diff(asked) != 1) | (np.diff(places) != 1)) + 1
            for first, last in zip([0, *parted.tolist()], [*(parted - 1).tolist(), len(asked) - 1], strict=True):
                begin, end = ends[asked[first]] - sizes[asked[first]], ends[asked[last]]
                found[begin:end] = numbers[starts[places[first]] : starts[places[last] + 1]]
        return found

    def alike(self, digests: Iterable[str]) -> list[Alike]:
        """Many responses, those of one header line together; as `take`."""
        found: dict[str, list[tuple[np.ndarray, np.ndarray]]] = {}
        for held, asked, places in self._by_chunk(self._all_places(digests)):
            numbers, words, starts = held.numbers(), held.words[places], held.starts
            for some in runs(words):
                text = held.texts[words[some[0]]]
                values = numbers[starts[places[some], None] + np.arange(parse(text).size)]
                found.setdefault(text, []).append((asked[some], values))
        return [Alike(text, *map(np.concatenate, zip(*each, strict=True))) for text, each in found.items()]

    def _by_chunk(self, where: np.ndarray) -> Iterator[tuple[_Held, np.ndarray, np.ndarray]]:
        """(chunk, which of the scenes it has, their places in it), chunk by chunk; `where`: `_all_places`."""
        chunks, places = np.divmod(where, _SPAN)
        for some in runs(chunks):
            yield self._chunks[chunks[some[0]]], some, places[some]

    def _all_places(self, digests: Iterable[str]) -> np.ndarray:
        """Where scenes stand.  Raises `KeyError`."""
        return np.concatenate([self._places(some) for some in pieces(digests)] or [np.zeros(0, np.int64)])

    def _places(self, digests: Sequence[str]) -> np.ndarray:
        """Where scenes stand.  Raises `KeyError`."""
        found = self._where.of(digests)
        if (found < 0).any():
            raise KeyError(digests[int(np.argmin(found))])
        return found

    def read(self, digests: Iterable[str]) -> Iterator[tuple[str, Response]]:
        """Many responses with their digests; as `take`."""
        for some in pieces(digests):
            for digest, (text, numbers) in zip(some, self.take(some), strict=True):
                yield digest, decode(text, numbers)

    def _join(self, numbers: list[int]) -> None:
        """Make one chunk of several that are in memory only: bringing a file to the disk takes milliseconds."""
        if len(numbers) < 2:
            return
        chunks = [chunk for number in numbers if (chunk := self._chunks[number].chunk) is not None]
        joined, now = Chunk.joined(chunks), len(self._chunks) * _SPAN
        whole = _Held(joined, None)
        self._chunks.append(whole)
        self._unsaved[len(self._chunks) - 1] = b""
        old = [number * _SPAN + np.arange(len(chunk)) for number, chunk in zip(numbers, chunks, strict=True)]
        here = np.flatnonzero(self._where.of(joined.digests) == np.concatenate(old))
        self._where.put([joined.digests[place] for place in here.tolist()], now + here)
        for number in numbers:
            self._chunks[number] = whole  # nothing stands there any more
            del self._unsaved[number]

    def _take_in(self, held: _Held) -> int:
        """Where the scenes of a chunk begin."""
        self._chunks.append(held)
        return (len(self._chunks) - 1) * _SPAN

    def _write(self, content: bytes) -> Path:
        self.folder.mkdir(parents=True, exist_ok=True)
        name = uuid.uuid4().hex
        hidden, path = self.folder / f".{name}.tmp", self.folder / f"{name}.part"
        try:
            with hidden.open("wb") as stream:
                stream.write(content)
                stream.flush()
                os.fsync(stream.fileno())
            hidden.replace(path)
        except OSError:
            hidden.unlink(missing_ok=True)
            raise
        return path


def _content(path: Path) -> bytes:
    with open(open_regular(path), "rb") as stream:
        return stream.read()


class Alike(NamedTuple):
    """Responses of one header line: which ones they are of those that were asked for, shape (responses,), and their
    numbers, shape (responses, numbers of each)."""

    line: str
    which: np.ndarray
    values: np.ndarray


class _Held:
    """A chunk in memory, or where it is on disk; its numbers may be in memory all the same."""

    def __init__(self, chunk: Chunk, path: Path | None, is_held: bool = False) -> None:
        self.path = path
        self.chunk = chunk if path is None else None
        self._numbers = chunk.numbers if path is None or is_held else None
        self.texts, self.seconds = [sys.intern(text) for text in chunk.texts], chunk.seconds
        self.words = chunk.words.astype(np.min_scalar_type(len(chunk.texts)))
        self._sum = deflate.crc32(chunk.numbers.astype("<f8", copy=False).data) if self._numbers is None else 0

    @property
    def starts(self) -> np.ndarray:
        """As those of the chunk: made again, since with a million scenes they take 8 MB."""
        return starts_of(self.texts, self.words)

    def numbers(self) -> np.ndarray:
        """The numbers of all its scenes, one after another."""
        if self._numbers is not None:
            return self._numbers
        assert self.path is not None
        with self.path.open("rb") as stream:
            stream.seek(-8 * int(self.starts[-1]), os.SEEK_END)
            content = stream.read()
        if deflate.crc32(content) != self._sum:
            raise OSError(errno.EIO, "a part was damaged since it was written", str(self.path))
        return np.frombuffer(content, "<f8")
