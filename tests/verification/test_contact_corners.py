"""What every law of contact owes in the corners: parameters at the ends of their ranges, grazing blows, floors that
begin to press from rest, rows of ten buildings, and an error estimate that covers the error."""

from __future__ import annotations

import numpy as np
import pytest

from pounding_cli.laws.bilinear_contact import BilinearContact, BilinearDamping
from pounding_cli.laws.hertz import Hertz, HertzDamp, HertzDamping
from pounding_cli.laws.infill import Infill
from pounding_cli.laws.jankowski import Jankowski, JankowskiDamping
from pounding_cli.laws.pounding import Pounding
from pounding_cli.laws.written import WrittenLaw
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Scene
from pounding_cli.solve import solve
from pounding_cli.solve.assess import assess
from tests.helpers.scenes import ELASTIC, INELASTIC, gather, shake, shear_building
from tests.reference.contacts import K, contact_pair
from tests.reference.rows import islands_equal_the_whole, row_of_ten

_HERTZ = (1.0, -0.5, -2.0)
"""N/m^1.5 in kg, m and s."""

LAWS = {
    "pounding": lambda gap: Pounding(gap, 2e9, 0.2154),
    "hertz": lambda gap: Hertz(gap, K),
    "hertz-damp": lambda gap: HertzDamp(gap, K, 0.5),
    "jankowski": lambda gap: Jankowski(gap, K, 0.5),
    "bilinear": lambda gap: BilinearContact(gap, K, 0.002, 0.5),
    "written": lambda gap: WrittenLaw(
        gap, "own", "k*v**1.5*(1 + c*r)", (("k", K, _HERTZ), ("c", 0.3, (0.0, -1.0, 1.0)))
    ),
}
"""Each law across a gap [m]."""

FILLED = LAWS | {"infill": lambda gap: Infill(gap + 0.01, 1.5e8, 2e10, 0.2154)}
"""These, and the material that fills a gap, of 1 cm more."""

EXTREMES = {
    "pounding, soft": Pounding(0.0, 1.0, 0.2),
    "pounding, hard": Pounding(0.0, 1e15, 0.2),
    "pounding, no loss": Pounding(0.0, 2e9, 0.0),
    "pounding, e 0.01, cut": Pounding(0.001, 2e9, 0.8261, True),
    "infill, thin": Infill(1e-5, 1.5e8, 2e10, 0.2),
    "infill, as soft pressed": Infill(0.02, 1e8, 1e8, 0.2),
    "infill, soft to hard": Infill(0.001, 1.0, 1e14, 0.8261, True),
    "written, soft": WrittenLaw(
        0.0, "own", "k*v + k3*v**3", (("k", 1.0, (1.0, 0.0, -2.0)), ("k3", 1e15, (1.0, -2.0, -2.0)))
    ),
    "written, hard": WrittenLaw(0.001, "own", "k*v**1.5", (("k", 1e14, _HERTZ),)),
    "hertz, soft": Hertz(0.0, 1e-3),
    "hertz, hard": Hertz(0.0, 1e14),
    "hertz-damp, e 0.01": HertzDamp(0.0, K, 0.01),
    "hertz-damp, e 1": HertzDamp(0.0, K, 1.0),
    "hertz-damp, nearly 1": HertzDamp(0.0, K, 1 - 1e-9),
    "hertz-damp, ye at 0.01": HertzDamp(0.001, K, 0.01, HertzDamping.YE),
    "hertz-damp, muthukumar at 0.01": HertzDamp(0.0, K, 0.01, HertzDamping.MUTHUKUMAR),
    "hertz-damp, hard": HertzDamp(0.001, 1e14, 0.5),
    "jankowski, e 1": Jankowski(0.0, K, 1.0),
    "jankowski, nearly 1": Jankowski(0.0, K, 1 - 1e-9),
    "jankowski, his formula at 0.01": Jankowski(0.001, K, 0.01, JankowskiDamping.JANKOWSKI),
    "jankowski, hard": Jankowski(0.001, 1e14, 0.5),
    "jankowski, soft": Jankowski(0.0, 1e-3, 0.5),
    "bilinear, e 1": BilinearContact(0.0, K, 0.002, 1.0),
    "bilinear, nearly 1": BilinearContact(0.0, K, 0.002, 1 - 1e-9),
    "bilinear, least e of its share": BilinearContact(0.0, K, 0.002, 0.24, 0.1),
    "bilinear, yields at once": BilinearContact(0.001, K, 0.002, 0.5, 1e-4),
    "bilinear, yields half way": BilinearContact(0.0, K, 0.002, 0.8, 0.499),
    "bilinear, thin": BilinearContact(0.0, K, 1e-6, 0.5),
    "bilinear, deep": BilinearContact(0.0, K, 1.0, 0.5),
    "bilinear, hard": BilinearContact(0.001, 1e14, 1e-4, 0.5),
    "bilinear, muthukumar at 0.01": BilinearContact(0.0, K, 0.002, 0.01, 0.1, BilinearDamping.MUTHUKUMAR),
}
"""Parameters at the ends of their ranges, or at 1e-3 and 1e14 N/m^1.5 where a range has none."""


