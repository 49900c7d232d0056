"""The whole report: files, page, sensitivity and comparison."""

from __future__ import annotations

import json

import numpy as np
import pandas as pd
import pytest

from pounding_cli.errors import InputError
from pounding_cli.report import figures
from pounding_cli.report.build import nominal, write_comparison, write_report
from pounding_cli.report.evidence import points
from tests.helpers.pages import words
from tests.helpers.report_tables import CASES, make


def test_report_holds_page_figures_and_every_table(tmp_path):
    results = make(cases=tuple(CASES))
    files = write_report(results, tmp_path, ("png",))
    assert all(path.exists() for path in files)
    whole = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert whole.count("<img ") == whole.count(' alt="') == len(list(tmp_path.glob("*.png"))) == 7
    assert "Largest mean V/V₀, elastic: touching 1.46 (storey 5)" in whole
    for table in ("storey", "floor", "link", "scene", "summary", "records", "buildings", "claims"):
        assert (tmp_path / "tables" / f"{table}.csv").exists()
    read = pd.read_csv(tmp_path / "tables" / "storey.csv")
    np.testing.assert_array_equal(read["V_ratio"], results.storey()["V_ratio"])
    assert not (tmp_path / "claims-sensitivity.md").exists()


def test_page_tells_motions_key_numbers_and_claims(tmp_path):
    write_report(make(sources={"taft": "real"}), tmp_path, ())
    page = words(tmp_path / "report.html")
    assert "Motions: real: taft; stand-in: elcentro, eureka, olympia, parkfield." in page
    # Touching, top storey: 1.4 x 1.04 = 1.46 elastic; 1.2 times that inelastic; 12 times the acceleration.
    assert " touching 1.46 storey 5 6.12 g floor 1, 12.0× 1.75 storey 5 6.12 g floor 1, 12.0× " in page
    assert "holds infill accelerations There is more than 80% reduction to the accelerations [by the infill]." in page
    assert "Runs 40 all done" in page
    assert "No run raised a flag." in page
    assert "<img " not in (tmp_path / "report.html").read_text(encoding="utf-8")


def test_page_tells_flags_and_failed_runs(tmp_path):
    results = make(flags="connector closed beyond its gap: stiff|soft floor 5")
    scene = results.scene()
    scene.loc[[0, 1], ["status", "advice"]] = ["event bound reached", "loosen the accuracy"]
    write_report(results, tmp_path, ())
    page = words(tmp_path / "report.html")
    assert "Runs 40 2 failed" in page
    assert "touching, elastic, elcentro event bound reached loosen the accuracy" in page
    flags = words(tmp_path / "report.html", "simulated").split(" Flags ")[1]
    assert flags.startswith("touching, elastic, 5 of 5 scenes (all): connector closed beyond its gap")
    assert flags.count("(e.g. stiff|soft floor 5)") == 8  # four cases, two analyses


def test_a_sweep_without_claims_has_no_page_of_them(tmp_path):
    write_report(make(axis=("impact.restitution", [0.4, 0.5]), resolved={"claims": None}), tmp_path, ())
    assert not (tmp_path / "claims-sensitivity.md").exists()
    assert "claim" not in words(tmp_path / "report.html").lower()


def test_sweep_gives_the_verdict_at_every_value(tmp_path):
    results = make(axis=("impact.restitution", [0.4, 0.5, 0.65]), resolved={"claims": "fig7"})
    frame = results.storey()
    gap = frame["case"] == "gap"
    level = frame.loc[gap, "impact.restitution"].map({0.4: 1.0, 0.5: 1.05, 0.65: 1.3})
    frame.loc[gap, "V_ratio"] = level
    frame.loc[gap, "mu_ratio"] = level
    write_report(results, tmp_path, ())
    page = (tmp_path / "claims-sensitivity.md").read_text(encoding="utf-8")
    assert "| [code-gap](#code-gap) | holds | holds | does not hold |" in page
    changes = [line for line in page.splitlines() if line.startswith("- ")]
    assert changes == ["- code-gap: *holds*, but *does not hold* at impact.restitution = 0.65"]
    words = "V/V0, elastic: largest mean over the storeys of stiff, with the gap"
    assert f"| {words} | 1.000 | 1.050 | **1.300** |" in page
    table = pd.read_csv(tmp_path / "tables" / "claims.csv")
    row = table[(table["finding"] == words) & (table["where"] == "impact.restitution = 0.65")].iloc[0]
    assert row["number"] == 1.3
    assert row["verdict"] == "does not hold"


