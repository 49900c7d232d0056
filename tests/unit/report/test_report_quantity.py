"""A quantity over the sweep: means over the motions, the worst place at every point, units, what is refused."""

from __future__ import annotations

from itertools import product

import numpy as np
import pandas as pd
import pytest

from pounding_cli.errors import InputError
from pounding_cli.numbers import Unit
from pounding_cli.report.axes import swept_axes
from pounding_cli.report.quantity import Choice, over_sweep, quantities
from tests.helpers.report_tables import MOTIONS, make

PERIODS = (0.4, 0.5, 0.6)
GAPS = (0.0, 0.05)


@pytest.fixture(scope="module")
def swept():
    """Periods and gaps: V/V0 grows by 10 % a period and by 50 % a gap; the weakest motion of the last point is lost."""
    parts = [make(axis=("period", PERIODS)) for _ in GAPS]
    frames = {}
    for name in ("storey", "floor", "link", "scene"):
        found = []
        for number, (gap, part) in enumerate(zip(GAPS, parts, strict=True)):
            frame = getattr(part, name)()
            frame.insert(1, "gap_axis", gap)
            if name == "storey":
                frame["V_ratio"] *= 1 + 0.5 * number
            found.append(frame)
        frames[name] = pd.concat(found, ignore_index=True)
    lost = (frames["storey"]["period"] == 0.6) & (frames["storey"]["gap_axis"] == 0.05)
    lost &= frames["storey"]["record"] == "elcentro"
    frames["storey"].loc[lost, "V_ratio"] = np.nan
    fake = parts[0]
    fake._frames |= frames
    fake.units = {"gap_axis": Unit("cm", 0.01, "m")}
    return fake


def test_axes_stand_in_the_unit_of_the_study(swept):
    period, gap = swept_axes(swept)
    assert (period.label, gap.label) == ("period", "gap_axis [cm]")
    assert gap.names == ("0", "5")
    np.testing.assert_array_equal(gap.coordinates, [0.0, 5.0])
    assert gap.at(1) == "gap_axis = 5 cm"


def test_keys_that_move_together_are_one_axis(swept):
    swept.attrs = {"swept": '[["period", "gap_axis"]]'}
    (both,) = swept_axes(swept)
    swept.attrs = {}
    assert len(both) == 6
    assert both.numeric
    assert both.at(1) == "period = 0.5, gap_axis = 0 cm"
    assert both.names[-1] == "0.6, 5"


def test_mean_and_spread_are_over_the_motions_at_the_worst_storey(swept):
    found = over_sweep(swept, Choice("V_ratio", case="gap", analysis="elastic", building="stiff"))
    assert found.mean.shape == (3, 2)
    for (i, _), (j, _) in product(enumerate(PERIODS), enumerate(GAPS)):
        motions = np.array(MOTIONS[1:] if (i, j) == (2, 1) else MOTIONS)
        values = 1.2 * 1.04 * (1 + 0.1 * i) * (1 + 0.5 * j) * motions  # storey 5 has 1.04 of the level
        np.testing.assert_allclose(found.mean[i, j], values.mean(), rtol=1e-12)
        np.testing.assert_allclose(found.std[i, j], values.std(ddof=1), rtol=1e-12)
        assert (found.low[i, j], found.high[i, j]) == pytest.approx((values.min(), values.max()))
        assert found.motions[i, j] == len(motions)
    assert set(found.place.flat) == {"storey 5"}


def test_what_is_not_chosen_is_searched_for_its_worst(swept):
    found = over_sweep(swept, Choice("V_ratio"))
    assert set(found.place.flat) == {"connected, elastic, stiff, storey 5"}  # the soft building is eased
    one = over_sweep(swept, Choice("V_ratio", storey=1, record="taft", case="gap", building="stiff"))
    np.testing.assert_allclose(one.mean[0, 0], 1.2 * 0.96 * MOTIONS[1], rtol=1e-12)
    assert np.isnan(one.std).all()


def test_links_and_units(swept):
    found = over_sweep(swept, Choice("peak_force", case="touching", analysis="elastic", floor=2))
    assert found.title == "peak force [kN]"
    np.testing.assert_allclose(found.mean, 12e3 * 2 * 1.2, rtol=1e-12)
    assert found.place[0, 0] == "stiff|soft 2"


def test_a_part_of_the_sweep(swept):
    period, gap = swept_axes(swept)
    whole = over_sweep(swept, Choice("V_ratio", case="gap")).mean
    np.testing.assert_array_equal(over_sweep(swept, Choice("V_ratio", case="gap"), [gap, period]).mean, whole.T)
    part = over_sweep(swept, Choice("V_ratio", case="gap"), [period], {"gap_axis": 0.05})
    np.testing.assert_array_equal(part.mean, whole[:, 1])


def test_every_quantity_named_is_a_column_of_its_table(tmp_path):
    from pounding_cli import variables
    from pounding_cli.store import row_tables

    columns = {*row_tables._STOREY, *row_tables._FLOOR, *row_tables._LINK, *row_tables._SCENE, *variables.OF_COLUMNS}
    assert set(quantities()) <= columns
    assert set(quantities()) <= set(variables.VARIABLES)


@pytest.mark.parametrize(
    ("choice", "message", "hint"),
    [
        ({"quantity": "shear_demand"}, "no slab strikes columns", "`columns:`"),
        ({"quantity": "V_rato"}, "there is no quantity 'V_rato'", "V_ratio"),
        ({"quantity": "V_ratio", "case": "gip"}, "there is no case 'gip'", "touching, gap"),
        ({"quantity": "V_ratio", "storey": 9}, "there is no storey 9", "1, 2, 3, 4, 5"),
        ({"quantity": "V_ratio", "floor": 1}, "V_ratio has no floor", "leave it out"),
        ({"quantity": "impacts", "case": "connected", "floor": 4}, "there is no floor 4", "3, 5"),
    ],
)
def test_what_is_not_there_is_refused(swept, choice, message, hint):
    with pytest.raises(InputError) as refused:
        over_sweep(swept, Choice(**choice))
    assert message in str(refused.value)
    assert hint in refused.value.problems[0].hint
