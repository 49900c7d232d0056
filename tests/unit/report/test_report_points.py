"""The report of points of a model of its own: statements, tables, figures, page."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pandas as pd
import pytest

import pounding_cli as pound
from pounding_cli.report.build import write_report
from pounding_cli.report.wall import mesh_convergence
from tests.helpers.pages import words

CONFIGS = Path(__file__).parents[3] / "configs"


def results_of(tmp_path, kind, text):
    """Results of a study in a few lines, or of one of ours."""
    study = text if isinstance(text, Path) else tmp_path / "w.yaml"
    if study is not text:
        study.write_text(text)
    return pound.run(study, tmp_path / "w.h5", workflow=kind, engine="serial")


def test_report_of_figure_5(tmp_path):
    results = results_of(tmp_path, "connector", CONFIGS / "fig5.yaml")
    files = write_report(results, tmp_path / "report", ("svg", "png"))
    assert {file.name for file in files} == {"ratios.svg", "ratios.png", "connector.csv", "report.html"}
    said = words(tmp_path / "report" / "report.html", "claims")
    assert re.findall("damping = [0-9]+ %|holds:|does not hold:", said) == [
        "damping = 5 %", "holds:", "does not hold:", "damping = 10 %", "holds:", "does not hold:"
    ]  # fmt: skip
    table = pd.read_csv(tmp_path / "report" / "tables" / "connector.csv")
    assert list(table["damping"]) == [0.05, 0.10]
    assert table["peak1"].to_numpy() == pytest.approx([3.98, 2.24], abs=0.01)
    assert "system 1" in (tmp_path / "report" / "ratios.svg").read_text()


def test_page_of_figure_5_begins_with_the_figure_and_has_one_table_of_statements(tmp_path):
    results = results_of(tmp_path, "connector", CONFIGS / "fig5.yaml")
    write_report(results, tmp_path / "report", ("png",))
    page = (tmp_path / "report" / "report.html").read_text()
    assert page.index("<h1>") < page.index("<img ") < page.index('<section id="claims"')
    table = page[page.index('<section id="claims"') :].split("</table>")[0]
    assert table.count("<tr>") == 1 + 2  # head, two dampings
    assert table.count("does not hold: ") == 2


def test_the_numbers_of_the_page_are_in_the_units_of_the_study_and_in_usual_ones(tmp_path):
    """The time of separation was once shown as the mm of a gap. Fails if a column's unit is not the file's own."""
    results = results_of(
        tmp_path,
        "wall",
        "title: w\nmesh: {size: 0.5 m}\ntime: {end: 60 ms}\nsweep: {wall.thickness: [20 cm, 25 cm]}\n",
    )
    write_report(results, tmp_path / "report", ("png",))
    page = (tmp_path / "report" / "report.html").read_text()
    (data,) = re.findall(r'<script type="application/json"[^>]*>(.*?)</script>', page, flags=re.DOTALL)
    columns = {column["key"]: column for column in json.loads(data)["tables"]["wall"]["columns"]}
    shown = {key: (columns[key]["unit"], columns[key].get("values", [0, 0])[1]) for key in columns}
    found = results.table("wall").iloc[1]
    assert shown["wall.thickness"] == ("cm", 25)
    assert shown["separation"] == ("ms", pytest.approx(1e3 * found["separation"], rel=1e-5))
    assert shown["peak_force"] == ("kN", pytest.approx(found["peak_force"] / 1e3, rel=1e-5))
    assert shown["wall_stress"] == ("N/mm²", pytest.approx(found["wall_stress"] / 1e6, rel=1e-5))
    heads = re.findall("<figcaption>(.*?)</figcaption>", page)
    assert heads[0] == "Stress in the wall, wall.thickness = 25 cm"
    assert "Peaks against wall.thickness" in heads
    assert len(set(heads)) == len(heads) == 4
    assert {file.name for file in (tmp_path / "report" / "fields").iterdir()} == {"point-0.vtu", "point-1.vtu"}


def test_what_converges_comes_before_what_does_not(tmp_path):
    sweep = "sweep: {contact.over: [node, patch], mesh.size: [0.25 m, 1 m, 0.5 m]}\n"
    study = "title: w\ntime: {end: 15 ms}\nmesh: {growth: 0, element: linear}\n" + sweep
    results = results_of(tmp_path, "wall", study)
    found = mesh_convergence(results)
    assert len(found) == 2 * 3
    assert [" settles (" in sentence for sentence in found] == sorted([" settles (" in one for one in found])[::-1]
    table = results.table("wall").set_index(["contact.over", "mesh.size"])
    stress = table.loc["node", "wall_stress"].loc[[1.0, 0.5, 0.25]].to_numpy() / 1e6
    told = next(one for one in found if one.startswith("The stress of the worst element") and "node" in one)
    assert "does not settle (contact.over = node)" in told
    assert f"{stress[0]:.3g}, {stress[1]:.3g}, {stress[2]:.3g} N/mm2" in told
    assert f"{100 * (stress[2] / stress[1] - 1):+.0f} % at the last refinement" in told
    files = write_report(results, tmp_path / "report", ())
    assert {file.name for file in files} == {"wall.csv", "report.html"}
    page = (tmp_path / "report" / "report.html").read_text()
    assert page.index("at the last refinement") < page.index("does not hold: ")
