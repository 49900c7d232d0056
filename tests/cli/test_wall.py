"""`pound wall` from study file to results file, figures, fields and claims."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import h5py
import meshio
import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

from pounding_cli.cli.main import cli
from pounding_cli.cli.wall import command
from pounding_cli.errors import InputError
from pounding_cli.report.wall import STATEMENTS, write_fields
from pounding_cli.report.wall_figures import draw_accuracy
from pounding_cli.store import open_results
from pounding_cli.store.points import read_points
from pounding_cli.study.system_study import load_system
from pounding_cli.wall.analysis import strike
from tests.helpers.pages import words

CONFIGS = Path(__file__).parents[2] / "configs"


def run(*arguments):
    return CliRunner().invoke(command, [str(a) for a in arguments], catch_exceptions=False)


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    folder = tmp_path_factory.mktemp("wall")
    study = folder / "small.yaml"
    study.write_text(
        "title: small\nmesh: {size: 0.5 m, growth: 0, element: linear}\ntime: {end: 20 ms, step: 0.2 ms}\n"
        "sweep:\n  contact.over: [node, patch]\n  wall.length: [1 m, 2 m]\n"
    )
    return folder, run(study, "-o", folder / "small.h5")


def test_summary_and_files(small):
    _, result = small
    assert result.exit_code == 0
    assert "contact.over = node, wall.length = 2 m\n  peak force 6.20 MN" in result.output
    assert "33.5 N/mm2 in an element" in result.output


def test_results_open_as_xarray(small):
    folder, _ = small
    with xr.open_dataset(folder / "small.h5", engine="h5netcdf") as data:
        assert data["peak_force"].dims == ("contact.over", "wall.length")
        assert list(data["contact.over"].values) == ["node", "patch"]
        assert data["averaged_stress"].attrs["units"] == "N/m2"
        peak = float(data["peak_force"][0, 1])
        assert data["force"].dims == ("contact.over", "wall.length", "instant")
        point = data.isel({"contact.over": 0, "wall.length": 1})
        assert float(point["force"].max()) == pytest.approx(peak)
        impulse = np.trapezoid(point["force"], point["time"])
        assert impulse == pytest.approx(200e3 * (0.5 - float(point["velocity"][-1])), rel=1e-4)
        there = np.isfinite(data["stress_peak"][0]).sum(axis=-1)
        assert there.to_numpy().tolist() == [2 * 30, 4 * 30]  # elements of half a metre, padded


def test_fields_open_in_meshio(small):
    folder, _ = small
    mesh = meshio.read(write_fields(list(read_points(open_results(folder / "small.h5"))), folder)[-1])
    peak, envelope = (mesh.cell_data[name][0] for name in ("stress_peak", "stress_envelope"))
    assert len(mesh.cells[0].data) == len(peak)
    assert peak.max() == pytest.approx(envelope.max())
    assert (envelope >= peak).all()
    # The struck face is pushed away from the striker where it is struck, and the base stays.
    moved = mesh.point_data["displacement"]
    struck = np.argmin(np.hypot(mesh.points[:, 0], mesh.points[:, 1] - 13.4))
    assert moved[struck, 0] > 0.99 * moved[:, 0].max()
    assert np.abs(moved[mesh.points[:, 1] == 0]).max() == 0


def holds(path, label):
    """Whether each statement holds at a point, and what was found."""
    point = next(point for point in read_points(open_results(path)) if point.label == label)
    return [judge(point.values) for _, judge in STATEMENTS]


def test_the_stress_is_judged_by_its_average(small):
    folder, _ = small
    found = []
    with xr.open_dataset(folder / "small.h5", engine="h5netcdf") as data:
        for over, length in (("node", 1), ("node", 2), ("patch", 1), ("patch", 2)):
            mean = float(data["averaged_stress"].sel({"contact.over": over, "wall.length": length})) / 1e6
            is_so, words = holds(folder / "small.h5", f"contact.over = {over}, wall.length = {length} m")[0]
            assert is_so == (abs(mean - 33) < 6.6)
            assert f"{mean:.1f} N/mm2 averaged" in words
            found.append(is_so)
    assert set(found) == {True, False}


def same_but_times(one, other):
    """Whether two results files hold the same bits in every variable."""
    with h5py.File(one) as first, h5py.File(other) as second:
        named = [name for name in first if isinstance(first[name], h5py.Dataset) and name != "seconds"]
        assert len(named) > 40
        return all(
            first[name][()].tobytes() == second[name][()].tobytes()
            if first[name].dtype != object
            else (first[name][()] == second[name][()]).all()
            for name in named
        )


@pytest.mark.parametrize("engine", ["threads", "processes"])
def test_every_engine_gives_the_same_bits(small, engine, tmp_path, monkeypatch):
    """Fails if a response depends on the process or the thread that solves it."""
    monkeypatch.setattr("pounding_cli.batch.runner.WORTH_WORKERS", 0.0)
    folder, _ = small
    result = run(folder / "small.yaml", "-o", tmp_path / "r.h5", "--engine", engine, "--workers", 2)
    assert "Points: 4 solved, 0 reused, 0 failed, 2 side by side" in result.output
    assert same_but_times(folder / "small.h5", tmp_path / "r.h5")


def test_a_killed_sweep_goes_on(tmp_path):
    """Fails if points that are solved are not kept, not found, or not the same as those of a run nobody killed."""
    study, output = tmp_path / "w.yaml", tmp_path / "w.h5"
    study.write_text(
        "title: w\nmesh: {size: 0.1 m}\ntime: {end: 60 ms, step: 0.02 ms}\n"
        "sweep: {wall.length: {from: 1 m, to: 3 m, step: 0.25 m}}\n"
    )
    command = [sys.executable, "-c", "from pounding_cli.cli.main import main; main()", "wall", str(study), "-o"]
    running = subprocess.Popen([*command, str(output), "--workers", "2", "-q"], start_new_session=True)
    deadline = time.monotonic() + 120
    while not list(tmp_path.glob("w.h5.parts/*.part")) and time.monotonic() < deadline:
        time.sleep(0.01)
    os.killpg(running.pid, signal.SIGKILL)
    running.wait()
    assert not output.exists()
    result = run(study, "-o", output, "--workers", 1)
    solved, reused = map(int, re.findall(r"Points: (\d+) solved, (\d+) reused", result.output)[0])
    assert solved + reused == 9
    assert solved > 0
    assert reused > 0
    assert not list(tmp_path.glob("w.h5.parts*"))
    run(study, "-o", tmp_path / "whole.h5", "--workers", 1)
    assert same_but_times(output, tmp_path / "whole.h5")


def test_a_point_that_fails_leaves_the_others(tmp_path):
    study = tmp_path / "w.yaml"
    study.write_text("title: w\nmesh: {size: 1 m}\ntime: {end: 20 ms}\nsweep: {striker.mass: [200 t, 1e-6 kg]}\n")
    result = run(study, "-o", tmp_path / "w.h5")
    assert result.exit_code == 1
    assert "failed: striker.mass = 1e-06: refused: an impact this short needs" in result.stderr
    assert "give an earlier `time.end`" in result.stderr
    frame = open_results(tmp_path / "w.h5").answer("wall").frame
    assert frame["status"].str.startswith("refused").tolist() == [False, True]
    assert np.isnan(frame["peak_force"]).tolist() == [False, True]
    CliRunner().invoke(cli, ["report", str(tmp_path / "w.h5"), "-o", str(tmp_path / "r")], catch_exceptions=False)
    assert "striker.mass = 1e-09 t – – –" in words(tmp_path / "r" / "report.html", "claims")


@pytest.mark.parametrize("path", [CONFIGS / "fig8.yaml", *sorted(CONFIGS.glob("wall-*.yaml"))], ids=lambda p: p.stem)
def test_every_study_file_loads(path):
    study = load_system(path, "wall")
    assert len(study.points) == int(np.prod([len(axis.nodes) for axis in study.axes]))
    assert len({repr(point.model) for point in study.points}) == len(study.points)


@pytest.mark.parametrize("path", sorted(CONFIGS.glob("wall-*.yaml")), ids=lambda p: p.stem)
def test_every_study_runs_at_its_first_point(path):
    found = strike(load_system(path, "wall").points[0].model)
    assert found.peak_force > 0
    assert found.energy_residual < 5e-3


def test_figure_8(tmp_path):
    result = run(CONFIGS / "fig8.yaml", "-o", tmp_path / "fig8.h5")
    assert "contact.over = node, mesh.size = 0.5 m\n  peak force 6.20 MN at 6.9 ms" in result.output
    found = holds(tmp_path / "fig8.h5", "contact.over = node, mesh.size = 0.5 m")
    assert [is_so for is_so, _ in found] == [True, False, True]  # 33 N/mm2; beams and columns low; local
    with xr.open_dataset(tmp_path / "fig8.h5", engine="h5netcdf") as data:
        under_node = data["wall_stress"].sel({"contact.over": "node"}).values / 1e6
    assert under_node == pytest.approx([22, 34, 63, 122], rel=0.1)


def test_accuracy_figure_shows_errors_that_fall(tmp_path):
    study = tmp_path / "a.yaml"
    study.write_text(
        "title: t\nmesh: {growth: 0}\ntime: {end: 12 ms, step: 0.2 ms}\n"
        "sweep: {mesh.element: [linear, quadratic], mesh.size: [1 m, 0.5 m, 0.25 m]}\n"
    )
    run(study, "-o", tmp_path / "a.h5")
    results = open_results(tmp_path / "a.h5")
    lines = draw_accuracy(results, results.answer("wall").frame).axes[0].get_lines()
    assert [len(line.get_ydata()) for line in lines] == [3, 2]
    for line in lines:
        assert (np.diff(line.get_ydata()) < 0).all()


def test_heights_in_words(tmp_path):
    study = tmp_path / "a.yaml"
    study.write_text(
        "title: t\nframe: {storeys: 3, storey_height: 4 m}\n"
        "sweep: {striker.height: [floor 2, mid-storey 1, 5 m], frame.storey_height: [3 m, 4 m]}\n"
    )
    heights = [point.model.striker.height for point in load_system(study, "wall").points]
    assert heights == [6.0, 8.0, 1.5, 2.0, 5.0, 5.0]


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("title: t\nwall: {lenght: 2 m}\n", 2, "lenght"),
        ("title: t\nwall: {length: 2 kN}\n", 2, "2 kN"),
        ("title: t\nstriker:\n  height: floor 9\n", 3, "floor 9"),
        ("title: t\nstriker: {height: floor five}\n", 2, "floor five"),
        ("title: t\nconcrete: {poisson: 0.5}\n", 2, "0.5"),
        ("title: t\ncontact: {over: edge}\n", 2, "edge"),
        ("title: t\nmesh: {size: 0.1 mm, growth: 0}\n", 2, "elements"),
        ("title: t\nstriker: {height: 0 m}\ncontact: {over: node}\n", 2, "fixed node"),
        ("title: t\nsweep:\n  wall.length: []\n", 3, "no values"),
        ("title: t\nsweep:\n  - {wall.length: [1 m, 2 m], wall.thickness: [20 cm]}\n", 3, "as many values"),
        ("wall: {length: 2 m}\n", 1, "'title' is missing"),
    ],
)
def test_refused(tmp_path, text, line, words):
    study = tmp_path / "bad.yaml"
    study.write_text(text)
    with pytest.raises(InputError) as refused:
        run(study)
    assert any(words in str(p) and p.line == line and p.hint for p in refused.value.problems), str(refused.value)
