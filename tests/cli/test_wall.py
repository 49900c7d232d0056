"""`pound wall` from study file to results file, figures, fields and claims."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

from pounding_cli.cli.wall import command
from pounding_cli.errors import InputError
from pounding_cli.report.wall_claims import wall_claims
from pounding_cli.report.wall_figures import accuracy_figure
from pounding_cli.store.files import opened_kind
from pounding_cli.study.wall_study import load_wall_study
from pounding_cli.wall.analysis import strike

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
    folder, result = small
    assert result.exit_code == 0
    assert "contact.over = node, wall.length = 2 m\n  peak force 6.20 MN" in result.output
    assert "33.5 N/mm2 in an element" in result.output
    for name in ("small-history.png", "small-stress-0-0.svg", "small-wall-length.png"):
        assert (folder / name).stat().st_size > 5000


def test_results_open_as_xarray(small):
    folder, _ = small
    with xr.open_dataset(folder / "small.h5", engine="h5netcdf") as data:
        assert data["peak_force"].dims == ("contact.over", "wall.length")
        assert list(data["contact.over"].values) == ["node", "patch"]
        assert data["averaged_stress"].attrs["units"] == "N/m2"
        peak = float(data["peak_force"][0, 1])
    with xr.open_dataset(folder / "small.h5", engine="h5netcdf", group="points/0-1") as data:
        assert float(data["force"].max()) == pytest.approx(peak)
        impulse = np.trapezoid(data["force"], data["time"])
        assert impulse == pytest.approx(200e3 * (0.5 - float(data["velocity"][-1])), rel=1e-4)


def test_fields_open_in_meshio(small):
    folder, _ = small
    mesh = meshio.read(folder / "small" / "1-1.vtu")
    peak, envelope = (mesh.cell_data[name][0] for name in ("stress_peak", "stress_envelope"))
    assert len(mesh.cells[0].data) == len(peak)
    assert peak.max() == pytest.approx(envelope.max())
    assert (envelope >= peak).all()
    # The struck face is pushed away from the striker where it is struck, and the base stays.
    moved = mesh.point_data["displacement"]
    struck = np.argmin(np.hypot(mesh.points[:, 0], mesh.points[:, 1] - 13.4))
    assert moved[struck, 0] > 0.99 * moved[:, 0].max()
    assert np.abs(moved[mesh.points[:, 1] == 0]).max() == 0


def test_claims(small):
    folder, _ = small
    claims = wall_claims(folder / "small.h5")
    stress = [c for c in claims if "33 N/mm2" in c["paper"]]
    assert len(claims) == 12
    with xr.open_dataset(folder / "small.h5", engine="h5netcdf") as data:
        averaged = data["averaged_stress"].values.ravel() / 1e6
    assert [c["holds"] for c in stress] == [abs(a - 33) < 6.6 for a in averaged]
    assert {c["holds"] for c in stress} == {True, False}
    assert f"{averaged[1]:.1f} N/mm2 averaged" in stress[1]["found"]


@pytest.mark.parametrize("path", [CONFIGS / "fig8.yaml", *sorted(CONFIGS.glob("wall-*.yaml"))], ids=lambda p: p.stem)
def test_every_study_file_loads(path):
    study = load_wall_study(path)
    assert len(study.points) == int(np.prod([len(axis.nodes) for axis in study.axes]))
    assert len({repr(point.model) for point in study.points}) == len(study.points)


@pytest.mark.parametrize("path", sorted(CONFIGS.glob("wall-*.yaml")), ids=lambda p: p.stem)
def test_every_study_runs_at_its_first_point(path):
    found = strike(load_wall_study(path).points[0].model)
    assert found.peak_force > 0
    assert found.energy_residual < 5e-3


def test_figure_8(tmp_path):
    result = run(CONFIGS / "fig8.yaml", "-o", tmp_path / "fig8.h5", "--no-figures")
    assert "contact.over = node, mesh.size = 0.5 m\n  peak force 6.20 MN at 6.9 ms" in result.output
    claims = wall_claims(tmp_path / "fig8.h5")
    paper = {c["paper"]: c for c in claims if c["point"] == "contact.over = node, mesh.size = 0.5 m"}
    assert next(c for words, c in paper.items() if "33 N/mm2" in words)["holds"]
    assert next(c for words, c in paper.items() if "local" in words)["holds"]
    assert not next(c for words, c in paper.items() if "beams and columns" in words)["holds"]
    with xr.open_dataset(tmp_path / "fig8.h5", engine="h5netcdf") as data:
        under_node = data["wall_stress"].sel({"contact.over": "node"}).values / 1e6
    assert under_node == pytest.approx([22, 34, 63, 122], rel=0.1)


def test_accuracy_figure_shows_errors_that_fall(tmp_path):
    study = tmp_path / "a.yaml"
    study.write_text(
        "title: t\nmesh: {growth: 0}\ntime: {end: 12 ms, step: 0.2 ms}\n"
        "sweep: {mesh.element: [linear, quadratic], mesh.size: [1 m, 0.5 m, 0.25 m]}\n"
    )
    run(study, "-o", tmp_path / "a.h5", "--no-figures")
    with opened_kind(tmp_path / "a.h5", "wall") as file:
        lines = accuracy_figure(file).axes[0].get_lines()
    assert [len(line.get_ydata()) for line in lines] == [3, 2]
    for line in lines:
        assert (np.diff(line.get_ydata()) < 0).all()


def test_heights_in_words(tmp_path):
    study = tmp_path / "a.yaml"
    study.write_text(
        "title: t\nframe: {storeys: 3, storey_height: 4 m}\n"
        "sweep: {striker.height: [floor 2, mid-storey 1, 5 m], frame.storey_height: [3 m, 4 m]}\n"
    )
    heights = [point.model.striker.height for point in load_wall_study(study).points]
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
