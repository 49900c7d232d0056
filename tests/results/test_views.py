"""Results and histories as a person looks at them: lines, tables, datasets, curves; shorter buildings included."""

from __future__ import annotations

import copy
import pickle

import matplotlib as mpl
import numpy as np
import pandas as pd
import pytest
from click.testing import CliRunner

import pounding_cli as pound
from pounding_cli.cli.main import cli
from pounding_cli.questions.run.tables import build_peaks_table
from pounding_cli.results import arrays, columns
from pounding_cli.results.compare import compare
from tests.night import NIGHTLY

STUDY = {
    "title": "A <b>bold</b> title",
    "records": {"use": ["elcentro"], "duration": "3 s"},
    "buildings": {"stiff": {"storeys": 5, "period": "0.36 s"}, "soft": {"storeys": 3, "period": "0.60 s"}},
    "group": ["stiff", "soft"],
    "cases": {"gap": {"link": "pounding", "gap": "2 cm"}, "none": {"link": "none"}},
    "estimate": "none",
    "keep": "histories",
}


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    return pound.run(STUDY, tmp_path_factory.mktemp("api") / "r.h5", engine="serial")


@pytest.fixture
def plt(monkeypatch):
    """pyplot without a window, its figures closed at the end."""
    with mpl.rc_context({"backend": "agg"}):
        from matplotlib import pyplot

        pyplot.switch_backend("agg")
        yield pyplot
        pyplot.close("all")


def test_results_in_a_line_and_as_a_table(results):
    line = repr(results)
    assert line.startswith("Results('A <b>bold</b> title': 2 buildings (stiff, soft), 2 cases (gap, none), 2 analyses")
    assert "\n" not in line
    table = results._repr_html_()
    assert "A &lt;b&gt;bold&lt;/b&gt; title" in table
    worst = results.summary().query("case == 'gap' and analysis == 'elastic' and building == 'stiff'")
    assert f"<td>{worst['V_ratio_mean'].max():.3f}</td>" in table


def test_a_file_that_is_gone_still_shows_itself(results, tmp_path):
    copy = tmp_path / "copy.h5"
    copy.write_bytes(results.path.read_bytes())
    opened = pound.open_results(copy)
    copy.unlink()
    assert str(copy) in repr(opened)


def test_the_dataset_has_units_and_coordinates(results):
    data = results.dataset
    assert data["V"].dims == ("case", "analysis", "record", "building", "storey")
    assert data["V"].attrs["units"] == "N"
    assert list(data["storey"].values) == [1, 2, 3, 4, 5]
    roof = results.storey().query("case == 'gap' and analysis == 'elastic' and building == 'soft' and storey == 3")
    at = {"case": "gap", "analysis": "elastic", "record": "elcentro", "building": "soft"}
    assert float(data["V"].sel(storey=3, **at)) == roof["V"].item()
    assert np.isnan(data["V"].sel(storey=5, **at))
    results.path.rename(results.path)  # nothing holds the file
    assert data["seconds"].dtype == float


OPERATIONS = {
    "deep copy": lambda results: copy.deepcopy(results).storey(),
    "pickle": lambda results: pickle.loads(pickle.dumps(results)).storey(),
    "copied dataset": lambda results: results.data.copy(deep=True).to_dataframe(),
    "sorted dataset": lambda results: results.data.sortby("case")["mu"].to_dataframe(),
    "picked values": lambda results: results.data["mu"].isel(storey=[4, 0, 2]).to_dataframe(),
    "process": lambda results: pickle.loads(pickle.dumps(results.data)).to_dataframe(),
    "first sample": lambda results: results.cut({}).storey(),
    "compare": lambda results: compare(results, results).changes,
    "largest": lambda results: build_peaks_table(results).frame,
    **{name: (lambda results, name=name: results.table(name)) for name in columns.TABLES},
}


@NIGHTLY
@pytest.mark.parametrize("operation", OPERATIONS.values(), ids=OPERATIONS)
def test_values_that_are_read_when_they_are_asked_for_are_those_that_are_read_at_once(results, monkeypatch, operation):
    """Fails where an operation copies or pickles the open file behind large arrays, which HDF5 refuses."""
    at_once = operation(pound.open_results(results.path))
    monkeypatch.setattr(arrays, "MIN_STORED", 0)
    when_asked = operation(pound.open_results(results.path))
    pd.testing.assert_frame_equal(when_asked, at_once)


@pytest.mark.parametrize(
    "command", ["compare r.h5 r.h5", "export r.h5 -o x.nc", "show r.h5", "report r.h5 --no-figures"]
)
def test_commands_on_values_that_are_read_when_they_are_asked_for(results, monkeypatch, tmp_path, command):
    monkeypatch.setattr(arrays, "MIN_STORED", 0)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "r.h5").write_bytes(results.path.read_bytes())
    done = CliRunner().invoke(cli, command.split(), catch_exceptions=False)
    assert done.exit_code == 0


def test_a_history_is_copied_and_pickled(results):
    history = results.history(case="gap", analysis="elastic")
    for copied in (copy.deepcopy(history), pickle.loads(pickle.dumps(history))):
        assert np.array_equal(copied.drift, history.drift, equal_nan=True)


