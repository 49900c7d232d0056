"""What every law of the table owes: agreement with an independent integrator, closed energies, an honest error."""

from __future__ import annotations

import os
from dataclasses import replace

import numpy as np
import pytest

import pounding_cli as pound
from tests.adapter import Run, Scene, difference, solve
from tests.physics.cases import ROWS, VARIANTS, Row, mirrored, shake, variant
from tests.physics.references import FIELDS, read

ALL = pytest.mark.parametrize("row", ROWS.values(), ids=lambda row: row.name)
PEAKS = "shear", "drift", "acceleration", "displacement_max", "displacement_min", "peak_force", "impulse"
SINKS = "damping", "hysteresis", "links"


def columns_of(run: Run) -> np.ndarray:
    """Shears below and above each struck column in turn."""
    return np.ravel([run.shear_below, run.shear_above], "F")


def balance_over_time(energy: dict[str, np.ndarray]) -> float:
    """Largest difference of what was put in and what is held or lost, relative to all that was put in [-]."""
    spent = sum(energy[kind] for kind in ("kinetic", "stored", "damping", "hysteresis", "links"))
    return float(np.abs(spent - energy["input"]).max() / energy["input"].max())


@pytest.mark.parametrize("name", VARIANTS)
@ALL
class TestEveryRun:
    """The pair of a row, with a gap and without."""

    def test_agrees_with_an_independent_integrator(self, row: Row, name: str) -> None:
        """Every peak, the end, impulses, durations and counts. Fails on any other force, branch or event."""
        run, expected = solve(variant(row, name), 1e-12), read(f"{row.like or row.name}; {name}")
        work = np.array([run.energy["input"], run.energy["damping"]])
        for field in FIELDS:
            found = {"columns": columns_of(run), "work": work}.get(field)
            found = getattr(run, field) if found is None else found
            size = np.abs(expected[field]).max(initial=0.0)
            np.testing.assert_allclose(found, expected[field], rtol=1e-7, atol=2e-8 * size, err_msg=field)

    def test_closes_its_energy(self, row: Row, name: str) -> None:
        """To a hundredth of the usual accuracy, to rounding at the finest; sinks only take. Fails if a loss is left
        out."""
        for accuracy, residual in ((1e-6, 1e-8), (1e-12, 1e-12)):
            run = solve(variant(row, name), accuracy)
            assert run.status == "done"
            assert abs(run.energy["residual"]) < residual
            assert min(run.energy[sink] for sink in SINKS) >= -1e-9 * run.energy["input"]

    def test_keeps_the_accuracy_asked_and_knows_its_error(self, row: Row, name: str) -> None:
        """Fails if an estimate is below the true error, or a run misses its accuracy without a word."""
        scene = variant(row, name)
        truth = solve(scene, 1e-13)
        for accuracy in (1e-3, 1e-6):
            run = solve(scene, accuracy, estimate=True)
            assert difference(run, truth) <= max(1.1 * run.error, 1e-11)
            assert run.error <= accuracy or any("less accurate" in flag for flag in run.flags)
            assert run.impacts.tolist() == truth.impacts.tolist()


