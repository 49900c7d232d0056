"""What a plan is said to run is what a run of it then solves: which scenes, by which methods."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from pounding_cli.batch import run_plan
from pounding_cli.batch.forecast import ALONE, APART, GROUP, PARTS, forecast, methods_needed
from pounding_cli.laws.bouc_wen import BoucWen
from pounding_cli.model.scene import Analysis, Scene
from pounding_cli.solve import solve
from pounding_cli.solve.cost import BESIDE, NEW_LINKS, cost
from pounding_cli.store import open_results
from pounding_cli.study import expand, load_study

STUDY = """\
records: {use: [{file: weak.txt}], duration: whole}
buildings:
  stiff: {storeys: 3, period: 0.3 s}
  soft: {like: stiff, period: 0.5 s}
group: [stiff, soft]
cases:
  first: {link: pounding, gap: 50 cm}
analyses: [elastic]
estimate: none
"""

CONNECTED = ("link: pounding, gap: 50 cm", "link: connector, gap: 50 cm")
SMALL = ("storeys: 3", "storeys: 2")
TOUCHING = ("gap: 50 cm", "gap: 0 cm")
INELASTIC = ("[elastic]", "[inelastic]")
THREE = ("[stiff, soft]", "[stiff, soft, stiff]")
PAIR = ("link: pounding, gap: 50 cm", "link: pounding, gap: 50 cm, pairs: [pounding, {link: pounding, gap: 0 cm}]")
FIXED = ("estimate: none", "method: newmark\ntime_step: 1e-2 s\nestimate: none")


@pytest.fixture
def planned(tmp_path):
    """The plan of STUDY with replacements made, and the results of its run."""
    t = np.arange(0.0, 0.5, 0.01)
    np.savetxt(tmp_path / "weak.txt", np.column_stack([t, 0.1 * np.sin(12 * t)]))

    def make(*changes):
        text = STUDY
        for old, new in changes:
            assert old in text
            text = text.replace(old, new)
        (tmp_path / "a.yaml").write_text(text)
        plan = expand(load_study(tmp_path / "a.yaml"))
        run_plan(plan, tmp_path / "a.h5", engine_name="serial")
        return plan, open_results(tmp_path / "a.h5")

    return make


@pytest.mark.parametrize(
    ("changes", "methods", "of_rows"),
    [
        ((), {"exponential", "taylor"}, {"exponential, taylor"}),  # the gap never closes: one run shows it
        ((TOUCHING,), {"exponential", "taylor"}, {"taylor"}),
        ((CONNECTED, SMALL), {"exponential"}, {"exponential"}),
        ((CONNECTED,), {"exponential", "taylor"}, {"taylor"}),
        ((INELASTIC,), {"taylor"}, {"taylor"}),
        ((THREE, PAIR), {"exponential", "taylor"}, {"exponential, taylor"}),
        ((FIXED,), {"newmark"}, {"newmark"}),
    ],
)
def test_methods_said_are_methods_taken(planned, changes, methods, of_rows):
    """Fails if buildings alone, proofs or the groups of a row are left out."""
    plan, results = planned(*changes)
    assert methods_needed(plan) == set(results.methods) == methods
    assert set(results.scene().method) == of_rows


ROW = """\
records: {use: [{file: shake.txt}], duration: whole}
buildings:
  stiff: {storeys: 3, period: 0.3 s}
  soft: {like: stiff, period: 0.5 s}
  slow: {like: stiff, period: 0.7 s}
group: [stiff, soft, slow, stiff]
cases:
  row: {link: pounding, gap: 50 cm, pairs: [§]}
