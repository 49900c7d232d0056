"""`pound connector` and `pound wall`: from study file to tables and fields, and what stands beside the file."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from click.testing import CliRunner

from pounding_cli.cli.main import cli
from pounding_cli.paper import connector
from tests.night import NIGHTLY

CONFIGS = Path(__file__).parents[2] / "configs"
PAIR = "title: t\nsecond: {frequency_ratio: 0.6}\nconnector: {damping_ratio: 0}\nsweep: {damping: [5 %, 10 %]}\n"
WALL = (
    "title: small\nmesh: {size: 0.5 m, growth: 0, element: linear}\ntime: {end: 20 ms, step: 0.2 ms}\n"
    "sweep:\n  contact.over: [node, patch]\n  wall.length: [1 m, 2 m]\n"
)


def test_figure_5(folder, pound):
    """The ratios of the two masses against the ground are harmonics of one linear system: their sum is 2."""
    code, out, _ = pound("connector", CONFIGS / "fig5.yaml", "-o", "fig5.h5")
    assert code == 0
    assert re.search(r"5 +3\.980 +0\.7014 +4\.087", out)
    bands = "both systems move farther than alone at Ω/ω₁₀ = 0.652 to 0.772 and 1.086 to 1.163"
    assert f"damping = 5 %: {bands}" in out
    answer = " ".join(out.split())
    assert "increases the largest displacements of both systems" in answer
    assert "system 1 moves 2.241 (damping = 10 %) to 3.980 (damping = 5 %) times as far as alone" in answer
    with xr.open_dataset("fig5.h5", engine="h5netcdf") as data:
        assert data["R1"].dims == ("damping", "frequency")
        assert float(data["peak2"].sel(damping=0.10)) == pytest.approx(2.40, abs=0.01)
        assert float(abs(data["R1_real"] + data["R2_real"] - 2).max()) < 1e-12
        assert float(abs(data["R1_imag"] + data["R2_imag"]).max()) < 1e-12


def test_general_masses_and_no_connector(folder, pound):
    """Nothing joins them: each is an oscillator of its own, relative to the other's frequency (2 pi / 0.9 s)."""
    Path("a.yaml").write_text(
        "title: other\nfirst: {mass: 100 t, stiffness: 20 kN/mm, damping: 2 %}\n"
        "second: {mass: 300 t, period: 0.9 s}\nconnector: {stiffness: 0 N/m, damping_ratio: 0.1}\n"
    )
    _, out, _ = pound("connector", "a.yaml", "-o", "a.h5")
    assert f"{2 * np.pi / 0.9 / np.sqrt(20e6 / 100e3):.4g}" in out
    with xr.open_dataset("a.h5", engine="h5netcdf") as data:
        assert float(data["peak1"]) == pytest.approx(1.0, abs=1e-12)


def test_the_table_and_the_page_stand_beside_the_file(folder, pound):
    Path("a.yaml").write_text(PAIR)
    assert pound("connector", "a.yaml", "-o", "a.h5", "-q") == (0, "", "")
    table = pd.read_csv("a/tables/connector.csv")
    assert table["damping"].tolist() == [0.05, 0.10]
    assert table["peak1"].round(3).tolist() == [3.980, 2.241]
    page = Path("a/report.html").read_text(encoding="utf-8")
    assert "Spiliopoulos" in page
    for command in ("run", "cite"):
        code, _, err = pound(command, "a.yaml")
        assert (code, "`pound connector a.yaml`" in err) == (2, True), command
    code, _, err = pound("show", "a.h5")
    assert (code, "holds results of `pound connector`" in err) == (2, True)


def test_only_a_file_of_the_same_command_is_replaced(folder, pound):
    """Fails if any HDF5 file is: results of `pound run` would be lost."""
    Path("a.yaml").write_text(PAIR)
    Path("w.yaml").write_text("title: w\nmesh: {size: 1 m}\ntime: {end: 2 ms}\n")
    for _ in range(2):
        assert pound("connector", "a.yaml", "-o", "a.h5")[0] == 0
    pound("run", "two.yaml", "-o", "run.h5", "-q")
    xr.Dataset({"x": 1.0}).to_netcdf("mine.h5", engine="h5netcdf")
    before = {name: Path(name).read_bytes() for name in ("a.h5", "run.h5", "mine.h5")}
    for name in before:
        code, out, err = pound("wall", "w.yaml", "-o", name)
        assert (code, out, "was not written by this command" in err) == (2, "", True), name
    assert {name: Path(name).read_bytes() for name in before} == before


def test_a_damaged_file_of_the_same_command_is_replaced(folder, pound):
    """Fails if it is refused as another's."""
    Path("a.yaml").write_text(PAIR)
    assert pound("connector", "a.yaml", "-o", "a.h5", "-q")[0] == 0
    sound = Path("a.h5").read_bytes()
    Path("a.h5").write_bytes(sound[:-1] + bytes([sound[-1] ^ 1]))
    assert pound("connector", "a.yaml", "-o", "a.h5", "-q") == (0, "", "")


