"""What an error estimate makes of runs that rounding makes worse, and what it may cost."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.adapter import Scene, estimates, solve, solver
from tests.physics.cases import shake

TOWER = {"storeys": 2, "mass": 1e5, "height": 3.0, "damping": 0.03, "yield_shear": [2e5, 1.5e5], "hardening": 0.03}
SMOOTH = Scene(
    (TOWER | {"period": 0.4, "storey_law": "bouc-wen"}, TOWER | {"period": 0.7}),
    shake(2.0), 0.02, {"link": "hertz", "gap": 0.005, "hertz_stiffness": 2e9}, "inelastic",
)  # fmt: skip


@pytest.mark.parametrize(
    ("noise", "best", "error"),
    [
        ({1e-12: 5e-8, 2e-12: -3e-8, 4e-12: 4e-8}, 0.0, 5e-8),
        ({1e-12: 5e-8, 2e-12: 5.1e-8, 4e-12: 4.8e-8}, 5e-8, 2e-9),
        ({1e-12: 5e-10}, 0.0, 5e-10),
    ],
)
def test_the_best_run_is_the_answer(monkeypatch, noise, best, error) -> None:
    """Finer runs that scatter, that agree with each other, or that agree with the first. Fails if one that rounding has
    made worse replaces a better one, or the error is not that of the run that is returned."""
    first = solver.solve(SMOOTH.built, 1e-10)
    peaks = first.peaks.copy()

    def scatter(scene, accuracy, method, bounds, least_steps=1):
        finer = peaks.copy()
        finer["shear"] = peaks["shear"] * (1.0 + noise[accuracy])
        return replace(first, peaks=finer, accuracy=accuracy)

    monkeypatch.setattr(solver, "solve", scatter)
    (found,) = estimates.assess([SMOOTH.built], [first], 1e-9 * 0.999)
    assert found.peaks["shear"] == pytest.approx(peaks["shear"] * (1.0 + best), rel=1e-12, nan_ok=True)
    assert found.error_estimate == pytest.approx(error, rel=1e-2)
    assert any(flag.code == "error" for flag in found.flags) == (error > 1e-9)


@pytest.mark.parametrize(
    ("accuracy", "price", "flag"),
    [
        (1e-6, 0, "no-error"), (1e-6, 2.2, "cut-short"), (1e-6, 100, ""),
        (3e-10, 0, "no-error"), (3e-10, 1.2, "cut-short"), (3e-10, 100, ""),
    ],
)  # fmt: skip
def test_an_estimate_costs_no_more_than_its_price(monkeypatch, accuracy, price, flag) -> None:
    """Nothing, all runs that judge but the last, or as usual. Fails if the runs go on beyond their price, or nobody
    is told that they were stopped."""
    judge = solver.solve(SMOOTH.built, estimates.refine_accuracy(accuracy))
    first = solver.solve(SMOOTH.built, accuracy)
    limit = int(price * judge.steps)
    monkeypatch.setattr(estimates, "LEAST_PRICE", limit)
    monkeypatch.setattr(estimates, "PRICE", 0)
    monkeypatch.setattr(estimates, "HARMLESS", 0.0)  # runs of its own tell error and sensitivity
    taken = []
    usual = solver.prepare_run

    def count(*arguments, **settings):
        run = usual(*arguments, **settings)
        taken.append(run)
        return run

    monkeypatch.setattr(solver, "prepare_run", count)
    (found,) = estimates.assess([SMOOTH.built], [first], accuracy)
    steps = sum(int(run.data.run["steps"].sum()) for run in taken)
    assert steps <= limit + len(taken)
    told = [each.code for each in found.flags]
    assert (flag in told) if flag else not told
    assert np.isnan(found.error_estimate) == (price == 0)


def test_no_judge_is_finer_than_rounding_allows() -> None:
    """Fails if a run is judged by a coarser one, or by one below what doubles hold."""
    for accuracy in (1e-3, 1e-6, 1e-9, 1e-11, 1e-12, 1e-14):
        finer = estimates.refine_accuracy(accuracy)
        assert finer <= accuracy
        assert finer >= min(accuracy, 1e-12)


def test_a_run_at_the_finest_accuracy_is_judged_by_other_steps() -> None:
    """Fails if it is compared with itself, or with nothing."""
    run = solve(SMOOTH, 1e-12, estimate=True)
    assert 0.0 < run.error < 1e-8
