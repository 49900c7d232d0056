"""Fixtures of the verification tests."""

from __future__ import annotations

import functools

import pytest

from pounding_cli.model.scene import Scene
from pounding_cli.solve import solve
from pounding_cli.solve.method import is_linear


def _exactly(scene: Scene, *arguments, **settings):
    return solve(scene, *arguments, method="exponential" if is_linear(scene) else "taylor", **settings)


@pytest.fixture(params=["exponential", "taylor"])
def exact_steps_and_series(request, monkeypatch):
    """Runs the tests of a module twice: with exact steps where a scene is linear, and with series throughout."""
    by = {"exponential": _exactly, "taylor": functools.partial(solve, method="taylor")}
    monkeypatch.setattr(request.module, "solve", by[request.param])
