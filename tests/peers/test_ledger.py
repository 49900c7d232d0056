"""The energy ledger against the work integrals of the event-located reference, entry by entry."""

from __future__ import annotations

import pytest
from reference import events
from reference.scenes import FOUNDATION, INELASTIC, pair, shake

from pounding_cli.solve import solve


@pytest.mark.parametrize("foundation", [None, FOUNDATION])
@pytest.mark.parametrize(("kind", "gap"), [("pounding", 0.002), ("infill", 0.01), ("connector", 0.05)])
def test_every_entry(kind, gap, foundation):
    """Yielding, in contact, on soft ground. Fails if an entry has the wrong sign or a dashpot is left out."""
    scene = pair(kind, gap, shake(0.5, 6.0), INELASTIC, foundation)
    work, book = events.integrate(scene).energy, solve(scene, 1e-12).energy
    size = work["input"]
    assert book["input"] == pytest.approx(size, rel=1e-8)
    assert book["kinetic"] == pytest.approx(work["kinetic"], abs=1e-8 * size)
    assert book["damping"] == pytest.approx(work["damping"], abs=1e-8 * size)
    assert book["stored"] + book["hysteresis"] == pytest.approx(work["storeys"] + work["springs"], abs=1e-8 * size)
    assert book["links"] + book["links_stored"] == pytest.approx(work["links"], abs=1e-8 * size)
    assert book["hysteresis"] > 0.01 * size
    assert book["links"] > 1e-4 * size
    assert abs(book["residual"]) < 1e-9