analyses: [elastic]
estimate: none
"""

WIDE, CLOSE, TOUCHING = (f"{{link: pounding, gap: {gap}}}" for gap in ("50 cm", "1 mm", "0 cm"))
JOINED = "{link: connector, gap: 50 cm}"


@pytest.fixture
def shaken(tmp_path):
    """The plan of ROW with its pairs, and what a run of it in fact solved: (buildings, method) -> times."""
    t = np.arange(0.0, 0.5, 0.01)
    np.savetxt(tmp_path / "shake.txt", np.column_stack([t, 0.3 * np.sin(12 * t)]))

    def make(pairs, *changes):
        text = ROW.replace("§", ", ".join(pairs))
        for old, new in changes:
            assert old in text
            text = text.replace(old, new)
        (tmp_path / "a.yaml").write_text(text)
        plan = expand(load_study(tmp_path / "a.yaml"))
        solved = Counter()

        def counting(scene, **words):
            response = solve(scene, **words)
            apart = not all(link.law.can_close for link in scene.links)
            solved["apart" if apart else len(scene.buildings), response.method] += 1
            return response

        run_plan(plan, tmp_path / "a.h5", solve=counting, engine_name="serial")
        return plan, solved

    return make


ANOTHER = (
    "analyses:",
    "  other: {link: pounding, gap: 60 cm, pairs: [{gap: 60 cm}, {gap: 0 cm}, {gap: 60 cm}]}\nanalyses:",
)


@pytest.mark.parametrize(
    ("pairs", "changes", "smaller", "apart", "whole"),
    [
        ((WIDE, WIDE, WIDE), (), {}, 3, 0),
        ((WIDE, TOUCHING, WIDE), (), {2: 1}, 1, 0),  # the two that touch stand between: all are run together
        ((WIDE, CLOSE, WIDE), (), {2: 1}, 1, 0),  # found to meet when each is run alone
        ((WIDE, TOUCHING, CLOSE), (), {2: 1, 3: 1}, 1, 0),  # the two that touch reach the third
        ((CLOSE, TOUCHING, CLOSE), (), {2: 1}, 0, 1),  # and here both neighbours: all of it is solved
        ((TOUCHING, WIDE, TOUCHING), (), {2: 2}, 1, 0),
        ((TOUCHING, WIDE, JOINED), (), {2: 2}, 1, 0),  # the one by series, the other by exact steps
        ((TOUCHING, TOUCHING, TOUCHING), (), {}, 0, 1),
        ((WIDE, TOUCHING, WIDE), (ANOTHER,), {2: 1}, 1, 0),  # another case asks for the same ones once more
    ],
)
def test_proven_forecasts_count_what_a_run_solves(shaken, pairs, changes, smaller, apart, whole):
    """Fails if smaller groups, or neighbours kept apart, are left out, counted once a row, counted before they are
    known to be run, or priced by another method."""
    plan, solved = shaken(pairs, *changes)
    sizes, counted = Counter(), Counter()
    for (size, method), count in solved.items():
        sizes[size] += count
        counted[{1: ALONE, 4: GROUP, "apart": APART}.get(size, PARTS), method] += count
    assert sizes == Counter({1: 3, **smaller, "apart": apart, 4: whole})
    found = forecast(plan, prove=True)
    assert found.scenes == counted
    assert set(found.seconds) == set(counted)
    assert min(found.seconds.values()) > 0


def test_without_proof_smaller_groups_are_counted_that_are_sure_to_run(shaken, monkeypatch):
    """Priced as what they are, and nothing is solved for it. Fails if what only a run can tell is looked into, or a row
    that touches all along is taken for a smaller group."""
    one, _ = shaken((TOUCHING, TOUCHING, TOUCHING))
    plan, _ = shaken((WIDE, TOUCHING, CLOSE), ANOTHER)
    monkeypatch.setattr("pounding_cli.solve.solve", lambda *_, **__: 1 / 0)
    assert forecast(one, prove=False).scenes == {(ALONE, "exponential"): 3, (GROUP, "taylor"): 1}
    found = forecast(plan, prove=False)
    assert found.scenes == {(ALONE, "exponential"): 3, (PARTS, "taylor"): 1, (GROUP, "taylor"): 2}
    scene = plan.scenes[plan.rows[0].scene]
    pair = Scene(
        scene.buildings[1:3],
        tuple(replace(link, left=0) for link in scene.links[3:6]),
        scene.motion,
        scene.analysis,
        scene.tail,
    )
    assert found.seconds[PARTS, "taylor"] == cost(pair, "taylor") + BESIDE
    assert found.seconds[GROUP, "taylor"] == pytest.approx(2 * (cost(scene, "taylor") + BESIDE + NEW_LINKS))


def test_smooth_storeys_cost_more_where_they_yield(shaken):
    """Fails if a row of Bouc-Wen storeys is promised in the time of a bilinear one, or an elastic one is not."""
    plan, _ = shaken((TOUCHING, TOUCHING, TOUCHING))
    scene = plan.scenes[plan.rows[0].scene]
    smooth = tuple(replace(building, storey_law=BoucWen) for building in scene.buildings)
    for analysis, least, most in ((Analysis.INELASTIC, 20.0, 200.0), (Analysis.ELASTIC, 1.0, 1.0)):
        plain = replace(scene, analysis=analysis)
        assert least <= cost(replace(plain, buildings=smooth), "taylor") / cost(plain, "taylor") <= most


@pytest.mark.parametrize("prove", [False, True])
def test_where_rows_stay_whole_there_are_no_smaller_groups(shaken, prove):
    """All effects, or steps of the user's own."""
    plan, _ = shaken((WIDE, TOUCHING, WIDE))
    assert forecast(replace(plan, all_effects=True), prove).scenes == {(ALONE, "taylor"): 3, (GROUP, "taylor"): 1}
    plan, solved = shaken((WIDE, TOUCHING, WIDE), FIXED)
    assert solved == {(1, "newmark"): 3, (4, "newmark"): 1}
    assert forecast(plan, prove).scenes == {(ALONE, "newmark"): 3, (GROUP, "newmark"): 1}


