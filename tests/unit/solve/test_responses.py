"""Runs that are read together: each gives what it gives by itself, whatever the others came to."""

from __future__ import annotations

import dataclasses

import numpy as np

from pounding_cli.model.scene import Analysis, Scene
from pounding_cli.solve.read import read
from pounding_cli.solve.response import Response
from pounding_cli.solve.run import Prepared, prepare
from pounding_cli.store.codec import encode
from tests.helpers.five_storeys import motion, pair, pounding


def runs() -> list[Prepared]:
    """Of three layouts: elastic and inelastic with gaps that differ, one of them ended after a few steps, and one
    building alone."""
    both = pair()
    scenes = [
        Scene(both, pounding(both, gap), motion(), analysis)
        for analysis in (Analysis.ELASTIC, Analysis.INELASTIC)
        for gap in (0.0, 0.005, 0.01)
    ]
    prepared = [prepare(scene) for scene in (*scenes, Scene(both[:1], (), motion(), Analysis.ELASTIC))]
    prepared[1].bounds = (10, 10)
    for run in prepared:
        run.integrate()
    return prepared


def said(response: Response) -> tuple[str, bytes]:
    """All that is kept of a response but the time it took, and its end state."""
    words, numbers = encode(dataclasses.replace(response, seconds=0.0))
    return words, numbers.tobytes() + b"".join(each.tobytes() for pair in response.final for each in pair)


def test_runs_read_together_are_what_they_are_alone():
    """Bit for bit. Fails if rows are mixed up, or summed in another order."""
    together = [one.response() for one in read(runs())]
    for one, other in zip(together, [run.response() for run in runs()], strict=True):
        assert said(one) == said(other)
    peaks = [response.buildings[0].shear.max() for response in together]
    assert len({*peaks[:1], *peaks[2:]}) == 6  # all but the one that was stopped say something of their own


def test_a_run_that_fails_shows_no_number_and_takes_none_from_others():
    together = [one.response() for one in read(runs())]
    assert [response.status for response in together] == ["done", "step bound reached", *["done"] * 5]
    for response in together:
        numbers = np.concatenate([*(b.shear for b in response.buildings), *response.final[0], response.links.impulse])
        assert np.isnan(numbers).all() == (response.status != "done")
        assert np.isfinite(numbers).all() == (response.status == "done")
