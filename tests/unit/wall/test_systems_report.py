"""The report of connector and wall files: claims, numbers, figures."""

from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest

from pounding_cli.errors import InputError
from pounding_cli.report.systems import numbers, write_system_report
from pounding_cli.store.connector_store import write_connector
from pounding_cli.store.wall_store import write_wall
from pounding_cli.study.connector_study import load_connector_study
from pounding_cli.study.wall_study import load_wall_study

CONFIGS = Path(__file__).parents[3] / "configs"


def test_report_of_figure_5(tmp_path):
    write_connector(load_connector_study(CONFIGS / "fig5.yaml"), tmp_path / "fig5.h5")
    files = write_system_report(tmp_path / "fig5.h5", tmp_path / "report", ("svg", "png"))
    assert {file.name for file in files} == {"fig5.svg", "fig5.png", "numbers.csv", "report.html", "summary.md"}
    text = (tmp_path / "report" / "summary.md").read_text()
    rows = [line for line in text.splitlines() if line.startswith("| damping")]
    assert [row.rsplit("|", 2)[1].strip() for row in rows] == ["yes", "no", "yes", "no"]
    assert "(fig5.png)" in text
    table = pd.read_csv(tmp_path / "report" / "numbers.csv")
    assert list(table["damping"]) == [0.05, 0.10]
    assert table["peak1"].to_numpy() == pytest.approx([3.98, 2.24], abs=0.01)


def test_report_of_a_wall_without_figures(tmp_path):
    study = tmp_path / "w.yaml"
    study.write_text("title: w\nmesh: {size: 0.5 m}\ntime: {end: 15 ms}\nsweep: {striker.speed: [0.5 m/s, 1 m/s]}\n")
    found = write_wall(load_wall_study(study), tmp_path / "w.h5")
    files = write_system_report(tmp_path / "w.h5", tmp_path / "report", ())
    assert {file.name for file in files} == {"numbers.csv", "report.html", "summary.md"}
    table = numbers(tmp_path / "w.h5")
    assert list(table["striker.speed"]) == [0.5, 1.0]
    assert table["peak_force"].to_numpy() == pytest.approx([r.peak_force for r in found])
    assert "| yes |" in (tmp_path / "report" / "summary.md").read_text()


def test_another_file_is_refused(tmp_path):
    (tmp_path / "x.h5").write_text("no")
    with pytest.raises(InputError, match="cannot be read as HDF5"):
        write_system_report(tmp_path / "x.h5", tmp_path / "report")