@pytest.mark.parametrize("law", EXTREMES.values(), ids=EXTREMES.keys())
def test_extremes(law):
    """Two accuracies agree and the energy closes. Fails if a branch is left or entered in a loop, if a number runs out
    of its range, or if a parameter at its end is a division by zero."""
    scene = contact_pair(law, shake(1.0), INELASTIC)
    coarse, fine = solve(scene, 1e-6), solve(scene, 1e-9)
    for found in (coarse, fine):
        assert found.status == "done"
        assert abs(found.energy["residual"]) < 1e-8
    for name in ("drift", "acceleration", "shear"):
        assert gather(coarse, name) == pytest.approx(gather(fine, name), rel=1e-5), name
    assert np.isfinite(fine.links.peak_force).all()


@pytest.mark.parametrize("law", LAWS)
def test_a_grazing_contact(law):
    """Gaps a thousandth and a millionth below the largest closing of floors that never meet, and one a billionth above
    it. Fails if the top of a closing is sought at the ends of steps."""
    free = solve(contact_pair(LAWS[law](1.0), shake(1.0)), 1e-12)
    most = free.links.max_closing.max()
    assert solve(contact_pair(LAWS[law](most * (1 + 1e-9)), shake(1.0)), 1e-12).links.impacts.sum() == 0
    for part in (1e-3, 1e-6):
        found = solve(contact_pair(LAWS[law](most * (1 - part)), shake(1.0)), 1e-9)
        assert found.status == "done"
        assert found.links.impacts.sum() >= 1
        assert found.links.max_closing.max() == pytest.approx(most, rel=2 * part)


@pytest.mark.parametrize("law", FILLED)
@pytest.mark.parametrize("gap", [0.0, 0.01])
def test_the_error_estimate_covers_the_error(gap, law):
    """Fails if the estimate is that of one storey, or is taken from a run as coarse."""
    scene = contact_pair(FILLED[law](gap), shake(1.5), INELASTIC)
    found, fine = assess(scene, solve(scene, 1e-6), 1e-6), solve(scene, 1e-12)
    errors = [np.abs(gather(found, n) / gather(fine, n) - 1).max() for n in ("drift", "acceleration", "shear")]
    assert found.error_estimate >= max(errors)
    assert found.error_estimate < 1e-5


@pytest.mark.parametrize("law", FILLED)
@pytest.mark.parametrize("gap", [0.0, 0.004])
def test_a_row_of_ten_in_islands(gap, law):
    """Fails if an island that waits on a contact forgets its branch, or the speed or force that it goes by."""
    islands_equal_the_whole(row_of_ten(lambda left: [Link(left, j, j, FILLED[law](gap)) for j in (1, 2, 3, 4)]))


@pytest.mark.parametrize("law", LAWS)
def test_a_row_of_ten(law):
    """A blow runs from end to end. Fails if one of many contacts that are closed at once is left out of the energy."""
    buildings = tuple(shear_building(period, 2) for period in (0.36, 0.60) * 5)
    joined = tuple(Link(left, j, j, LAWS[law](0.002)) for left in range(9) for j in (1, 2))
    scene = Scene(buildings, joined, shake(1.0), ELASTIC)
    coarse, fine = solve(scene, 1e-6), solve(scene, 1e-10)
    assert coarse.status == fine.status == "done"
    assert max(abs(coarse.energy["residual"]), abs(fine.energy["residual"])) < 1e-8
    assert coarse.links.impacts.tolist() == fine.links.impacts.tolist()
    assert (fine.links.impacts[1::2] > 0).all()
    assert gather(coarse, "drift") == pytest.approx(gather(fine, "drift"), rel=1e-5)


@pytest.mark.parametrize("accuracy", [1e-6, 1e-9])
@pytest.mark.parametrize(("k", "e"), [(1e10, 0.01), (1e12, 0.01), (1e12, 0.1), (1e14, 0.05), (1e14, 0.1)])
def test_jankowski_presses_from_rest(k, e, accuracy):
    """Hard contacts that are overdamped while the floors approach, from rest in touch. Fails if the first steps, whose
    forces are too small to be resolved, do not lead away from rest."""
    found = solve(contact_pair(Jankowski(0.0, k, e), shake(2.0, dt=0.05), INELASTIC), accuracy, bounds=(3000, 3000))
    assert found.status == "done"
    assert abs(found.energy["residual"]) < 1e-8
    assert (found.links.impacts > 0).all()
