"""The group `/solutions` of a results file: every scene's response under its digest, kept for reuse."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import h5py
import numpy as np

from pounding_cli.errors import InputError
from pounding_cli.solve.response import methods_in
from pounding_cli.store.chunk import Chunk
from pounding_cli.store.codec import parse
from pounding_cli.store.files import opened
from pounding_cli.store.parts import PartStore

_SCENES = 4096
"""Scenes written or read at a time."""

_NUMBERS = 1 << 15
"""Numbers in one compressed piece of the file."""


def write_solutions(file: h5py.File, digests: Sequence[str], responses: PartStore) -> None:
    """Write `digest`, `line` (distinct words, JSON), `words` (line of each scene), `numbers` (scene after scene)."""
    group = file.create_group("solutions")
    group.attrs["long_name"] = "responses by scene digest, linked scenes and buildings alone; kept for reuse"
    group["digest"] = np.array(digests, dtype="S64")
    lines: dict[str, int] = {}
    words = np.array([lines.setdefault(responses.line(digest), len(lines)) for digest in digests], np.int64)
    group.create_dataset("line", data=list(lines), dtype=h5py.string_dtype())
    packed = {"compression": "gzip", "compression_opts": 1, "shuffle": True}
    group.create_dataset("words", data=words, **packed)
    total = sum(responses.words(digest).size for digest in digests)
    numbers = group.create_dataset("numbers", (total,), np.float64, chunks=(min(total, _NUMBERS),), **packed)
    end = 0
    for begin in range(0, len(digests), _SCENES):
        piece = np.concatenate([row for _, row in responses.take(digests[begin : begin + _SCENES])])
        numbers[end : end + piece.size] = piece
        end += piece.size


def stored_chunks(path: Path, key: str, wanted: Mapping[str, object]) -> Iterator[Chunk]:
    """The wanted responses that are done, some at a time, if `path` is a results file with this `solution_key`."""
    try:
        with opened(path) as file:
            if file.attrs["solution_key"] != key:
                return
            group = file["solutions"]
            digests, lines, words = group["digest"][:], list(group["line"].asstr()[:]), group["words"][:]
            end = 0
            for begin in range(0, len(digests), _SCENES):
                some = [digest.decode() for digest in digests[begin : begin + _SCENES]]
                chunk = Chunk(some, [lines[place] for place in words[begin : begin + _SCENES]], np.zeros(0))
                start, end = end, end + int(chunk.starts[-1])
                chunk = Chunk(some, chunk.words, group["numbers"][start:end])
                good = [n for n, done in enumerate(chunk.is_done) if done and some[n] in wanted]
                yield chunk if len(good) == len(some) else chunk.only(good)
    except (InputError, OSError, KeyError, ValueError, TypeError, IndexError):
        return  # nothing that can be reused


def stored_methods(file: h5py.File) -> tuple[str, ...]:
    """Keys in METHODS of the methods that solved the scenes of a results file, buildings alone included."""
    lines = [parse(line) for line in file["solutions/line"].asstr()[:]]
    return tuple(sorted({name for line in lines if line.is_done for name in methods_in(line.facts["method"])}))
