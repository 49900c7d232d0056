"""Libraries beside what the program does itself: `python -m tests.bench.libraries [FILE.h5]`; the table stands in
docs/dependencies.md. With a results file, what compresses its numbers.

Processor time of one thread (`OPENBLAS_NUM_THREADS=1`), and of SQLite how many damaged bytes it notices."""

from __future__ import annotations

import importlib
import random
import sqlite3
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numba import njit
from scipy.interpolate import PPoly
from scipy.linalg import eigh_tridiagonal, expm

from pounding_cli.kernels.polynomial import first_crossing
from pounding_cli.solve.exponential import RADIANS, series
from pounding_cli.solve.response import DONE, BuildingResponse, LinkResponse, Response
from pounding_cli.store.chunk import Chunk
from pounding_cli.store.parts import PartStore

RESPONSES = 20_000
AT_ONCE = 1000
FLIPS = 40


def cost(work: Callable[[], Any], times: int = 200) -> float:
    """Processor time of a call [us], the least of nine rounds."""
    found = []
    for _ in range(9):
        begin = time.process_time()
        for _ in range(times):
            work()
        found.append((time.process_time() - begin) / times)
    return 1e6 * min(found)


def made_up(count: int) -> dict[str, Response]:
    """Responses of rows of two buildings with ten storeys, by digest."""
    noise = np.random.default_rng(0)
    energy = dict.fromkeys(("input", "kinetic", "stored", "damping", "hysteresis", "links", "residual"), 1.0)

    def one() -> Response:
        buildings = tuple(BuildingResponse(*noise.normal(size=(7, 10))) for _ in range(2))
        links = LinkResponse(*noise.normal(size=(5, 10)))
        return Response(buildings, links, DONE, "", "taylor", 1e-6, 100, 10, 0.01, energy)

    return {f"{number:064x}": one() for number in range(count)}


def parts(folder: Path) -> None:
    """Writing, finding and reading the responses of a run: part files and one SQLite file."""
    responses = made_up(RESPONSES)
    digests = list(responses)
    some = [digests[at : at + AT_ONCE] for at in range(0, len(digests), AT_ONCE)]
    chunks = [Chunk.of({digest: responses[digest] for digest in each}) for each in some]

    def written() -> None:
        store = PartStore(folder / "own.h5", "key")
        for chunk in chunks:
            store.add(chunk)
            store.flush()

    def found() -> PartStore:
        store = PartStore(folder / "own.h5", "key")
        assert store.load() == []
        return store

    print("parts, s   write", _seconds(written), "find", _seconds(found), "read", end=" ")
    store = found()
    print(_seconds(lambda: [store.take(each) for each in some]), "MB", _size(store.folder.iterdir()))

    place = folder / "responses.db"
    with sqlite3.connect(place) as base:
        base.execute("create table response (digest text primary key, line text, numbers blob)")

    def inserted() -> None:
        for chunk in chunks:
            named = zip(chunk.digests, chunk.lines, strict=True)
            rows = ((d, line, chunk.row(n).tobytes()) for n, (d, line) in enumerate(named))
            with sqlite3.connect(place) as base:
                base.executemany("insert into response values (?, ?, ?)", rows)

    def checked() -> bool:
        with sqlite3.connect(place) as base:
            base.execute("select digest from response").fetchall()
            return base.execute("pragma integrity_check").fetchone() == ("ok",)

    def read(each: list[str]) -> list[tuple[str, bytes]]:
        asked = ",".join("?" * len(each))
        with sqlite3.connect(place) as base:
            return base.execute(f"select digest, numbers from response where digest in ({asked})", each).fetchall()

    print("SQLite, s  write", _seconds(inserted), "find", _seconds(checked), "read", end=" ")
    print(_seconds(lambda: [read(each) for each in some]), "MB", _size([place]))
    right = {digest: numbers for each in some for digest, numbers in read(each)}
    whole, unseen = place.read_bytes(), 0
    random.seed(1)
    for _ in range(FLIPS):
        damaged = bytearray(whole)
        damaged[random.randrange(len(damaged))] ^= 0xFF
        place.write_bytes(damaged)
        try:
            unseen += checked() and any(right.get(d) != n for each in some for d, n in read(each))
        except sqlite3.DatabaseError:
            continue
    print(f"SQLite: {unseen} of {FLIPS} damaged bytes change numbers and pass its check")


