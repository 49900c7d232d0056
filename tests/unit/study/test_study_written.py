"""An axis knows the unit its values are written in."""

from __future__ import annotations

import pytest

from pounding_cli.study import expand

SWEEP = "analyses: [elastic]\nsweep: {%s}\n"


@pytest.mark.parametrize(
    ("axis", "unit", "shown"),
    [
        ("records.scale.pga: [0.7 g, 1.4 g]", "g", ["0.7 g", "1.4 g"]),
        ("cases.gap.gap: [0 cm, 50 mm, 0.1]", "cm", ["0 cm", "5 cm", "10 cm"]),
        ("cases.gap.gap: [0.05, 0.1]", "m", ["0.05 m", "0.1 m"]),
        ("buildings.stiff.damping: [3 %, 0.05]", "%", ["3 %", "5 %"]),
        ("impact.restitution: [0.4, 1/2]", "", ["0.4", "0.5"]),
        ("impact.stiffness: [2000 kN/mm, 4000 kN/mm]", "kN/mm", ["2000 kN/mm", "4000 kN/mm"]),
        ("impact.stiffness: [5 x stiffest storey, 2 GN/m]", "GN/m", ["5 x stiffest storey", "2 GN/m"]),
        ("buildings.stiff.storeys: [2, 3]", "", ["2", "3"]),
        ("records.scale: [{arias: taft}, 2]", "", ["{arias: taft}", "2"]),
    ],
)
def test_axis_shows_its_values_in_the_unit_written(study, axis, unit, shown):
    (found,) = study(
        ("analyses: [elastic]\n", SWEEP % axis),
        *([("scale: 1.0", "scale: {pga: 0.3 g}")] if "pga" in axis else []),
    ).axes
    assert found.unit(0).name == unit
    assert [found.shown(place) for place in range(len(found.values))] == [(text,) for text in shown]


def test_a_plan_says_where_a_row_stands_in_the_units_of_the_study(study):
    plan = expand(study(("analyses: [elastic]\n", SWEEP % "cases.gap.gap: [2 in, 4 in]")))
    assert plan.shown(plan.rows[-1]) == {"cases.gap.gap": "4 in"}
    assert plan.axes[0].values == ((0.0508,), (0.1016,))
