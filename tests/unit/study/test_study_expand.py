"""Expansion: rows, scenes kept once, axes crossed or moving together."""

from __future__ import annotations

import numpy as np
import pytest

from pounding_cli.errors import InputError
from pounding_cli.study import expand, load_study
from pounding_cli.study.links import Links
from pounding_cli.study.problems import Problems
from pounding_cli.study.scenes import LinkSets
from pounding_cli.study.sections import FEW_KEPT, Answers

GAP = "gap: {link: pounding, gap: 5 cm}"
END = "analyses: [elastic]\n"


def test_rows_and_shared_baselines(study):
    """2 cases x 2 analyses x 2 records; 2 buildings x 2 analyses x 2 records alone, whatever the cases."""
    plan = expand(study((GAP, GAP + "\n  touch: {link: pounding, gap: 0}"), ("[elastic]", "[elastic, inelastic]")))
    assert len(plan.rows) == 8
    baselines = {digest for row in plan.rows for digest in row.baselines}
    assert len(baselines) == 8
    assert len(plan.scenes) == 16
    assert all(plan.scenes[digest].digest == digest for digest in plan.scenes)
    row = plan.rows[0]
    assert (row.case, row.analysis, row.record, row.point) == ("gap", "elastic", "elcentro", ())
    alone = plan.scenes[row.baselines[1]]
    assert alone.links == ()
    assert alone.digest == plan.scenes[row.scene].alone(1).digest


def test_twins_share_their_baseline(study):
    plan = expand(study(("group: [stiff, soft]", "group: [soft, stiff, soft]")))
    row = plan.rows[0]
    assert row.baselines[0] == row.baselines[2] != row.baselines[1]
    assert [b.name for b in plan.scenes[row.scene].buildings] == ["soft-1", "stiff", "soft-2"]


def test_cross_product(study):
    plan = expand(study((END, END + "sweep:\n  impact.restitution: [0.4, 0.5]\n  cases.gap.gap: [1 cm, 2 cm, 3 cm]\n")))
    assert [axis.names for axis in plan.axes] == [("impact.restitution",), ("cases.gap.gap",)]
    assert plan.axes[0].values == ((0.4,), (0.5,))
    assert plan.axes[1].values == ((pytest.approx(0.01),), (pytest.approx(0.02),), (pytest.approx(0.03),))
    assert [row.point for row in plan.rows[::2]] == [(i, j) for i in range(2) for j in range(3)]
    for row in plan.rows:
        link = plan.scenes[row.scene].links[0]
        assert link.gap == pytest.approx(0.01 * (row.point[1] + 1))
    assert (
        plan.scenes[plan.rows[0].scene].links[0].law.damping_ratio
        > plan.scenes[plan.rows[-1].scene].links[0].law.damping_ratio
    )
    assert len({row.baselines for row in plan.rows}) == 2


def test_zipped_axis(study):
    plan = expand(
        study((END, END + "sweep:\n  - {buildings.stiff.period: [0.3 s, 0.4 s], cases.gap.gap: [1 cm, 2 cm]}\n"))
    )
    assert len(plan.axes) == 1
    assert plan.axes[0].names == ("buildings.stiff.period", "cases.gap.gap")
    assert len(plan.rows) == 2 * 2
    last = plan.scenes[plan.rows[-1].scene]
    assert last.buildings[0].periods[0] == pytest.approx(0.4)
    assert last.links[0].gap == pytest.approx(0.02)


def test_sweep_reaches_who_inherits(study):
    """`soft` is like `stiff`: a swept mass of `stiff` is that of `soft` too."""
    plan = expand(study((END, END + "sweep: {buildings.stiff.mass: [100 t, 300 t]}\n")))
    assert [plan.scenes[row.scene].buildings[1].mass[0] for row in plan.rows[::2]] == [1e5, 3e5]


def test_sweep_of_a_key_the_file_leaves_to_its_default(study):
    plan = expand(
        study(
            (
                END,
                END + "sweep: {impact.tension_cut: [false, true], buildings.soft.hardening: [0.02], tail: [0, 1 s]}\n",
            )
        )
    )
    assert plan.axes[0].values == (("false",), ("true",))
    assert {plan.scenes[row.scene].links[0].law.tension_cut for row in plan.rows} == {False, True}
    assert {plan.scenes[row.scene].tail for row in plan.rows} == {0.0, 1.0}
    assert {plan.scenes[row.baselines[0]].tail for row in plan.rows} == {0.0, 1.0}
    assert plan.scenes[plan.rows[0].scene].buildings[1].hardening[0] == 0.02


def test_sweep_of_records_and_of_texts(study):
    plan = expand(
        study(
            (
                END,
                END + "sweep:\n  records.scale: [1, {pga: 0.2 g}]\n"
                "  impact.stiffness: [5 x stiffest storey, 1e10 N/m]\n",
            )
        )
    )
    assert plan.axes[0].values == ((1.0,), ("{pga: 0.2 g}",))
    assert plan.axes[1].values == (("5 x stiffest storey",), (1e10,))
    assert len({plan.scenes[row.scene].motion.digest for row in plan.rows}) == 4


def test_sweep_of_an_entry_of_a_list(study):
    plan = expand(
        study(
            (GAP, "gap: {link: connector, gap: 5 cm, floors: [1]}"),
            (END, END + "sweep: {cases.gap.floors.0: [1, 3]}\n"),
        )
    )
    assert [plan.scenes[row.scene].links[0].left_floor for row in plan.rows[::2]] == [1, 3]


