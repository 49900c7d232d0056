"""Points of a model of its own as the engines solve them: what is kept of a response, and what becomes of a failure."""

from __future__ import annotations

from dataclasses import dataclass, field
from types import SimpleNamespace

import numpy as np
import pytest

from pounding_cli import workflows
from pounding_cli.batch.point_task import PointTask
from pounding_cli.errors import InputError, Problem
from pounding_cli.store.chunk import Chunk
from pounding_cli.store.codec import decode
from pounding_cli.variables import Variable


@dataclass(frozen=True)
class Model:
    place: int


@dataclass(frozen=True)
class Answer:
    number: float
    part: SimpleNamespace
    flags: tuple[str, ...] = field(default=("a flag, of μ",))


VARIABLES = (
    Variable("number", (), "1", "a number"),
    Variable("grid", ("row", "column"), "m", "numbers", of="part.grid"),
    Variable("place", (), "1", "of the model", of="model.place"),
)


def answer(model: Model) -> Answer:
    if model.place == 9:
        raise InputError(Problem("too many steps", "write a larger step"))
    if model.place == 8:
        raise ZeroDivisionError("by nothing")
    return Answer(
        np.nan if model.place == 0 else 1.5, SimpleNamespace(grid=np.arange(6.0).reshape(2, 3)[:, : model.place])
    )


@pytest.fixture
def task(monkeypatch):
    parts = {"solve": answer, "variables": VARIABLES}
    mine = SimpleNamespace(part=parts.get, solve="mine:answer")
    monkeypatch.setattr("pounding_cli.batch.point_task.WORKFLOWS", {"mine": mine})
    assert "mine" not in workflows.WORKFLOWS
    return PointTask("mine")


def test_what_the_variables_name_is_kept_bit_for_bit(task):
    """Fails if an array comes back in another shape, or a variable is read from another place."""
    models = {f"{n:064x}": Model(n) for n in (0, 2, 3)}
    solved = dict(zip(models, task.each(list(models.values()), lambda _: None, lambda: False), strict=True))
    chunk = Chunk.from_bytes(Chunk.of(solved).to_bytes("key"), "key")
    for place, (digest, model) in enumerate(models.items()):
        found = decode(chunk.lines[place], chunk.row(place))
        assert (found.status, found.flags) == ("done", ("a flag, of μ",))
        assert found.seconds == solved[digest].seconds
        assert found.values["grid"].tolist() == np.arange(6.0).reshape(2, 3)[:, : model.place].tolist()
        assert found.values["place"] == model.place
        assert found.values["number"].tobytes() == np.array(np.nan if model.place == 0 else 1.5).tobytes()


def test_a_point_that_fails_says_why_and_leaves_the_others(task):
    begun = []
    found = task.each([Model(9), Model(8), Model(1)], begun.append, lambda: False)
    assert [each.status for each in found] == [
        "refused: too many steps", "error: ZeroDivisionError: by nothing", "done"
    ]  # fmt: skip
    assert found[0].advice == "write a larger step"
    assert not found[0].values
    assert begun == [0, 1, 2]
    assert Chunk.of(dict(zip("abc", found, strict=True))).is_done.tolist() == [False, False, True]


def test_a_bundle_that_takes_too_long_is_given_back(task):
    assert len(task.each([Model(1)] * 3, lambda _: None, lambda: True)) == 1
