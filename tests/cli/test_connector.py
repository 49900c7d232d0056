"""`pound connector` from study file to results file, figure and claims."""

from __future__ import annotations

import os
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

import pounding_cli
from pounding_cli.cli.connector import command
from pounding_cli.cli.main import cli
from pounding_cli.errors import InputError
from pounding_cli.store import open_results
from pounding_cli.study.system_study import load_system

FIG5 = Path(__file__).parents[2] / "configs" / "fig5.yaml"


def run(*arguments):
    return CliRunner().invoke(command, [str(a) for a in arguments], catch_exceptions=False)


def test_figure_5(tmp_path):
    out = tmp_path / "fig5.h5"
    result = run(FIG5, "-o", out)
    assert result.exit_code == 0
    assert "|R1| at most 3.980 at Omega/omega10 = 0.701" in result.output
    assert "0.652-0.772, 1.086-1.163" in result.output
    assert "\ndamping = 5 %\n" in result.output
    with xr.open_dataset(out, engine="h5netcdf") as data:
        assert data["R1"].dims == ("damping", "frequency")
        assert float(data["peak2"].sel(damping=0.10)) == pytest.approx(2.40, abs=0.01)
        identity = data["R1_real"] + data["R2_real"], data["R1_imag"] + data["R2_imag"]
        assert float(abs(identity[0] - 2).max()) < 1e-12
        assert float(abs(identity[1]).max()) < 1e-12


def test_no_sweep_general_masses_and_no_bands(tmp_path):
    study = tmp_path / "a.yaml"
    study.write_text(
        "title: other\nfirst: {mass: 100 t, stiffness: 20 kN/mm, damping: 2 %}\n"
        "second: {mass: 300 t, period: 0.9 s}\nconnector: {stiffness: 0 N/m, damping_ratio: 0.1}\n"
    )
    result = run(study, "-o", tmp_path / "a.h5")
    assert "both ratios exceed 1 in: nowhere" in result.output
    assert "(alone: 1, 0.4937)" in result.output  # (2 pi / 0.9) / sqrt(20e6 / 100e3)
    with xr.open_dataset(tmp_path / "a.h5", engine="h5netcdf") as data:
        assert float(data["peak1"]) == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("title: t\nsecond: {frequncy_ratio: 0.6}\n", 2, "frequncy_ratio"),
        ("title: t\ndamping: 3 m\n", 2, "3 m"),
        ("title: t\nsecond: {mass: 1 t}\n", 2, "no frequency"),
        ("title: t\nsecond: {period: 1 s, frequency_ratio: 0.5}\n", 2, "cannot both"),
        ("title: t\nsweep: {dampng: [1 %]}\n", 2, "dampng"),
        ("title: t\nsweep:\n  damping: 5 %\n", 3, "not a list"),
        ("title: t\nsweep:\n  damping: [5 %, -1]\n", 3, "damping"),
        ("title: t\nsweep: {frequencies.low: [0.1, 0.2]}\n", 2, "cannot be an axis"),
        ("title: t\nsweep: {first: [1, 2]}\n", 2, "whole section"),
        ("title: t\nfrequencies: {low: 2, high: 1}\n", 2, "not below"),
        ("title: t\nconnector: {stiffness: soft}\n", 2, "soft"),
    ],
)
def test_refused(tmp_path, text, line, words):
    study = tmp_path / "bad.yaml"
    study.write_text(text)
    with pytest.raises(InputError) as refused:
        run(study)
    assert any(words in str(p) and p.line == line and p.hint for p in refused.value.problems), str(refused.value)


def test_the_connector_in_newtons_and_with_a_dashpot_of_its_own(tmp_path):
    study = tmp_path / "a.yaml"
    study.write_text(
        "title: t\nfirst: {mass: 1 kg, stiffness: 4 N/m}\nsecond: {mass: 2 kg, stiffness: 6 N/m}\n"
        "sweep:\n  - {connector.stiffness: [3 N/m, 1/2 k1]}\n"
    )
    pairs = [point.model.pair for point in load_system(study, "connector").points]
    assert [pair.stiffness for pair in pairs] == [3.0, 2.0]
    assert pairs[0].p == pytest.approx(np.sqrt(3.0 / 4.0))
    study.write_text("title: t\nconnector: {dashpot: 5 kN s/m}\nfirst: {damping: 1 %}\nsecond: {frequency_ratio: 2}\n")
    pair = load_system(study, "connector").points[0].model.pair
    assert (pair.dashpot, pair.zeta1, pair.zeta2) == (5000.0, 0.01, 0.05)
    study.write_text("title: t\nconnector: {damping_ratio: 0.1}\nsecond: {frequency_ratio: 2}\n")
    pair = load_system(study, "connector").points[0].model.pair
    assert pair.dashpot == pytest.approx(0.2 * np.sqrt(pair.stiffness * 100e3))


