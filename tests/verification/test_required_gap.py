"""Widths of `pound gap` are what is required: a gap a millionth wider stays open, one a thousandth narrower closes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from pounding_cli.batch import run_plan
from pounding_cli.laws.pounding import Pounding
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Scene
from pounding_cli.solve import solve
from pounding_cli.store import open_results
from pounding_cli.study import load_study
from pounding_cli.study.gap import expand_gap

CONFIGS = Path(__file__).parents[2] / "configs"


def impacts(scene: Scene, gaps: dict[int, float]) -> np.ndarray:
    """Impacts at every link of a pair whose gap is given by the place of its left building; nothing between others."""
    links = tuple(
        Link(link.left, link.left_floor, link.right_floor, Pounding(gaps[link.left], 2e9, 0.2))
        for link in scene.links
        if link.left in gaps
    )
    whole = Scene(scene.buildings, links, scene.motion, scene.analysis, scene.tail)
    return solve(whole, accuracy=1e-9, all_effects=True).links.impacts


@pytest.mark.parametrize("figure", ["fig6", "fig7"])
def test_every_scene_of_a_figure(figure, tmp_path):
    """Every motion and analysis of Figs 6 and 7, every pair of neighbours. Fails if a closing is looked for at samples
    of the motion alone, if it is that of another floor or pair, or if buildings are not alone."""
    plan = expand_gap(load_study(CONFIGS / f"{figure}.yaml"))
    run_plan(plan, tmp_path / "gap.h5", engine_name="serial")
    results = open_results(tmp_path / "gap.h5")
    link = results.link()
    table = results.table("gap")
    tried = 0
    for row in plan.rows:
        scene = plan.scenes[row.scene]
        here = link[(link["analysis"] == row.analysis) & (link["record"] == row.record)]
        for left in range(len(scene.buildings) - 1):
            widths = here[here["left"] == plan.buildings[left]].set_index("floor")["max_closing"]
            required = float(widths.max())
            assert impacts(scene, {left: required * (1 + 1e-6)}).sum() == 0
            closed = impacts(scene, {left: required * (1 - 1e-3)})
            assert closed[int(widths.idxmax()) - 1] > 0
            tried += 1
    assert tried == 10 * (len(plan.buildings) - 1)
    exact = table[table["rule"] == "exact"]
    assert exact["error"].max() < 1e-6 * exact["largest"].max()


def test_links_and_swept_links_mean_nothing(tmp_path):
    """Fails if the gap of a case, or a swept one, changes what is required."""
    study = """\
records: {{use: [elcentro], duration: 3 s}}
buildings: {{A: {{storeys: 3, period: 0.3 s}}, B: {{storeys: 2, period: 0.5 s}}}}
group: [A, B]
cases: {{one: {{link: {link}}}}}
impact: {{stiffness: 1e9 N/m}}
{more}
"""
    found = []
    for link, more in (("none", ""), ("pounding, gap: 0 cm", "sweep: {cases.one.gap: [1 mm, 2 mm]}")):
        path = tmp_path / "study.yaml"
        path.write_text(study.format(link=link, more=more))
        run_plan(expand_gap(load_study(path)), tmp_path / f"{len(found)}.h5", engine_name="serial")
        found.append(open_results(tmp_path / f"{len(found)}.h5"))
    assert [results.axes for results in found] == [{}, {}]
    one, other = (results.table("gap").drop(columns="rule") for results in found)
    assert one.equals(other)
