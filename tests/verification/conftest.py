"""Fixtures of the verification tests."""

from __future__ import annotations

import functools

import pytest

from pounding_cli.solve import solve


@pytest.fixture(params=["auto", "taylor"])
def exact_steps_and_series(request, monkeypatch):
    """Runs the tests of a module twice: `auto` takes exact steps where a scene is linear, `taylor` never does."""
    monkeypatch.setattr(request.module, "solve", functools.partial(solve, method=request.param))
