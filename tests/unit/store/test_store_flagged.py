"""Flags of a results file: which scenes they stand in, and which make the numbers meaningless."""

from __future__ import annotations

from dataclasses import replace

import pandas as pd
import pytest

from pounding_cli.laws.connector import Connector
from pounding_cli.laws.infill import Infill
from pounding_cli.model.links import Link
from pounding_cli.solve.flags import flags_of, is_meaningless
from pounding_cli.store import flag_groups_of, flagged_scenes, open_results, overview, write_results
from pounding_cli.study import Axis
from tests.helpers.plans import known, small_plan

STRUCK = "connector closes more than the gap, so the floors would have struck"


def response(scene):
    """Case "gap" under the strong motion: struck, and a ratio of no use; the first case only worth knowing."""
    said: tuple[str, ...] = ()
    if scene.links and scene.links[0].gap:
        said = (f"{STRUCK}: stiff | soft, floor 1, by 2 mm", "odd") if scene.motion.name == "strong" else ()
    elif scene.links:
        said = ("infill compressed beyond its thickness: stiff | soft, floor 2, by 1 mm",)
    return replace(known(scene), flags=said)


@pytest.fixture
def path(tmp_path):
    plan = small_plan(axes=(Axis(("impact.restitution",), ((0.2,), (0.4,))),))
    write_results(tmp_path / "r.h5", plan, {digest: response(scene) for digest, scene in plan.scenes.items()})
    return tmp_path / "r.h5"


def test_every_flag_has_a_row_with_its_scene(path):
    found = open_results(path).flagged()
    place = ["impact.restitution", "case", "analysis", "record"]
    assert list(found.columns) == [*place, "flag", "detail", "meaningless"]
    struck = found[found.flag == STRUCK]
    assert struck[place].to_numpy().tolist() == [
        [point, "gap", analysis, "strong"] for point in (0.2, 0.4) for analysis in ("elastic", "inelastic")
    ]
    assert set(struck.detail) == {"stiff | soft, floor 1, by 2 mm"}
    assert struck.meaningless.all()
    assert not found[found.flag != STRUCK].meaningless.any()
    assert len(found) == 4 + 4 + 8
    assert (found[found.flag == "odd"].detail == "").all()


def test_no_flag_is_an_empty_table_of_the_same_columns(path):
    scene = open_results(path).scene().assign(flags="")
    found = flagged_scenes(scene)
    assert found.empty
    assert list(found.columns)[-3:] == ["flag", "detail", "meaningless"]
    assert flag_groups_of(scene) == ()


def test_groups_name_the_scenes_and_begin_with_what_is_meaningless(path):
    groups = flag_groups_of(open_results(path).scene())
    assert [(group.case, group.analysis, group.flag) for group in groups[:2]] == [
        ("gap", "elastic", STRUCK),
        ("gap", "inelastic", STRUCK),
    ]
    assert [group.meaningless for group in groups] == [True, True, False, False, False, False]
    assert (groups[0].count, groups[0].of) == (2, 4)
    assert groups[0].scenes == "impact.restitution = 0.2: strong; impact.restitution = 0.4: strong"
    assert {group.scenes for group in groups if group.case == "touching"} == {"all"}


def test_the_overview_tells_the_same_without_pandas(path):
    found = overview(path)
    assert found.flags == flag_groups_of(open_results(path).scene())
    assert found.meaningless == 4
    marked = {(line.case, line.analysis): line.meaningless.tolist() for line in found.lines}
    assert marked["gap", "elastic"] == [True, True]
    assert marked["touching", "inelastic"] == [False, False]


def test_summary_counts_flagged_and_meaningless_records(path):
    summary = open_results(path).summary()
    gap, touching = (summary[summary.case == case] for case in ("gap", "touching"))
    assert set(zip(gap.records_flagged, gap.records_meaningless, strict=True)) == {(1, 1)}
    assert set(zip(touching.records_flagged, touching.records_meaningless, strict=True)) == {(2, 0)}


def test_of_many_points_the_first_are_named_and_the_rest_counted():
    flagged = f"{STRUCK}: a | b, floor 1, by 1 mm"
    scene = pd.DataFrame(
        {"gap": 0.01 * n, "case": "con", "analysis": "elastic", "record": "taft", "flags": flagged if n < 10 else ""}
        for n in range(1, 14)
    )
    (group,) = flag_groups_of(scene)
    assert group.scenes.startswith("gap = 0.01: taft; gap = 0.02: taft; ")
    assert group.scenes.endswith("; and 3 more points")


def test_only_a_connector_that_strikes_takes_the_meaning():
    plan = small_plan()
    scene = plan.scenes[plan.rows[-1].scene]
    for law, worthless in ((Connector(0.05, 1e8, 0.2), True), (Infill(0.05, 1e8, 2e9, 0.2), False)):
        link = Link(0, 1, 1, law)
        linked = replace(scene, links=(link,))
        (flag,) = flags_of(linked, known(linked).links)
        assert is_meaningless(flag) == worthless