@pytest.fixture(scope="module")
def wall(tmp_path_factory):
    folder = tmp_path_factory.mktemp("wall")
    (folder / "small.yaml").write_text(WALL)
    done = CliRunner().invoke(cli, ["wall", str(folder / "small.yaml"), "-o", str(folder / "small.h5")])
    assert done.exit_code == 0, done.output
    return folder / "small.h5"


@pytest.mark.parametrize(
    ("command", "study", "reason"),
    [
        ("wall", "striker: {mass: 1e-9 kg}", "an impact this short"),
        ("wall", "sweep: {striker.mass: [1e-9 kg, 2e-9 kg]}", "an impact this short"),
        ("wall", "sweep: {striker.speed: [1 m/s, 1e200 m/s]}", "the response is not finite"),
        pytest.param(
            "wall", "sweep: {frame.storey_height: [3 m, 1e12 m]}", "a mesh of more than 250000 elements", marks=NIGHTLY
        ),
        pytest.param(
            "wall", "sweep: {striker.speed: [1 m/s, 1e-170 m/s]}", "the response is not finite", marks=NIGHTLY
        ),
        ("wall", "sweep: {wall.thickness: [1 m, 1e300 m]}", "refused: the stiffness matrix is singular"),
        ("connector", "sweep: {first.period: [0.5 s, 1e-200 s]}", "refused: numbers too large or too small to compute"),
        ("connector", "sweep: {first.mass: [100 t, 200 t, 1e300 kg]}", "the response is not finite"),
        ("connector", "sweep: {connector.stiffness: [0.2 k1, 1e300 N/m]}", "the response is not finite"),
    ],
)
def test_points_that_fail_are_told_and_have_no_numbers(folder, pound, command, study, reason):
    """One of two, both, or the only one; the table says why. Fails if such a number is shown as a result."""
    mesh = "mesh: {size: 1 m}\ntime: {end: 20 ms}\n" if command == "wall" else ""
    Path("s.yaml").write_text(f"title: t\n{mesh}{study}\n")
    code, out, err = pound(command, "s.yaml", "-o", "s.h5")
    table = pd.read_csv(f"s/tables/{command}.csv")
    failed = table["status"] != "done"
    assert (code, "Traceback" in err, "Warning" in err) == (1, False, False)
    assert err.count("failed: ") == err.count(reason) == failed.sum() > 0
    assert f"{failed.sum()} failed" in out
    assert table["status"][failed].str.contains(reason).all()
    numbers = table.loc[failed].drop(columns=["status", "seconds", *table.filter(like=".").columns])
    assert numbers.isna().all(axis=None)
    with xr.open_dataset("s.h5", engine="h5netcdf") as data:
        assert (data["status"].to_numpy().ravel() == table["status"]).all()


@pytest.mark.parametrize("fault", [IndexError, RecursionError, NotImplementedError])
def test_a_fault_in_one_point_leaves_the_others(folder, pound, monkeypatch, fault):
    usual = connector.COMMAND

    def solve(study):
        if study.damping > 0.08:
            raise fault("unforeseen")
        return usual.solve(study)

    monkeypatch.setattr(connector, "COMMAND", replace(usual, solve=solve))
    Path("a.yaml").write_text(PAIR)
    code, out, err = pound("connector", "a.yaml", "-o", "a.h5")
    assert (code, "Points: 1 solved, 1 failed" in out) == (1, True)
    assert f"failed: damping = 10 %: error: {fault.__name__}: unforeseen" in err
    assert "please report it" in err


def test_a_wall_takes_the_momentum_of_its_striker(wall):
    with xr.open_dataset(wall, engine="h5netcdf") as data:
        assert data["peak_force"].dims == ("contact.over", "wall.length")
        assert data["averaged_stress"].attrs["units"] == "N/m2"
        for over in range(2):
            for length in range(2):
                point = data.isel({"contact.over": over, "wall.length": length})
                assert float(point["force"].max()) == pytest.approx(float(point["peak_force"]))
                impulse = np.trapezoid(point["force"], point["time"])
                assert impulse == pytest.approx(200e3 * (0.5 - float(point["velocity"][-1])), rel=1e-3)


def test_a_point_that_fails_leaves_the_others(folder, pound):
    Path("w.yaml").write_text(
        "title: w\nmesh: {size: 1 m}\ntime: {end: 20 ms}\nsweep: {striker.mass: [200 t, 1e-6 kg]}\n"
    )
    code, _, err = pound("wall", "w.yaml", "-o", "w.h5")
    assert code == 1
    assert "failed: striker.mass = 1e-6 kg: refused: an impact this short" in err
    fine = Path("w.yaml").read_text().replace("size: 1 m", "size: 1 mm, growth: 0")
    Path("fine.yaml").write_text(fine)
    assert "elements\n    give a larger `mesh.size`" in pound("wall", "fine.yaml", "-o", "fine.h5")[2]
    frame = pd.read_csv("w/tables/wall.csv")
    assert np.isnan(frame["peak_force"]).tolist() == [False, True]
    assert frame["status"].str.partition(":")[0].tolist() == ["done", "refused"]
