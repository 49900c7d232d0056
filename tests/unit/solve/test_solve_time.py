"""`Response.seconds` counts solving, not the compiling or loading of a kernel."""

from __future__ import annotations

import dataclasses
import time

from pounding_cli.methods import METHODS
from pounding_cli.model.scene import Analysis, Scene
from pounding_cli.solve import solve
from pounding_cli.solve.method import Integrator, integrator_of
from tests.helpers.five_storeys import motion, pair


def test_the_first_call_of_a_kernel_is_not_timed(monkeypatch):
    taylor, calls = integrator_of(METHODS["taylor"]), []

    def slow_at_first(scene, *arguments):
        calls.append(scene)
        if len(calls) == 1:
            time.sleep(0.5)  # as compiling does
        return taylor.integrate(scene, *arguments)

    fresh = dataclasses.replace(METHODS["taylor"], name="fresh", code=Integrator(slow_at_first))
    monkeypatch.setitem(METHODS, "fresh", fresh)
    scene = Scene((pair()[0],), (), motion(), Analysis.ELASTIC)
    solve(scene)  # the real kernel is loaded by now
    assert solve(scene, method="fresh").seconds < 0.25
    assert len(calls) == 2
    solve(scene, method="fresh")
    assert len(calls) == 3
