"""Widths of `pound gap` are what is required: a gap a millionth wider stays open, one a thousandth narrower closes.

`python tests/verification/test_required_gap.py STUDY.yaml ...` tries the scenes of any study."""

from __future__ import annotations

import dataclasses
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from pounding_cli.batch import run_plan
from pounding_cli.laws.pounding import Pounding
from pounding_cli.model.links import link_places
from pounding_cli.model.scene import Scene
from pounding_cli.solve import solve
from pounding_cli.store import open_results
from pounding_cli.study import load_study
from pounding_cli.study.gap import expand_gap

CONFIGS = Path(__file__).parents[2] / "configs"


@dataclass(frozen=True)
class Tried:
    """How many gaps were tried, how many of those a millionth wider than required closed, and how many of those a
    thousandth narrower stayed open at the floors that need most; the largest numerical error over the largest width."""

    gaps: int
    wider_closed: int
    narrower_open: int
    error: float


def tried(study: Path, folder: Path) -> Tried:
    """Every motion, analysis and pair of neighbours of a study, simulated with both gaps; what is required follows from
    `pound gap` at the study's accuracy."""
    plan = expand_gap(load_study(study))
    run_plan(plan, folder / "gap.h5", engine_name="serial", replace=True)
    results = open_results(folder / "gap.h5")
    link, table = results.link(), results.table("gap")
    count = wider_closed = narrower_open = 0
    for row in plan.rows:
        scene = plan.scenes[row.scene]
        here = link[(link["analysis"] == row.analysis) & (link["record"] == row.record)]
        for left in range(len(scene.buildings) - 1):
            widths = here[here["left"] == plan.buildings[left]].reset_index(drop=True)["max_closing"]
            required, place = float(widths.max()), int(widths.idxmax())
            count += 1
            wider_closed += impacts(scene, left, required * (1 + 1e-6)).sum() > 0
            narrower_open += impacts(scene, left, required * (1 - 1e-3))[place] == 0
    exact = table[table["rule"] == "exact"]
    return Tried(count, int(wider_closed), int(narrower_open), float(exact["error"].max() / exact["largest"].max()))


def impacts(scene: Scene, left: int, gap: float) -> np.ndarray:
    """Impacts at every link of a pair, named by the place of its left building; nothing between others."""
    law = Pounding(gap, 2e9, 0.2)
    links = [dataclasses.replace(link, law=law) for link in scene.links if link.left == left]
    places = link_places(links)
    links = [links[number] for number in sorted(range(len(links)), key=places.__getitem__)]  # as the tables have them
    whole = Scene(scene.buildings, tuple(links), scene.motion, scene.analysis, scene.tail)
    return solve(whole, accuracy=1e-9, all_effects=True).links.impacts


@pytest.mark.parametrize(("figure", "pairs"), [("fig6", 1), ("fig7", 2)])
def test_every_scene_of_a_figure(figure, pairs, tmp_path):
    """Every motion and analysis of Figs 6 and 7, every pair of neighbours. Fails if a closing is looked for at samples
    of the motion alone, if it is that of another floor or pair, or if buildings are not alone."""
    found = tried(CONFIGS / f"{figure}.yaml", tmp_path)
    assert (found.gaps, found.wider_closed, found.narrower_open) == (10 * pairs, 0, 0)
    assert found.error < 1e-6


def test_slabs_beside_columns(tmp_path):
    """Floors that do not line up. Fails if what is required beside columns is that of a floor, or is left out."""
    study = CONFIGS / "unequal-heights.yaml"
    found = tried(study, tmp_path)
    assert (found.gaps, found.wider_closed, found.narrower_open) == (10, 0, 0)
    table = open_results(tmp_path / "gap.h5").table("gap").query("rule == 'exact' and analysis == 'elastic'")
    assert table["columns"].tolist().count("") == 1
    assert len(table) == 8
    by_height = table.sort_values("height")
    assert by_height["mean"].is_monotonic_increasing  # both sway in their first modes above all
    rules = open_results(tmp_path / "gap.h5").table("gap").pivot_table("mean", ["analysis", "height"], "rule")
    assert (rules["ABS"] >= rules["exact"]).all()


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


if __name__ == "__main__":
    for name in sys.argv[1:]:
        with tempfile.TemporaryDirectory() as place:
            print(name, tried(Path(name), Path(place)))
