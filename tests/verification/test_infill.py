"""Infill between two all but free masses: the quartic energy balance of eq. (9), continuous and printed."""

from __future__ import annotations

import pytest

from pounding_cli.laws.infill import Infill, InfillLaw
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Scene
from pounding_cli.solve import solve
from tests.helpers.scenes import ELASTIC, links, oscillator, shake, still
from tests.reference import events
from tests.reference.closed_forms import infill_compression

M1, M2, S_MAT, S_IMP, GAP = 2e5, 3e5, 1e8, 2e9, 0.02
REDUCED = M1 * M2 / (M1 + M2)


def scene(xi=0.0, cut=False, law=InfillLaw.CONTINUOUS):
    link = Link(0, 1, 1, Infill(GAP, S_MAT, S_IMP, xi, cut, law))
    return Scene((oscillator(M1, 1e-3), oscillator(M2, 1e-3)), (link,), still(0.2), ELASTIC)


@pytest.mark.parametrize("law", list(InfillLaw))
@pytest.mark.parametrize(("v0", "passes"), [(0.05, False), (0.5, False), (1.5, True)])
def test_peak_compression_of_an_undamped_infill(v0, passes, law):
    """m' v0^2 / 2 = work of the law, to 1e-8, and nothing is lost. Fails if the cubic's 3 d^2 loses its 3."""
    found = solve(scene(law=law), 1e-12, initial=([[0.0], [0.0]], [[v0], [0.0]]))
    expected = infill_compression(REDUCED * v0**2 / 2, S_MAT, S_IMP, GAP, law is InfillLaw.PRINTED)
    assert (expected > GAP) == passes
    assert found.links.max_closing[0] == pytest.approx(expected, rel=1e-8)
    left, right = (v[0] for _, v in found.final)
    assert right - left == pytest.approx(v0, rel=1e-8)
    assert found.links.impacts[0] == 1


def test_peak_force_and_the_jump_of_the_printed_law():
    """F(d) + s_imp (v - d), or s_imp v: 2/3 d (s_imp - s_mat) more. Fails if the laws are exchanged."""
    v0 = 1.5
    for law, extra in ((InfillLaw.CONTINUOUS, 0.0), (InfillLaw.PRINTED, 2 / 3 * GAP * (S_IMP - S_MAT))):
        found = solve(scene(law=law), 1e-12, initial=([[0.0], [0.0]], [[v0], [0.0]])).links
        at_gap = (S_IMP - S_MAT) / 3 * GAP + S_MAT * GAP
        expected = at_gap + S_IMP * (found.max_closing[0] - GAP) + extra
        assert found.peak_force[0] == pytest.approx(expected, rel=1e-8)


@pytest.mark.parametrize("cut", [False, True])
@pytest.mark.parametrize("v0", [0.5, 1.8])
@pytest.mark.parametrize("law", list(InfillLaw))
def test_damped_infill_against_the_reference(v0, cut, law):
    """The dashpot follows the current slope. Fails if it keeps the slope at v = 0."""
    start = ([[0.0], [0.0]], [[v0], [0.0]])
    expected, found = (
        events.integrate(scene(0.2, cut, law), start),
        solve(scene(0.2, cut, law), 1e-12, initial=start),
    )
    for name in ("peak_force", "max_closing", "impulse", "contact_time"):
        assert getattr(found.links, name) == pytest.approx(getattr(expected, name), rel=1e-8), name
    assert [v[0] for _, v in found.final] == pytest.approx(expected.velocity, rel=1e-8)


@pytest.mark.parametrize("seed", [7, 8])
def test_an_infill_that_cannot_pull_presses_again_in_time(seed):
    """Two shaken storeys, samples 50 ms apart. A force that is cut off moves no floor, and its series, with the
    dashpot's square root, converges over a part of the floors' step only. Fails if its sign is looked for in a series
    that has not converged: contact times are then off by 1e-3 at every accuracy."""
    two = oscillator(2e5, 2e7, 0.05), oscillator(3e5, 6e7, 0.05)
    infill = links("infill", 0.01, (1,), stiffness=9e6, tension_cut=True)
    shaken = Scene(two, infill, shake(4.0, dt=0.05, seed=seed), ELASTIC)
    expected = events.integrate(shaken)
    for accuracy in (1e-4, 1e-6, 1e-9):
        found = solve(shaken, accuracy).links
        for name in ("peak_force", "max_closing", "impulse", "contact_time"):
            error = max(accuracy, 1e-8)
            assert getattr(found, name) == pytest.approx(getattr(expected, name), rel=error), (accuracy, name)
