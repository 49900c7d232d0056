"""The group `/solutions` of a results file: every scene's response under its digest, kept for reuse."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from itertools import chain
from pathlib import Path

import h5py
import numpy as np

from pounding_cli.digests import pieces
from pounding_cli.errors import InputError
from pounding_cli.model.placed import among
from pounding_cli.model.scene import Scene
from pounding_cli.store import packed
from pounding_cli.store.chunk import Chunk
from pounding_cli.store.codec import parse
from pounding_cli.store.files import opened
from pounding_cli.store.parts import PartStore

_SCENES = 4096
"""Scenes written or read at a time."""

_DIGESTS = 1 << 14
"""Digests in one compressed piece of the file."""

_NUMBERS = 1 << 15
"""Numbers in one compressed piece of the file."""


def write_solutions(file: h5py.File, scenes: Mapping[str, Scene], responses: PartStore) -> None:
    """Write `digest`, `line` (distinct headers, JSON), `words` (line of each scene), `numbers` (scene after scene).

    First come the scenes of the study; then what else `responses` has: scenes the study had before.
    """
    others: list[str] = []
    for some in responses.pieces():
        left = np.flatnonzero(~among(scenes, some))
        if left.size:
            others += np.array(some[:], object)[left].tolist()
    count = len(scenes) + len(others)

    def digests() -> Iterable[str]:
        return chain(scenes, others) if others else scenes

    group = file.create_group("solutions")
    group.attrs["long_name"] = "responses by scene digest, linked scenes and buildings alone; kept for reuse"
    size = min(count, _DIGESTS)
    stored = packed.create(group, "digest", (count,), np.dtype("S64"), (size,))
    for number, some in enumerate(pieces(digests(), size)):
        packed.put(stored, (number * size,), np.array(some[:], "S64"))
    lines, words = responses.lines(digests())
    group.create_dataset("line", data=lines, dtype=h5py.string_dtype())
    packed.write(group, "words", words)
    sizes = np.array([parse(line).size for line in lines], np.int64)
    total = int(np.bincount(words, minlength=len(lines)) @ sizes)
    size = min(total, _NUMBERS)
    numbers = packed.create(group, "numbers", (total,), np.dtype(float), (size,))
    packed.put(numbers, (0,), np.zeros(size))  # now HDF5 makes the index: damage of other pieces then does not reach it
    for number, piece in enumerate(_pieces(digests(), responses, sizes, words, size)):
        packed.put(numbers, (number * size,), piece)


def _pieces(
    digests: Iterable[str], responses: PartStore, sizes: np.ndarray, words: np.ndarray, size: int
) -> Iterator[np.ndarray]:
    """The numbers of scene after scene, `size` at a time; `sizes`: how many there are with a header line of a number,
    `words`: the header line of each scene."""
    left, done = np.zeros(0), 0
    for some in pieces(digests, _SCENES):
        each, done = sizes[words[done : done + len(some)]], done + len(some)
        left = np.concatenate([left, responses.numbers(some, each)])
        whole = left.size // size * size
        yield from left[:whole].reshape(-1, size)
        left = left[whole:]
    if left.size:
        yield left


def stored_chunks(path: Path, key: str) -> Iterator[Chunk]:
    """The responses that are done, some at a time, if `path` is a results file with this `solution_key`.

    Those that are damaged are left out.
    """
    try:
        with opened(path) as file:
            if file.attrs["solution_key"] != key:
                return
            group = file["solutions"]
            digests, lines, words = group["digest"][:], list(group["line"].asstr()[:]), group["words"][:]
            sizes = np.array([parse(line).size for line in lines])[words]
            starts = np.cumsum([0, *sizes])
            for begin in range(0, len(digests), _SCENES):
                for first, last, numbers in _sound(group["numbers"], starts, begin, min(begin + _SCENES, len(digests))):
                    some = [digest.decode() for digest in digests[first:last]]
                    chunk = Chunk.saying(some, lines, words[first:last], numbers)
                    good = np.flatnonzero(chunk.is_done)
                    yield chunk if len(good) == len(some) else chunk.only(good.tolist())
    except (InputError, OSError, KeyError, ValueError, TypeError, IndexError):
        return  # nothing more that can be used again


def _sound(numbers: h5py.Dataset, starts: np.ndarray, first: int, last: int) -> Iterator[tuple[int, int, np.ndarray]]:
    """Scenes from `first` to before `last` with their numbers, without those that cannot be read."""
    try:
        yield first, last, numbers[starts[first] : starts[last]]
    except OSError:
        if last - first > 1:
            middle = (first + last) // 2
            yield from _sound(numbers, starts, first, middle)
            yield from _sound(numbers, starts, middle, last)


def stored_methods(file: h5py.File) -> tuple[str, ...]:
    """Keys in METHODS of the methods that solved the scenes of a study, buildings alone included."""
    used = np.unique(file["solutions/words"][: int(file.attrs["scenes"])])
    lines = [parse(line) for line in file["solutions/line"].asstr()[:][used]]
    return tuple(sorted({line.facts["method"] for line in lines if line.is_done}))