def test_page_of_a_sweep_shows_the_point_of_the_study_itself(tmp_path):
    results = make(
        axis=("impact.restitution", [0.4, 0.5, 0.65]),
        resolved={"claims": "fig6", "impact": {"restitution": 0.5}},
    )
    assert nominal(points(results)).point == {"impact.restitution": 0.5}
    elsewhere = make(axis=("impact.restitution", [0.4, 0.65]), resolved={"impact": {"restitution": 0.5}})
    assert nominal(points(elsewhere)).point == {"impact.restitution": 0.4}
    write_report(results, tmp_path, ())
    assert "At impact.restitution = 0.5." in words(tmp_path / "report.html")


def test_comparison_sets_several_results_side_by_side(tmp_path):
    one = make()
    other = make(resolved={"claims": "fig7"})
    write_comparison({"fig6": one, "fig7": other}, tmp_path)
    page = (tmp_path / "comparison.md").read_text(encoding="utf-8")
    assert "| claim | fig6 | fig7 |" in page
    assert "Every verdict is the same everywhere." in page
    assert "| [narrow-gap](#narrow-gap) | holds | – |" in page
    assert "| [code-gap](#code-gap) | – | holds partly |" in page
    assert set(pd.read_csv(tmp_path / "comparison.csv")["where"]) == {"fig6", "fig7"}


def test_many_points_become_the_rows_of_the_comparison(tmp_path):
    swept = make(axis=("impact.restitution", [0.3, 0.4, 0.5, 0.6]))
    write_comparison({"one": swept, "two": make(axis=("taper", [0.2, 0.3, 0.4]))}, tmp_path)
    page = (tmp_path / "comparison.md").read_text(encoding="utf-8")
    assert "|  | [infill-response](#infill-response) |" in page
    assert "| one: impact.restitution = 0.6 | holds | holds |" in page
    closing = page.split("## connection-closing")[1].split("## ")[0]
    assert "1. largest closing of a connector over its gap" in closing
    assert "| two: taper = 0.2 | holds | 80 % | 100 % |" in closing


def test_results_that_name_no_figure_are_told_so(tmp_path):
    results = make(resolved={"claims": None})
    write_report(results, tmp_path, ())
    assert "claim" not in words(tmp_path / "report.html").lower()
    write_comparison({"a": results, "b": results}, tmp_path)
    assert "No results here name a figure" in (tmp_path / "comparison.md").read_text(encoding="utf-8")


def test_a_folder_that_cannot_be_made_is_refused(tmp_path):
    (tmp_path / "taken").write_text("")
    with pytest.raises(InputError, match=r"the output folder .* cannot be written"):
        write_report(make(), tmp_path / "taken", ())


def test_of_many_cases_figures_and_pages_show_a_part_and_the_tables_all(tmp_path, monkeypatch):
    monkeypatch.setattr(figures, "MOST_CASES", 2)
    results = make(cases=("gap", "infill", "connected", "touching"), resolved={"report": {"plot": ["touching"]}})
    write_report(results, tmp_path, ("svg",))
    page = (tmp_path / "report.html").read_text()
    assert "This page shows 2 of the 4 cases." in page
    data = json.loads(page.split('id="data">')[1].split("</script>")[0])
    assert data["cases"] == ["touching", "gap"]  # those that the study plots first
    assert data["tables"]["storey"]["rows"] == 2 * 2 * 5 * 2 * 5
    assert data["tables"]["storey"]["total"] == 4 * 2 * 5 * 2 * 5
    drawn = (tmp_path / "stiff-response.svg").read_text()
    assert "touching" in drawn
    assert "infill" not in drawn
    assert set(pd.read_csv(tmp_path / "tables" / "storey.csv")["case"]) == {"gap", "infill", "connected", "touching"}
