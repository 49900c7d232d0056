"""The responses of a run: in memory while they are few, else in `FILE.h5.parts/`, each part whole or not there."""

from __future__ import annotations

import contextlib
import os
import shutil
import uuid
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from pounding_cli.solve.response import Response
from pounding_cli.store.chunk import Chunk
from pounding_cli.store.codec import Words, decode, parse

_SPAN = 1 << 24
"""More than the scenes of one chunk."""


class PartStore(Mapping[str, Response]):
    """Responses by scene digest; a run that was stopped goes on from its parts.

    Only where each response stands is held in memory once the chunks are on disk.

    Parameters
    ----------
    output : the results file the parts belong to
    key : `solution_key`; parts with another key are not read
    """

    def __init__(self, output: Path, key: str) -> None:
        self.folder = output.with_name(output.name + ".parts")
        self.key = key
        self._chunks: list[_Held] = []
        self._unsaved: dict[int, bytes] = {}
        self._where: dict[str, int] = {}

    @classmethod
    def of(cls, responses: Mapping[str, Response]) -> PartStore:
        """Responses at hand, in memory."""
        store = cls(Path("-"), "")
        store.add(Chunk.of(responses))
        return store

    def load(self, wanted: Mapping[str, object]) -> int:
        """Find the wanted scenes that are done in the parts on disk; how many there are.

        A part that is damaged or of another key is passed over.
        """
        for path in sorted(self.folder.glob("*.part")):
            with contextlib.suppress(OSError, ValueError, KeyError, TypeError, IndexError):
                chunk = Chunk.from_bytes(path.read_bytes(), self.key)
                if chunk is not None:
                    good = [d in wanted and done for d, done in zip(chunk.digests, chunk.is_done, strict=True)]
                    self._note(_Held(chunk, path), chunk.digests, good)
        return len(self)

    def add(self, chunk: Chunk, content: bytes = b"") -> None:
        """Take a chunk in, for now in memory; `content`: its bytes, where they are at hand."""
        if len(chunk):
            self._unsaved[len(self._chunks)] = content
            self._note(_Held(chunk, None), chunk.digests, [True] * len(chunk))

    def flush(self) -> None:
        """Bring to disk what is in memory only.

        Raises
        ------
        OSError : the disk is full, or the folder cannot be written; no part is left half written
        """
        for number, content in list(self._unsaved.items()):
            chunk = self._chunks[number].chunk
            assert chunk is not None
            self._chunks[number] = _Held(chunk, self._write(content or chunk.to_bytes(self.key)))
            del self._unsaved[number]

    @property
    def saved(self) -> int:
        """Scenes that are on disk."""
        return len(self) - sum(len(self._chunks[number].words) for number in self._unsaved)

    def remove(self) -> None:
        """Delete the parts: the results file has everything."""
        shutil.rmtree(self.folder, ignore_errors=True)

    # What is there

    def __len__(self) -> int:
        return len(self._where)

    def __iter__(self) -> Iterator[str]:
        return iter(self._where)

    def __contains__(self, digest: object) -> bool:
        return digest in self._where

    def __getitem__(self, digest: str) -> Response:
        ((text, numbers),) = self.take([digest])
        return decode(text, numbers)

    def line(self, digest: str) -> str:
        """The words of a response as they are written."""
        chunk, place = divmod(self._where[digest], _SPAN)
        return self._chunks[chunk].words[place]

    def words(self, digest: str) -> Words:
        """What is known of a response without its numbers."""
        return parse(self.line(digest))

    def seconds(self, digest: str) -> float:
        """Time of a scene in the solver [s]."""
        chunk, place = divmod(self._where[digest], _SPAN)
        return float(self._chunks[chunk].seconds[place])

    @property
    def storeys(self) -> int:
        """Storeys of the tallest building."""
        lines = {line for held in self._chunks for line in held.words}
        spans = (spans["shear"] for line in lines for spans in parse(line).buildings)
        return max((span.stop - span.start for span in spans), default=0)

    def take(self, digests: Sequence[str]) -> list[tuple[str, np.ndarray]]:
        """Words and numbers of many responses; every part is read once."""
        by_chunk: dict[int, list[int]] = {}
        for number, digest in enumerate(digests):
            by_chunk.setdefault(self._where[digest] // _SPAN, []).append(number)
        found: list[tuple[str, np.ndarray]] = [("", np.zeros(0))] * len(digests)
        for chunk, asked in sorted(by_chunk.items()):
            held = self._chunks[chunk]
            numbers = held.numbers()
            for number in asked:
                place = self._where[digests[number]] % _SPAN
                row = numbers[held.starts[place] : held.starts[place + 1]]
                found[number] = held.words[place], row.copy()
        return found

    def _note(self, held: _Held, digests: Sequence[str], good: Iterable[bool]) -> None:
        number = len(self._chunks) * _SPAN
        self._chunks.append(held)
        for place, (digest, is_good) in enumerate(zip(digests, good, strict=True)):
            if is_good:
                self._where[digest] = number + place

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


class _Held:
    """A chunk in memory, or where it is on disk."""

    def __init__(self, chunk: Chunk, path: Path | None) -> None:
        self.path = path
        self.chunk = chunk if path is None else None
        self.words, self.starts, self.seconds = chunk.words, chunk.starts, chunk.seconds

    def numbers(self) -> np.ndarray:
        """The numbers of all its scenes, one after another."""
        if self.chunk is not None:
            return self.chunk.numbers
        assert self.path is not None
        with self.path.open("rb") as stream:
            stream.seek(-8 * int(self.starts[-1]), os.SEEK_END)
            return np.frombuffer(stream.read(), "<f8")