def test_an_older_file_is_named_as_such_and_replaced(tmp_path):
    """Files of before had no `format`, and `kind` in place of `workflow`."""
    older = tmp_path / "older.h5"
    with h5py.File(older, "w") as file:
        file.attrs["kind"], file.attrs["title"] = "connector", "Two"
        file.attrs["study_file"] = os.path.relpath(FIG5, tmp_path)
    with pytest.raises(InputError, match="results of `pound connector` in its former format") as refused:
        open_results(older)
    assert "pound connector STUDY" in refused.value.problems[0].hint
    assert run(FIG5, "-o", older).exit_code == 0
    assert open_results(older).tables == ("connector",)


def test_a_point_that_is_there_is_not_solved_again(tmp_path):
    study = tmp_path / "a.yaml"
    study.write_text("title: t\nsecond: {frequency_ratio: 0.6}\nsweep: {damping: [5 %, 10 %]}\n")
    run(study, "-o", tmp_path / "a.h5")
    study.write_text("title: t\nsecond: {frequency_ratio: 0.6}\nsweep: {damping: [40 %, 5 %, 10 %]}\n")
    result = run(study, "-o", tmp_path / "a.h5")
    assert "Points: 1 solved, 2 reused, 0 failed" in result.output
    assert "kept are points 2 of 3" in result.stderr
    with xr.open_dataset(tmp_path / "a.h5", engine="h5netcdf") as data:
        assert data["both_above"].dims == ("damping", "band", "edge")
        assert [int(np.isfinite(bands).sum()) for bands in data["both_above"]] == [2, 4, 4]  # padded with NaN


def pound(*arguments):
    return CliRunner().invoke(cli, [str(a) for a in arguments], catch_exceptions=False)


def test_every_command_takes_the_study_and_its_results(tmp_path):
    """Fails if a command still takes each results file for one of buildings."""
    study, other = tmp_path / "a.yaml", tmp_path / "b.yaml"
    study.write_text("title: t\nsecond: {frequency_ratio: 0.6}\nsweep: {damping: [5 %, 10 %]}\n")
    other.write_text("title: t\nsecond: {frequency_ratio: 0.6}\nsweep: {damping: [5 %, 12 %]}\n")
    for path in (study, other):
        assert pound("connector", path, "-o", path.with_suffix(".h5"), "-q").exit_code == 0
    planned = pound("plan", study).output
    assert "sweep      damping: 5 %; 10 %\npoints     2: pound connector solves 2 points\n" in planned
    assert "10  2.241" in pound("show", tmp_path / "a.h5").output
    same = pound("compare", tmp_path / "a.h5", tmp_path / "a.h5")
    assert same.exit_code == 0
    assert "Numbers: 0 of 14 differ" in same.output
    told = pound("compare", tmp_path / "a.h5", tmp_path / "b.h5")
    assert told.exit_code == 1
    assert "Scenes: 1 removed, 1 added, 0 with another outcome.\n  - 0.1\n  + 0.12\n" in told.output
    assert "Numbers: 0 of 7 differ" in told.output
    assert (
        pound("export", tmp_path / "a.h5", "-o", tmp_path / "out").exit_code,
        (tmp_path / "out" / "connector.csv").exists(),
    ) == (0, True)
    with pytest.raises(InputError, match="has no table storey") as refused:
        pound("show", tmp_path / "a.h5", "storey")
    assert refused.value.problems[0].hint == "it has: connector"


def test_in_python(tmp_path):
    study = tmp_path / "a.yaml"
    study.write_text("title: t\nsecond: {frequency_ratio: 0.6}\nsweep: {damping: [5 %, 10 %]}\n")
    results = pounding_cli.run(study, tmp_path / "a.h5", workflow="connector")
    assert repr(results) == f"Results('t': swept damping (2), 2 scenes; {tmp_path / 'a.h5'})"
    assert "3.98" in results._repr_html_()
    assert results.dataset["R1"].dims == ("damping", "frequency")
    assert results.methods == ()
    with pytest.raises(InputError, match="has no table scene"):
        results.scene()
