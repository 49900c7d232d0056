"""`shear_demand` as a limit: columns that a neighbour's slab strikes, against numbers worked out by hand."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from test_fragility_refusals import refused
from test_fragility_runs import G, solved

from pounding_cli.solve import solve as solver
from pounding_cli.solve.places import struck_columns
from pounding_cli.solve.response import ColumnResponse
from tests.helpers.fragility_studies import known

TALL, LOW = "A: {storeys: 1, height: 3 m, ", "B: {storeys: 1, height: 2 m, "
STUDY = f"""\
title: A slab against columns
records: {{use: [step.txt, pulse.txt], scale: {{pga: 0.1 g}}}}
buildings:
  {TALL}period: 0.6 s, mass: 100 t, columns: 20 %, yield: {{base_shear: 0.5 W, overstrength: 1}}, damping: 0 %}}
  {LOW}period: 0.6 s, mass: 100 t, yield: {{base_shear: 0.5 W, overstrength: 1}}, damping: 0 %}}
group: [A, B]
cases:
  wide: {{link: pounding, gap: 1 m}}
  floors: {{link: pounding, gap: 1 m, at_columns: none}}
analyses: [elastic]
estimate: none
sweep: {{records.scale.pga: {{from: 0.01 g, to: 0.6 g, step: 0.01 g}}}}
fragility:
  limits: [shear_demand > 1]
"""


def write_motions(folder: Path) -> None:
    """Constant acceleration, and the same for a sixth of the period of 0.6 s."""
    time = np.arange(0.0, 1.5, 0.001)
    for name, until in (("step", 2.0), ("pulse", 0.1)):
        rows = "\n".join(f"{t:.3f} {1.0 if t < until else 0.0:.1f}" for t in time)
        (folder / f"{name}.txt").write_text("# unit m/s2\n" + rows + "\n")


@pytest.mark.parametrize("method", ["ida", "stripes"])
def test_columns_that_nothing_strikes_carry_their_share_of_the_storey(tmp_path, method):
    """Without damping a constant acceleration a gives the shear 2 m a, a pulse of T / 6 half of it (2 sin(pi / 6) m a);
    the columns' demand is that over their storey's strength 0.5 m g: 1 at 0.25 g and at 0.5 g."""
    write_motions(tmp_path)
    text = STUDY.replace("fragility:\n", f"fragility:\n  method: {method}\n")
    outcome, results = solved(tmp_path, text, solver)
    assert outcome.failed == 0
    motions = results.table("fragility_motions").set_index(["case", "record"])
    assert set(motions["building"]) == {"A"}  # nothing strikes columns of B
    for record, capacity in (("step", 0.25), ("pulse", 0.5)):
        found = motions.loc[("wide", record)]
        if method == "stripes":
            # the motion is linear between its samples: the pulse is a millisecond longer than its samples of 1
            ratio = found["demand"] * capacity / (found["intensity"] / G)
            assert ratio.to_numpy() == pytest.approx(1.0, rel=0.02)
        else:
            assert found["held"] / G <= capacity + 1e-9
            assert found["passed"] / G == pytest.approx(capacity + 0.01, abs=0.0101)
            assert (found["passed"] - found["held"]) / G == pytest.approx(0.01)
            assert np.isnan(found["held0"])  # a building alone has no struck columns
    curves = results.table("fragility").set_index("case")
    assert curves.loc["floors", "outcome"] == "never passed"  # no blows on columns in that case
    assert (curves["failed"] == 0).all()


def strikes(scene, **settings):
    """As `known`; columns of A carry 1 and of a storey above 2 times the peak of the ground over 0.3 g."""
    response = known(scene)
    struck = struck_columns(scene.links)
    demand = np.array([each.storey * scene.motion.pga / G / 0.3 for each in struck])
    link, zero = np.array([each.link for each in struck], np.int64), 0 * demand
    return replace(response, columns=ColumnResponse(link, zero, zero, demand))


def test_the_storey_with_the_largest_demand_decides(tmp_path):
    """Demands of 1 and 2 at 0.3 g. Fails if a storey's columns are taken for another's, or rounds and tables differ."""
    tall = STUDY.replace(TALL, "A: {storeys: 2, height: 3 m, ").replace(LOW, "B: {storeys: 2, height: 2 m, ")
    tall = tall.replace("[shear_demand > 1]", "[shear_demand > 1, shear_demand > 1 in A storey 1]")
    write_motions(tmp_path)
    _, results = solved(tmp_path, tall, strikes)
    motions = results.table("fragility_motions").set_index(["case", "limit", "record"])
    for limit, capacity in (("shear_demand > 1", 0.15), ("shear_demand > 1 in A storey 1", 0.3)):
        for record in ("step", "pulse"):
            found = motions.loc[("wide", limit, record)]
            assert found["held"] / G <= capacity + 1e-9 < found["passed"] / G + 1e-8
            assert (found["passed"] - found["held"]) / G == pytest.approx(0.01)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("height: 3 m", "height: 2 m", "no slab strikes columns of A and B whose strength is known"),
        ("columns: 20 %, yield: {base_shear: 0.5 W, overstrength: 1}", "columns: 20 %, yield_shear: never", "is known"),
        ("[shear_demand > 1]", "[shear_demand > 1 in B]", "no slab strikes columns of B"),
        ("[shear_demand > 1]", "[shear_demand > 1 in A storey 2]", "the highest is 1"),
        ("  wide: {link: pounding, gap: 1 m}\n", "", "no slab strikes columns"),
    ],
)
def test_where_no_slab_strikes_columns(tmp_path, old, new, said):
    """Fails if a curve is sought that can have no pass."""
    assert old in STUDY
    write_motions(tmp_path)
    ((line, column, message, hint),) = refused(tmp_path, STUDY.replace(old, new))
    place = STUDY.replace(old, new).splitlines().index("fragility:") + 2
    assert said in message
    assert (line, column) == (place, 12)
    assert hint