def test_a_history_as_frames_without_floors_that_do_not_exist(results):
    """Fails if shorter buildings come with empty columns, or columns are named by place."""
    history = results.history(case="gap", analysis="elastic")
    drift = history.frame("drift")
    assert [b for b, _ in drift.columns] == ["stiff"] * 5 + ["soft"] * 3
    assert drift.columns.names == ["building", "storey"]
    assert drift["soft", 3].to_numpy() == pytest.approx(history.drift[:, 1, 2])
    assert drift.index.name == "time"
    assert drift.attrs["units"] == "m"
    assert list(history.frame("link_force").columns) == [f"stiff|soft floor {n}" for n in (1, 2, 3)]
    assert list(history.frame("energy").columns)[:2] == ["input", "kinetic"]
    assert history.frame("ground_acceleration").shape == (history.time.size, 1)
    assert results.history(case="none", analysis="elastic").frame("link_force").shape == (history.time.size, 0)
    with pytest.raises(pound.InputError, match="no quantity 'drifts'"):
        history.frame("drifts")


def test_closings_are_those_of_the_tables(results):
    """The largest closing every 2 ms against the located peak. Fails if floors or signs are mixed up."""
    history = results.history(case="gap", analysis="elastic")
    link = results.link().query("case == 'gap' and analysis == 'elastic'")
    assert history.closing.max(axis=0) == pytest.approx(link["max_closing"].to_numpy(), rel=5e-3)
    top = history.largest().loc[("closing", "stiff|soft floor 3"), "largest"]
    assert top == pytest.approx(link["max_closing"].max(), rel=5e-3)


def test_floors_of_a_link_at_different_numbers():
    """3 m and 6 m storeys: floor 2 meets floor 1. Fails if the right floor is taken for the left one."""
    low = pound.building("low", storeys=2, period=0.3)
    high = pound.building("high floor 3", storeys=1, period=0.5, height=6.0)
    scene = pound.scene([low, high], pound.motion("elcentro", duration=3.0), gap="1 cm", analysis="elastic")
    history = pound.history(scene, every="0.5 ms")
    closing = pound.solve(scene).links.max_closing
    assert history.links == ("low|high floor 3 floor 2|1",)
    assert history.closing.max() == pytest.approx(closing[0], rel=1e-3)


@pytest.mark.parametrize("foundation", [None, {"inertia": "1000 t m2", "rocking_stiffness": "5e9 N m"}])
def test_closings_at_columns_are_those_of_the_struck_point(foundation):
    """A slab between two floors of its neighbour, also over a rocking base. Fails if the closing of the floors is told
    in place of that of the point."""
    low = pound.building("low", storeys=1, period=0.3)
    keys = {"foundation": foundation} if foundation else {}
    high = pound.building("high", storeys=2, period=0.6, height=["2 m", "2 m"], columns="20 %", **keys)
    scene = pound.scene([low, high], pound.motion("elcentro", duration=3.0), gap="1 cm", analysis="elastic")
    history = pound.history(scene, every="0.5 ms")
    assert history.links == ("low|high floor 1|2, right columns",)
    assert history.closing.max() == pytest.approx(pound.solve(scene).links.max_closing[0], rel=1e-3)


def test_a_history_in_a_line_as_a_table_and_as_a_dataset(results):
    history = results.history(case="gap", analysis="elastic")
    assert repr(history) == "History(stiff, soft; 3 links; 3 s every 2 ms, 1501 times)"
    assert "stiff|soft floor 3" in history._repr_html_()
    data = history.dataset
    assert data["shear"].attrs["units"] == "N"
    assert data["shear"].sel(building="soft", storey=1).values == pytest.approx(history.shear[:, 1, 0])
    assert data["energy_input"].values == pytest.approx(history.energy["input"])


def test_curves_of_a_history(results, plt):
    history = results.history(case="gap", analysis="elastic")
    above, between, below = history.plot(between=(1.0, 2.0))
    assert [line.get_label() for line in above.get_lines()] == ["stiff, floor 5", "soft, floor 3"]
    time, closing = between.get_lines()[0].get_data()
    assert (time[0], time[-1]) == pytest.approx((1.0, 2.0))
    assert closing == pytest.approx(history.frame("closing").loc[1.0:2.0].iloc[:, -1])
    assert below.get_ylabel() == "link force [N]"
    (drift,) = history.plot("drift", level=2)
    assert [line.get_label() for line in drift.get_lines()] == ["stiff, storey 2", "soft, storey 2"]
    assert len(results.history(case="none", analysis="elastic").plot()) == 1  # no links to draw
    with pytest.raises(pound.InputError, match="there is nothing at level 9"):
        history.plot("drift", level=9)


def test_the_main_figure(results, plt):
    """A figure of pyplot, which a notebook shows. Fails if it is one that only files see."""
    elastic, inelastic = results.plot()
    assert elastic.figure.number in plt.get_fignums()
    assert (elastic.get_xlabel(), inelastic.get_xlabel()) == ("V/V₀", "μ/μ₀")
    assert results.plot("soft")[0].figure is not elastic.figure
    with pytest.raises(pound.InputError, match="no building 'tower' in these results"):
        results.plot("tower")


def test_histories_of_an_earlier_run_are_not_solved_again(results, tmp_path, monkeypatch):
    """Fails if a kept history differs from the solved one in a bit, or if its scene is run again."""
    first = pound.run(STUDY, tmp_path / "r.h5", engine="serial")
    before = first.history(case="gap", analysis="elastic").dataset
    (tmp_path / "r.h5").unlink()
    monkeypatch.setattr("pounding_cli.solver.histories.solve_history", None)
    again = pound.run(STUDY, tmp_path / "r.h5", engine="serial")
    assert again.attrs["scenes_reused_last"] == first.attrs["scenes"]
    after = again.history(case="gap", analysis="elastic").dataset
    assert after.equals(before)
    assert after["drift"].dtype == np.float32
    monkeypatch.undo()
    shorter = pound.run(STUDY | {"keep": {"histories": {"every": "4 ms"}}}, tmp_path / "s.h5", engine="serial")
    assert len(shorter.history(case="gap", analysis="elastic").time) == (len(before["time"]) + 1) // 2