@ALL
class TestEveryLaw:
    """Other scenes of a row."""

    def test_chain_of_ten(self, row: Row) -> None:
        """A run with an estimate keeps its accuracy on ten buildings.

        Fails if a link takes another's building, or a step is too long."""
        if not row.chained:
            pytest.skip("it takes long")
        if row.name == "viscous" and "POUND_NIGHTLY" not in os.environ:
            pytest.skip("make reference runs it every night")
        coarse, fine = solve(row.chain(), 1e-6, estimate=True), solve(row.chain(), 1e-10)
        assert difference(coarse, fine) <= 1e-6
        assert coarse.impacts.tolist() == fine.impacts.tolist()
        assert abs(fine.energy["residual"]) < 1e-11
        assert fine.events > 0 or row.name == "connector"

    def test_history_reaches_the_peaks(self, row: Row) -> None:
        """And never passes them; energies close at every instant. Fails if what a law remembers is lost in between."""
        scene = row.pair()
        run, kept = solve(scene, 1e-9), pound.history(scene.built, every=1e-4, accuracy=1e-9)
        for name, over_time in (("drift", kept.drift), ("shear", kept.shear), ("peak_force", kept.link_force)):
            peak, found = getattr(run, name), np.abs(over_time).max(axis=0).ravel()
            assert (found <= peak * (1 + 1e-7)).all(), name
            assert found == pytest.approx(peak, rel=2e-2, abs=1e-2 * peak.max()), name
        assert kept.closing.max(axis=0) == pytest.approx(run.max_closing, rel=1e-3, abs=1e-6)
        assert kept.total_acceleration.shape[1:] == kept.drift.shape[1:]
        assert balance_over_time(kept.energy) < 1e-8

    def test_the_other_side_of_the_street(self, row: Row) -> None:
        """Mirrored, the same numbers. Fails if a sign, or one end of a link, is another's."""
        scene = row.pair()
        one, other = solve(scene, 1e-11), solve(mirrored(scene), 1e-11)
        for name in ("shear", "drift", "acceleration"):
            assert getattr(other, name) == pytest.approx(np.roll(getattr(one, name), 3), rel=1e-7), name
        assert other.displacement_max == pytest.approx(-np.roll(one.displacement_min, 3), rel=1e-7, abs=1e-12)
        assert other.peak_force == pytest.approx(one.peak_force, rel=1e-7)
        assert other.impulse == pytest.approx(one.impulse, rel=1e-7, abs=1e-6 * np.abs(one.impulse).max())

    def test_nothing_happens_at_rest(self, row: Row) -> None:
        """Floors in touch under still ground. Fails if a law acts, or has events, by itself."""
        run = solve(replace(row.pair(0.0), ground=np.zeros(26)), 1e-6)
        assert run.status == "done"
        assert run.drift.max() == run.peak_force.max() == run.events == 0

    def test_still_ground_before_and_after(self, row: Row) -> None:
        """Half a second of rest before the motion changes nothing, and a tail of free vibration ends. Fails if a start
        from rest that lasts is another."""
        scene = row.pair(0.0)
        later = replace(scene, ground=np.concatenate((np.zeros(25), scene.ground)), tail=0.5)
        now, then = (solve(each, 1e-9) for each in (replace(scene, tail=0.5), later))
        assert now.status == then.status == "done"
        assert difference(now, then, PEAKS) < 1e-6
        assert now.impacts.tolist() == then.impacts.tolist()


@pytest.mark.parametrize("row", [row for row in ROWS.values() if row.contact and not row.gap], ids=lambda r: r.name)
def test_graze(row: Row) -> None:
    """Gaps by a thousandth and a millionth narrower than the largest closing of floors that never meet, and a billionth
    wider. Fails if the top of a closing is sought at the ends of steps."""

    def at(gap: float) -> Run:
        scene = row.row((0.36, 0.60), 3, shake(1.0, 6.0), gap, "elastic")
        return solve(scene, 1e-11)

    apart = at(1.0)
    assert apart.impacts.sum() == 0
    first = int(np.argmax(apart.max_closing))
    closing = apart.max_closing[first]
    for share, meets in ((1 - 1e-3, True), (1 - 1e-6, True), (1 + 1e-9, False)):
        run = at(closing * share)
        assert (run.impacts.sum() > 0) == meets, share
        assert abs(run.energy["residual"]) < 1e-11
        assert run.max_closing[first] == pytest.approx(closing, rel=3e-3)


def test_floors_that_pass_through_each_other_are_flagged():
    """Fails if a contact far too soft lets floors through in silence, or a stiff one is flagged."""
    buildings = ({"stiffness": [1e8], "mass": 2e5, "height": 3.0}, {"stiffness": [1e6], "mass": 2e5, "height": 3.0})
    ground = 5.0 * np.sin(np.arange(0.0, 6.0, 0.02) * 2.2)
    soft, stiff = (
        solve(Scene(buildings, ground, 0.02, {"link": "pounding", "gap": 0.0, "stiffness": stiffness}))
        for stiffness in (1e4, 2e9)
    )
    (flag,) = soft.flags
    assert flag.startswith("floors pass through each other by more than a tenth of a storey height")
    assert flag.endswith(f"b0 | b1, floor 1, by {1000 * soft.max_closing[0]:.3g} mm")
    assert soft.max_closing[0] > 0.3
    assert stiff.flags == ()