def test_combination_that_is_not_sound(study):
    """A floor 3 and two storeys: each value stands alone, together they do not; told with the point."""
    text = END + "sweep:\n  buildings.stiff.storeys: [3, 2]\n  cases.gap.floors: [[1], [3]]\n"
    read = study((GAP, "gap: {link: pounding, gap: 5 cm, floors: [1]}"), (END, text))
    with pytest.raises(InputError, match=r"no common floor 3 .*storeys = 2") as caught:
        expand(read)
    assert all(p.line and p.hint for p in caught.value.problems)


def test_repeated_scene_runs_once(study):
    """Sweeping what an elastic impact ignores: the rows differ, the scenes do not."""
    read = study((GAP, GAP + "\n  same: {link: pounding, gap: 50 mm}"))
    plan = expand(read)
    assert len(plan.rows) == 4
    assert len({row.scene for row in plan.rows}) == 2


def test_what_an_axis_does_not_touch_is_built_once(study, monkeypatch):
    """Three gaps, four durations of the motions, two periods: links at each gap, whatever the motion, and whatever the
    period of a building that they do not depend on. Fails if links are looked at at every point."""
    built = []
    real = LinkSets.number
    monkeypatch.setattr(LinkSets, "number", lambda *given: built.append(given) or real(*given))
    text = "sweep:\n  records.duration: [2 s, 3 s, 4 s, 5 s]\n  cases.gap.gap: [1 cm, 2 cm, 3 cm]\n"
    read = study((END, END + text + "  buildings.soft.period: [0.5 s, 0.7 s]\n"))
    plan = expand(read)
    assert len(plan.rows) == 24 * 2
    assert len(built) == 3


@pytest.mark.parametrize("stiffness", ["20 x stiffest storey", "1/5 mean storey of soft", "1e9 N/m"])
def test_links_that_are_known_are_those_of_the_point(study, stiffness):
    """The building that is swept is the softer and the stiffer one, and links stand on other floors where it has more.
    Fails if links are taken for those of a group, a case or an impact element that gives others, or if a scene is built
    with what another point has."""
    swept = (
        "sweep:\n  buildings.soft.period: [0.9 s, 0.6 s, 0.3 s, 0.2 s]\n  buildings.soft.storeys: [3, 2]\n"
        "  impact.restitution: [0.5, 0.7]\n  cases.gap.gap: [1 cm, 2 cm]\n"
    )
    found = study((END, END + swept), ("20 x stiffest storey", stiffness))
    plan, points = expand(found), {row.point for row in expand(found).rows}
    resolver, built = found.resolver, {}
    for point in points:
        reader = Links()  # knows none
        group, case = resolver.group(point), resolver.entry(point, "cases", "gap")
        built[point] = reader.of(case, group, resolver.root_at(point), ("cases", "gap"), Problems("study.yaml"))
    assert len(set(built.values())) == (8 if stiffness == "1e9 N/m" else 32 if "soft" in stiffness else 20)
    for row in plan.rows:
        scene = plan.scenes[row.scene]
        assert scene.links == built[row.point] == resolver.links(row.point, "gap")
        assert scene.buildings == tuple(resolver.group(row.point).buildings)
        assert (scene.digest, str(scene.analysis)) == (row.scene, row.analysis)
        assert [scene.alone(place).digest for place in (0, 1)] == list(row.baselines)
    for digest in np.random.default_rng(3).permutation(list(plan.scenes)).tolist():
        assert plan.scenes[digest].digest == digest


def test_expansion_is_the_same_twice(tmp_path):
    one, other = (expand(load_study("configs/sensitivity/taper.yaml")) for _ in range(2))
    assert one.rows == other.rows
    assert list(one.scenes) == list(other.scenes)


def test_fixed_step_method(study):
    plan = expand(study((END, END + "method: central-difference\ntime_step: 0.1 ms\n")))
    assert (plan.method, plan.time_step) == ("central-difference", pytest.approx(1e-4))
    assert plan.accuracy == 1e-6


def test_motions_and_separations_at_a_point_of_the_sweep(study):
    """What the tables say of a point: each motion's factor there, and the code's separation of the buildings there."""
    swept = "sweep:\n  records.scale: [1, 2]\n  buildings.soft.period: [0.6 s, 0.9 s]\n"
    found = study((END, END + swept))
    assert found.motions((1, 0))["taft"].use.scale == 2.0
    assert found.motions((1, 0))["taft"].use.pga == pytest.approx(2 * found.motions((0, 0))["taft"].use.pga)
    near, far = found.separations((0, 0)), found.separations((0, 1))
    assert near.shape == (2,)
    assert np.isnan(near[1])  # nothing stands to the right of the last
    assert near[0] == pytest.approx(found.resolved()["separation"][0])
    assert far[0] > near[0]  # the softer building sways more


def test_of_a_long_sweep_few_answers_of_single_points_are_kept():
    """Those of whole points never come back; those that an axis leaves alone come back at each of its values."""
    short, long = Answers([20, 300]), Answers([200, 300])
    for answers in (short, long):
        for first in range(200):
            answers.keep("group", (first, -1), first)
        for second in range(5000):
            answers.keep("links", (second // 300, second % 300), second)
    shared = [answers.get("group", (first, -1)) for answers in (short, long) for first in range(200)]
    assert shared == [*range(200)] * 2
    kept = [sum(answers.get("links", (n // 300, n % 300)) == n for n in range(5000)) for answers in (short, long)]
    assert kept == [5000, FEW_KEPT]
    assert long.get("links", (4999 // 300, 4999 % 300)) == 4999