@pytest.mark.parametrize("analyses", ["[elastic]", "[elastic, inelastic]"])
def test_scenes_of_a_point_share_the_cost_of_their_links(planned, analyses):
    """Fails if elastic and inelastic scenes, which stand between the same links, each pay for links of their own."""
    plan, _ = planned(("gap: 50 cm", "gap: 0 cm"), ("[elastic]", analyses))
    found = forecast(plan, prove=False)
    solver = sum(cost(plan.scenes[row.scene], "taylor") for row in plan.rows)
    assert found.seconds[GROUP, "taylor"] - solver - len(plan.rows) * BESIDE == pytest.approx(NEW_LINKS)


@pytest.mark.parametrize("prove", [True, False])
def test_rows_are_timed(planned, monkeypatch, prove):
    """Fails if rows take as long as a formula says although some were run, or if time beside the solver grows too."""
    plan, _ = planned(("gap: 50 cm", "gap: 0 cm"), ("[elastic]", "[elastic, inelastic]"))
    scenes = [plan.scenes[row.scene] for row in plan.rows]

    def slow(scene, *arguments, **told):
        return replace(solve(scene, *arguments, **told), seconds=3.0 * cost(scene, "taylor"))

    monkeypatch.setattr("pounding_cli.solve.solve", slow)
    found = forecast(plan, prove)
    assert found.timed == (2 if prove else 0)
    solver = (3.0 if prove else 1.0) * sum(cost(scene, "taylor") for scene in scenes)
    assert found.seconds[GROUP, "taylor"] == pytest.approx(solver + 2 * BESIDE + NEW_LINKS)


def test_few_rows_of_many_are_timed(planned, monkeypatch):
    """Spread evenly, within the time that a plan may take."""
    monkeypatch.setattr("pounding_cli.batch.forecast.MOST_TIMED", 3)
    swept = "sweep: {impact.restitution: [0.4, 0.45, 0.5, 0.55, 0.6, 0.65, 0.7]}\nestimate"
    plan, _ = planned(("gap: 50 cm", "gap: 0 cm"), ("estimate", swept))
    ran = []

    def noted(scene, *arguments, **told):
        ran.append(scene.digest)
        return solve(scene, *arguments, **told)

    monkeypatch.setattr("pounding_cli.solve.solve", noted)
    assert forecast(plan, True).timed == 3
    rows = [row.scene for row in plan.rows]
    assert [rows.index(digest) for digest in dict.fromkeys(ran) if digest in rows] == [0, 3, 6]
