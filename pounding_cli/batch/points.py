"""Points of a sweep of a model of its own, such as the wall: solved side by side, each kept until all are done."""

from __future__ import annotations

import hashlib
import io
import shutil
import signal
import uuid
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import fields, is_dataclass
from functools import partial
from pathlib import Path
from typing import Any, TypeVar, get_type_hints

import numpy as np

from pounding_cli.batch.runner import cores
from pounding_cli.errors import InputError, Problem
from pounding_cli.store.keys import solver_version

M = TypeVar("M")
R = TypeVar("R")
Solve = Callable[[Callable[[M], R], Sequence[M]], Iterable[R]]
"""As `map`: (what solves a model, models) -> responses in their order."""

_SHA = hashlib.sha256().digest_size


@contextmanager
def kept_points(path: Path, kind: type[R], packages: tuple[str, ...], workers: int | None = None) -> Iterator[Solve]:
    """What solves points in place of `map`, and goes on where a former run was stopped.

    Parameters
    ----------
    path : the results file; solved points are kept in `FILE.h5.parts` and removed once it is whole
    kind : dataclass of a response: of numbers, texts, arrays and dataclasses of these
    packages : folders of this package that solve a point; where they have changed nothing is taken over
    workers : points side by side; the cores of this machine unless given

    Raises
    ------
    InputError : points cannot be kept, or a worker died
    """
    folder = path.with_name(path.name + ".parts")
    made_by = solver_version(packages)

    def solve(work: Callable[[M], R], models: Sequence[M]) -> Iterator[R]:
        places = [folder / f"{hashlib.sha256(f'{made_by} {model!r}'.encode()).hexdigest()}.point" for model in models]
        missing = {place: model for place, model in zip(places, models, strict=True) if _read(place, kind) is None}
        side = min(workers or cores(), len(missing))
        try:
            folder.mkdir(parents=True, exist_ok=True)
            with _pool(side) as submit:
                waiting = {place: submit(_solve, work, model, place) for place, model in missing.items()}
                for place, model in zip(places, models, strict=True):
                    found = None if place in waiting else _read(place, kind)
                    yield waiting.get(place, partial(work, model))() if found is None else found
        except BrokenProcessPool:
            hint = "run it again: what is solved is kept; --workers 1 takes least memory"
            raise InputError(Problem("a worker died", hint)) from None
        except OSError as error:
            what = f"cannot write {folder}: {error.strerror or error}"
            raise InputError(Problem(what, "name another file with -o FILE.h5")) from error

    yield solve
    shutil.rmtree(folder, ignore_errors=True)


@contextmanager
def _pool(workers: int) -> Iterator[Callable[..., Callable[[], Any]]]:
    """What takes a task and gives a function that returns its result: one that works then and there, or waits."""
    if workers < 2:
        yield partial(partial, _called)
        return
    with ProcessPoolExecutor(workers, initializer=_leave_ctrl_c) as pool:
        try:
            yield lambda *task: pool.submit(*task).result
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


def _called(work: Callable[..., R], *arguments: Any) -> R:
    return work(*arguments)


def _leave_ctrl_c() -> None:
    """Ctrl-C is for the main process; a worker ends its point, which is kept."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _solve(work: Callable[[M], R], model: M, place: Path) -> R:
    """Solve a model and keep its response: SHA-256, then arrays by name."""
    response = work(model)
    content = io.BytesIO()
    np.savez_compressed(content, **dict[str, Any](_taken_apart(response)))
    hidden = place.with_name(f".{uuid.uuid4().hex}.tmp")
    try:
        hidden.write_bytes(hashlib.sha256(content.getbuffer()).digest() + content.getbuffer())
        hidden.replace(place)
    finally:
        hidden.unlink(missing_ok=True)
    return response


def _read(place: Path, kind: type[R]) -> R | None:
    """The response kept there; None where there is none, or a damaged one."""
    try:
        whole = place.read_bytes()
    except OSError:
        return None
    if hashlib.sha256(whole[_SHA:]).digest() != whole[:_SHA]:
        return None
    with np.load(io.BytesIO(whole[_SHA:])) as arrays:
        return _put_together(kind, arrays, "")


def _taken_apart(response: Any, before: str = "") -> Iterator[tuple[str, np.ndarray]]:
    for each in fields(response):
        value = getattr(response, each.name)
        if is_dataclass(value):
            yield from _taken_apart(value, f"{before}{each.name}.")
        else:
            yield before + each.name, np.array(value, dtype=str) if isinstance(value, tuple) else np.asarray(value)


def _put_together(kind: Any, arrays: Mapping[str, np.ndarray], before: str) -> Any:
    found: dict[str, Any] = {}
    for name, form in get_type_hints(kind).items():
        if is_dataclass(form):
            found[name] = _put_together(form, arrays, f"{before}{name}.")
        elif form is np.ndarray:
            found[name] = arrays[before + name]
        else:
            value = arrays[before + name].tolist()
            found[name] = tuple(value) if isinstance(value, list) else value
    return kind(**found)