def _seconds(work: Callable[[], Any]) -> str:
    begin = time.process_time()
    work()
    return f"{time.process_time() - begin:.2f}"


def _size(paths: Any) -> str:
    return f"{sum(path.stat().st_size for path in paths) / 1e6:.0f}"


@njit
def _crossings(coefficients, order, found):
    for row in range(len(coefficients)):
        found[row] = first_crossing(coefficients[row], order, 1.0)


def mathematics() -> None:
    """Matrix exponentials, frequencies and first sign changes: ours and SciPy's [us]."""
    noise = np.random.default_rng(0)
    for storeys in (2, 5, 10):
        size = 2 * storeys
        shape = noise.normal(size=(size, size))
        stiffness = shape @ shape.T
        a = np.zeros((2 * size + 2, 2 * size + 2))
        a[:size, size : 2 * size], a[size : 2 * size, :size] = np.eye(size), -stiffness
        a *= RADIANS / np.sqrt(np.linalg.eigvalsh(stiffness)[-1])
        print(f"exp, {len(a)} rows: {cost(lambda a=a: series(a)):.0f}, expm {cost(lambda a=a: expm(a)):.0f}")
    for storeys in (5, 20, 50):
        diagonal, beside = 2 + noise.random(storeys), -noise.random(storeys - 1)

        def whole(d: np.ndarray = diagonal, b: np.ndarray = beside) -> np.ndarray:
            return np.linalg.eigvalsh(np.diag(d) + np.diag(b, -1))

        def tridiagonal(d: np.ndarray = diagonal, b: np.ndarray = beside) -> np.ndarray:
            return eigh_tridiagonal(d, b, eigvals_only=True)

        print(f"frequencies, {storeys} storeys: {cost(whole):.0f}, eigh_tridiagonal {cost(tridiagonal):.0f}")
    order, count = 20, 10_000
    coefficients = noise.normal(size=(count, order + 1)) * 0.5 ** np.arange(order + 1)
    coefficients[:, 0] = abs(coefficients[:, 0])
    found = np.zeros(count)
    _crossings(coefficients, order, found)
    own = cost(lambda: _crossings(coefficients, order, found), 1) / count
    first = [PPoly(c[::-1, None], [0.0, 1.0], extrapolate=False) for c in coefficients[:300]]
    theirs = cost(lambda: [each.roots() for each in first], 1) / len(first)
    roots = [min(each.roots(), default=2.0) for each in first]
    assert np.allclose(np.minimum(found[: len(first)], 2.0), roots, atol=1e-9)
    print(f"first crossing, order {order}: {own:.2f}, PPoly {theirs:.0f}")
    for module in ("scipy.linalg", "scipy.interpolate", "sqlite3"):
        text = f"import time, numpy; a = time.process_time(); import {module}; print(time.process_time() - a)"
        done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, check=True)
        print(f"import {module}: {float(done.stdout):.2f} s")


def compression(path: Path) -> None:
    """The large arrays of a results file, byte by byte as the file holds them, compressed a megabyte at a time."""
    with h5py.File(path) as file:
        found: list[np.ndarray] = []
        file.visititems(lambda _, item: found.append(item[()].ravel()) if _is_large(item) else None)
    pieces = [each[at : at + (1 << 17)] for each in found for at in range(0, each.size, 1 << 17)]
    planes = [np.ascontiguousarray(each.view(np.uint8).reshape(-1, 8).T).tobytes() for each in pieces]
    print(f"{sum(map(len, planes)) / 1e6:.2f} MB of numbers")
    for name, levels in (("zlib", (1, 4)), ("isal.isal_zlib", (1, 2, 3)), ("zlib_ng.zlib_ng", (1, 2))):
        try:
            library: Any = importlib.import_module(name)
        except ImportError:
            print(f"{name}: not installed")
            continue
        for level in levels:
            size = sum(len(library.compress(each, level)) for each in planes)
            spent = cost(lambda library=library, level=level: [library.compress(each, level) for each in planes], 1)
            print(f"{name}, level {level}: {spent / 1e3:.0f} ms, {size / 1e6:.2f} MB")


def _is_large(item: Any) -> bool:
    return isinstance(item, h5py.Dataset) and item.dtype.kind in "fi" and item.nbytes > 1 << 15


if __name__ == "__main__":
    for given in sys.argv[1:]:
        compression(Path(given))
    mathematics()
    with tempfile.TemporaryDirectory() as folder:
        parts(Path(folder))
