"""Points of a sweep solved side by side, kept until the results file is whole."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from pounding_cli.batch.points import kept_points
from pounding_cli.errors import InputError, Problem


@dataclass(frozen=True)
class Part:
    values: np.ndarray


@dataclass(frozen=True)
class Answer:
    number: float
    count: int
    texts: tuple[str, ...]
    part: Part
    process: int


@dataclass(frozen=True)
class Model:
    place: int
    folder: str


def answer(model: Model) -> Answer:
    """Leaves a trace of every call."""
    with (Path(model.folder) / f"calls-{model.place}").open("a") as calls:
        calls.write("x")
    if model.place == 9:
        raise InputError(Problem("too many steps", "write a larger step", "wall.yaml", 3, 1))
    if model.place == 8:
        os._exit(1)
    texts = ("a flag, of μ",) * model.place
    number = np.nan if model.place == 0 else 1.5
    return Answer(number, model.place, texts, Part(np.arange(3.0) * model.place), os.getpid())


def calls(folder: Path) -> list[int]:
    """How often each point was solved."""
    return [path.stat().st_size for path in sorted(folder.glob("calls-*"))]


def solved(folder: Path, workers: int, models: list[Model], stop_after: int = 99) -> list[Answer]:
    """The answers in order; after `stop_after` of them Ctrl-C is pressed."""
    found = []
    with kept_points(folder / "r.h5", Answer, ("wall",), workers) as solve:
        for each in solve(answer, models):
            found.append(each)
            if len(found) == stop_after:
                raise KeyboardInterrupt
    return found


@pytest.mark.parametrize("workers", [1, 2])
def test_answers_come_in_order_and_leave_nothing(tmp_path, workers):
    models = [Model(place, str(tmp_path)) for place in (2, 0, 1, 2)]
    found = solved(tmp_path, workers, models)
    assert [each.count for each in found] == [2, 0, 1, 2]
    assert [each.texts for each in found] == [("a flag, of μ",) * n for n in (2, 0, 1, 2)]
    assert [each.part.values[2] for each in found] == [4.0, 0.0, 2.0, 4.0]
    assert ({each.process for each in found} == {os.getpid()}) == (workers == 1)
    assert not (tmp_path / "r.h5.parts").exists()


@pytest.mark.parametrize("workers", [1, 2])
def test_a_stopped_sweep_goes_on(tmp_path, workers):
    models = [Model(place, str(tmp_path)) for place in range(4)]
    with pytest.raises(KeyboardInterrupt):
        solved(tmp_path, workers, models, stop_after=2)
    assert sum(calls(tmp_path)) >= 2
    found = solved(tmp_path, workers, models)
    assert [each.count for each in found] == [0, 1, 2, 3]
    assert np.isnan(found[0].number)
    assert found[3].texts == ("a flag, of μ",) * 3
    assert found[3].part.values.tolist() == [0.0, 3.0, 6.0]
    assert calls(tmp_path) == [1, 1, 1, 1]


def test_a_damaged_point_is_solved_again(tmp_path):
    models = [Model(place, str(tmp_path)) for place in range(3)]
    with pytest.raises(KeyboardInterrupt):
        solved(tmp_path, 1, models, stop_after=2)
    first = min((tmp_path / "r.h5.parts").glob("*.point"), key=lambda path: path.stat().st_mtime_ns)
    content = bytearray(first.read_bytes())
    content[len(content) // 2] ^= 1
    first.write_bytes(content)
    assert [each.count for each in solved(tmp_path, 1, models)] == [0, 1, 2]
    assert calls(tmp_path) == [2, 1, 1]


@pytest.mark.parametrize("workers", [1, 2])
def test_what_a_point_is_refused_for_is_told_whole(tmp_path, workers):
    with pytest.raises(InputError) as refused:
        solved(tmp_path, workers, [Model(place, str(tmp_path)) for place in (0, 9)])
    assert refused.value.problems == (Problem("too many steps", "write a larger step", "wall.yaml", 3, 1),)
    assert len(list((tmp_path / "r.h5.parts").glob("*.point"))) == 1


def test_a_worker_that_dies_is_told(tmp_path):
    with pytest.raises(InputError, match="a worker died"):
        solved(tmp_path, 2, [Model(place, str(tmp_path)) for place in (0, 8)])


def test_points_that_cannot_be_kept_are_told(tmp_path):
    (tmp_path / "r.h5.parts").write_text("in the way")
    with pytest.raises(InputError, match=r"cannot write .*parts"):
        solved(tmp_path, 1, [Model(0, str(tmp_path))])
