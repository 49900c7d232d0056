"""`pound fragility`: what it prints, its page, and a bad question."""

from __future__ import annotations

import re

import numpy as np
import pytest

import pounding_cli
from pounding_cli.report.fragility import _ALONE, MOST_CASES
from pounding_cli.report.fragility_text import subject
from pounding_cli.report.style import looks
from pounding_cli.store import open_results

STUDY = """\
title: Two small buildings
records: {use: [elcentro, taft, olympia, parkfield], duration: 3 s, scale: {pga: 0.1 g}}
buildings:
  A: {storeys: 2, period: 0.3 s}
  B: {like: A, storeys: 1, period: 0.5 s}
group: [A, B]
cases: {near: {link: pounding, gap: 3 mm}}
analyses: [inelastic]
estimate: none
sweep: {records.scale.pga: {from: 0.05 g, to: 1 g, step: 0.05 g}}
fragility: {limits: [mu > 4, contact]}
"""


def test_prints_curves_and_reports_them(pound, tmp_path):
    code, out, err = pound("fragility", "two.yaml")
    assert code == 0
    assert "warning" not in err
    assert "Intensity: peak ground acceleration" in out
    assert "median [g]" in out
    table = open_results(tmp_path / "results" / "two-fragility.h5").table("fragility")
    fitted = table[table["median"].notna()].iloc[0]
    assert f"{fitted['median'] / 9.80665:.3g} (" in out
    assert "In brackets: 90 % interval of 1000 bootstrap draws" in out
    code, out, _ = pound("report", "results/two-fragility.h5", "-q")
    assert code == 0
    folder = tmp_path / "results" / "two-fragility"
    assert (folder / "fragility-inelastic.png").stat().st_size > 10_000
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert "<h1" in page
    assert "Intensity at which half of the motions pass" in page
    assert "mu &gt; 4" in page
    assert re.search(r"median: [\d.]+ g \([\d.]+ to [\d.]+ g\) alone", page)
    code, out, _ = pound("cite", "results/two-fragility.h5")
    assert "Vamvatsikos" in out
    assert "Baker" in out


def test_a_building_alone_looks_like_no_case():
    names = ["touching", "gap", "infill", "connected", *"abcdef"]
    for number in range(len(names)):
        drawn = list(looks(names[number:]).values())[:MOST_CASES]
        assert _ALONE.color not in {look.color for look in drawn}


@pytest.mark.parametrize(
    ("building", "limit", "words"),
    [
        ("soft", "mu > 4", "soft, mu > 4"),
        ("soft", "collapse in soft", "collapse in soft"),
        ("soft", "mu > 4 in soft storey 1", "mu > 4 in soft storey 1"),
        ("soft-1", "mu > 4 in soft", "soft-1, mu > 4 in soft"),
    ],
)
def test_a_building_is_named_once(building, limit, words):
    assert subject(building, limit) == words


def test_the_plain_grid_tells_the_same_brackets(pound, tmp_path):
    """Solved at every level, each motion first passes where the search said."""
    pound("fragility", "two.yaml", "-q")
    found = open_results(tmp_path / "results" / "two-fragility.h5").table("fragility_motions")
    grid = pounding_cli.run(tmp_path / "two.yaml", tmp_path / "grid.h5", engine="serial").storey()
    key = "records.scale.pga"
    checked = 0
    for name, column in (("passed", "mu"), ("passed0", "mu0")):
        peaks = grid.groupby(["building", "record", key])[column].max()
        for row in found[found["limit"] == "mu > 4"].to_dict("records"):
            mine = peaks.loc[row["building"], row["record"]]
            above = mine[mine > 4]
            assert row[name] == pytest.approx(above.index.min() if len(above) else np.inf)
            checked += 1
    assert checked == 16


def test_a_limit_without_a_unit_is_refused_at_its_place(pound, tmp_path):
    (tmp_path / "two.yaml").write_text(STUDY.replace("contact]", "acceleration > 1]"))
    code, _, err = pound("fragility", "two.yaml")
    assert code == 2
    assert "two.yaml:11:30: " in err
    assert "write e.g. `acceleration > 1 g`" in err
    assert not (tmp_path / "results").exists()
