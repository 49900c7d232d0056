"""The report of connector and wall files: claims, numbers, figures."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pandas as pd
import pytest

from pounding_cli.errors import InputError
from pounding_cli.report.systems import numbers, write_system_report
from pounding_cli.report.wall_claims import mesh_convergence
from pounding_cli.store.connector_store import write_connector
from pounding_cli.store.wall_store import write_wall
from pounding_cli.study.connector_study import load_connector_study
from pounding_cli.study.wall_study import load_wall_study
from tests.helpers.pages import words

CONFIGS = Path(__file__).parents[3] / "configs"


def test_report_of_figure_5(tmp_path):
    write_connector(load_connector_study(CONFIGS / "fig5.yaml"), tmp_path / "fig5.h5")
    files = write_system_report(tmp_path / "fig5.h5", tmp_path / "report", ("svg", "png"))
    assert {file.name for file in files} == {"fig5.svg", "fig5.png", "numbers.csv", "report.html"}
    verdicts = re.findall(r'badge (good|bad)"', (tmp_path / "report" / "report.html").read_text(encoding="utf-8"))
    assert verdicts == ["good", "bad", "good", "bad"]
    table = pd.read_csv(tmp_path / "report" / "numbers.csv")
    assert list(table["damping"]) == [0.05, 0.10]
    assert table["peak1"].to_numpy() == pytest.approx([3.98, 2.24], abs=0.01)


def test_page_of_figure_5_begins_with_the_figure_and_has_one_table_of_statements(tmp_path):
    write_connector(load_connector_study(CONFIGS / "fig5.yaml"), tmp_path / "fig5.h5")
    write_system_report(tmp_path / "fig5.h5", tmp_path / "report", ("png",))
    page = (tmp_path / "report" / "report.html").read_text()
    assert page.index("<h1>") < page.index("<img ") < page.index('<section id="claims"')
    table = page[page.index('<section id="claims"') :].split("</table>")[0]
    assert table.count("<tr>") == 1 + 2  # head, two dampings
    assert table.count("does not hold</span>") == 2


def test_the_numbers_of_the_page_are_in_the_units_of_the_study_and_in_usual_ones(tmp_path):
    """The time of separation was once shown as the mm of a gap. Fails if a column's unit is not the file's own."""
    study = tmp_path / "w.yaml"
    study.write_text("title: w\nmesh: {size: 0.5 m}\ntime: {end: 60 ms}\nsweep: {wall.thickness: [20 cm, 25 cm]}\n")
    found = write_wall(load_wall_study(study), tmp_path / "w.h5")
    write_system_report(tmp_path / "w.h5", tmp_path / "report", ("png",))
    page = (tmp_path / "report" / "report.html").read_text()
    (data,) = re.findall(r'<script type="application/json"[^>]*>(.*?)</script>', page, flags=re.DOTALL)
    columns = {column["key"]: column for column in json.loads(data)["tables"]["numbers"]["columns"]}
    shown = {key: (columns[key]["unit"], columns[key]["values"][1]) for key in columns}
    assert shown["wall.thickness"] == ("cm", 25)
    assert shown["separation"] == ("ms", pytest.approx(1e3 * found[1].separation, rel=1e-5))
    assert shown["peak_force"] == ("kN", pytest.approx(found[1].peak_force / 1e3, rel=1e-5))
    assert shown["wall_stress"] == ("N/mm²", pytest.approx(found[1].wall_stress / 1e6, rel=1e-5))
    heads = re.findall("<figcaption>(.*?)</figcaption>", page)
    assert heads[0].startswith("Stress in the wall, wall.thickness = ")
    assert "Peaks against wall.thickness" in heads
    assert len(set(heads)) == len(heads) == 4


def test_what_converges_comes_before_what_does_not(tmp_path):
    study = tmp_path / "w.yaml"
    sweep = "sweep: {contact.over: [node, patch], mesh.size: [0.25 m, 1 m, 0.5 m]}\n"
    study.write_text("title: w\ntime: {end: 15 ms}\nmesh: {growth: 0, element: linear}\n" + sweep)
    write_wall(load_wall_study(study), tmp_path / "w.h5")
    found = mesh_convergence(tmp_path / "w.h5")
    assert len(found) == 2 * 3
    assert [" settles (" in sentence for sentence in found] == sorted([" settles (" in one for one in found])[::-1]
    table = numbers(tmp_path / "w.h5").set_index(["contact.over", "mesh.size"])
    stress = table.loc["node", "wall_stress"].loc[[1.0, 0.5, 0.25]].to_numpy() / 1e6
    told = next(one for one in found if one.startswith("The stress of the worst element") and "node" in one)
    assert "does not settle (contact.over = node)" in told
    assert f"{stress[0]:.3g}, {stress[1]:.3g}, {stress[2]:.3g} N/mm2" in told
    assert f"{100 * (stress[2] / stress[1] - 1):+.0f} % at the last refinement" in told
    write_system_report(tmp_path / "w.h5", tmp_path / "report", ())
    page = (tmp_path / "report" / "report.html").read_text()
    assert page.index("at the last refinement") < page.index("does not hold</span>")


def test_report_of_a_wall_without_figures(tmp_path):
    study = tmp_path / "w.yaml"
    study.write_text("title: w\nmesh: {size: 0.5 m}\ntime: {end: 15 ms}\nsweep: {striker.speed: [0.5 m/s, 1 m/s]}\n")
    found = write_wall(load_wall_study(study), tmp_path / "w.h5")
    files = write_system_report(tmp_path / "w.h5", tmp_path / "report", ())
    assert {file.name for file in files} == {"numbers.csv", "report.html"}
    table = numbers(tmp_path / "w.h5")
    assert list(table["striker.speed"]) == [0.5, 1.0]
    assert table["peak_force"].to_numpy() == pytest.approx([r.peak_force for r in found])
    assert " holds " in words(tmp_path / "report" / "report.html", "claims")


def test_another_file_is_refused(tmp_path):
    (tmp_path / "x.h5").write_text("no")
    with pytest.raises(InputError, match="cannot be read as HDF5"):
        write_system_report(tmp_path / "x.h5", tmp_path / "report")
