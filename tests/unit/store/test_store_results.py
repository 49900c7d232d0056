"""What goes into a results file comes out of it: by our own tables, by xarray and by h5py alone."""

from __future__ import annotations

import json
from dataclasses import replace

import h5py
import numpy as np
import pytest

from pounding_cli import run
from pounding_cli.errors import InputError
from pounding_cli.store import open_results, write_results
from pounding_cli.store.keys import FORMAT_VERSION
from pounding_cli.variables import OF_COLUMNS, VARIABLES
from tests.helpers.plans import Axis, FakeStudy, known, small_plan
from tests.helpers.sealing import edited

xarray = pytest.importorskip("xarray")


def solved(plan):
    return {digest: known(scene) for digest, scene in plan.scenes.items()}


@pytest.fixture
def plain(tmp_path):
    plan = small_plan()
    write_results(tmp_path / "plain.h5", plan, solved(plan))
    return tmp_path / "plain.h5"


@pytest.fixture
def swept(tmp_path):
    """Two axes, the first zipped of a number and a text."""
    axes = (
        Axis(("impact.damping_ratio", "impact.label"), ((0.1, "low"), (0.2, "middle"), (0.3, "high"))),
        Axis(("records.scale",), ((1.0,), (2.0,))),
    )
    plan = small_plan(axes=axes)
    write_results(tmp_path / "swept.h5", plan, solved(plan))
    return tmp_path / "swept.h5"


def test_storey_table_has_one_row_per_storey_that_exists(plain):
    table = open_results(plain).storey()
    assert list(table.columns) == [
        "case", "analysis", "record", "building", "storey",
        "V", "V0", "V_ratio", "mu", "mu0", "mu_ratio", "drift", "drift0", "drift_ratio", "residual_drift",
    ]  # fmt: skip
    assert len(table) == 2 * 2 * 2 * (3 + 2)
    row = table[
        (table.case == "gap") & (table.analysis == "inelastic") & (table.record == "strong")
        & (table.building == "stiff") & (table.storey == 2)
    ].squeeze()  # fmt: skip
    assert row.V0 == 3.0 * 2 * 2e5  # two floors above, peak 3 m/s2
    assert row.V == 1.5 * row.V0
    assert row.mu0 == pytest.approx(row.V0 / 1e6, rel=1e-15)
    assert table.V_ratio.to_numpy() == pytest.approx(1.5, rel=1e-15)
    assert list(table.storey[:5]) == [1, 2, 3, 1, 2]
    assert list(table.building[:5]) == ["stiff"] * 3 + ["soft"] * 2


def test_floor_table(plain):
    table = open_results(plain).floor()
    first = table.iloc[2]
    assert (first.building, first.floor, first.acceleration, first.acceleration0) == ("stiff", 3, 6.75, 3.0)
    assert first.acceleration_ratio == 2.25
    assert first.displacement == -first.displacement_min == 2 * first.displacement_max


def test_link_table(plain):
    table = open_results(plain).link()
    assert len(table) == 2 * 2 * 2 * 2
    assert list(table.columns[:14]) == [
        "case", "analysis", "record", "link", "left", "right", "floor", "kind", "gap",
        "impacts", "peak_force", "max_closing", "impulse", "contact_time",
    ]  # fmt: skip
    assert list(table.link[:2]) == ["stiff|soft floor 1", "stiff|soft floor 2"]
    assert list(table.peak_force[:2]) == [1e6, 2e6]
    gap = table[table.case == "gap"]
    assert (gap.gap == 0.05).all()
    assert (gap.kind == "pounding").all()


def test_scene_table_keeps_cost_effects_and_flags(plain):
    table = open_results(plain).scene()
    assert len(table) == 8
    touching = table[table.case == "touching"].iloc[0]
    assert touching["flags"] == "first\nsecond"
    assert (touching.steps, touching.events, touching.seconds) == (10, 2, 0.5)
    assert touching.energy_residual == 1e-9
    assert touching.dropped == "infill: no case has one"
    assert np.isnan(touching.sensitivity)


def test_accuracy_and_time_step_stand_apart(tmp_path):
    """Fails if a time step is written where an accuracy belongs, or the other way round."""
    plan = small_plan()
    for name, told in (("followed", {"accuracy": 1e-5}), ("stepped", {"accuracy": np.nan, "time_step": 1e-3})):
        solved = {digest: replace(known(scene), **told) for digest, scene in plan.scenes.items()}
        write_results(tmp_path / f"{name}.h5", plan, solved)
        for table in (open_results(tmp_path / f"{name}.h5").scene(), open_results(tmp_path / f"{name}.h5").accuracy()):
            wanted = {"accuracy": np.nan, "time_step": np.nan} | told
            assert table.iloc[0][list(wanted)].astype(float).to_dict() == pytest.approx(wanted, nan_ok=True)


@pytest.mark.parametrize(("step", "found"), [(None, (1e-4, np.nan)), (1e-4, (np.nan, 1e-4))])
def test_files_of_before_have_either_as_a_tolerance(plain, step, found):
    with edited(plain) as file:
        file["tolerance"] = np.full_like(file["accuracy"], 1e-4)
        del file["accuracy"], file["time_step"]
        resolved = json.loads(file["study/resolved"][()]) | {"time_step": step}
        del file["study/resolved"]
        file["study/resolved"] = json.dumps(resolved)
    first = open_results(plain).accuracy().iloc[0]
    assert (first.accuracy, first.time_step) == pytest.approx(found, nan_ok=True)


def test_files_of_before_do_not_say_how_errors_were_found(plain):
    """Fails if a file without the variable is refused, or shows a number where a text belongs."""
    with edited(plain) as file:
        del file["estimated"]
    results = open_results(plain)
    for table in (results.scene(), results.accuracy()):
        assert set(table["estimated"]) == {""}


def test_summary_agrees_with_pandas_over_the_storey_table(swept):
    results = open_results(swept)
    keys = ["impact.damping_ratio", "records.scale", "case", "analysis", "building", "storey"]
    own = results.summary().set_index(keys)
    by_hand = results.storey().groupby(keys, sort=False)["mu_ratio"].agg(["mean", "std", "min", "max", "count"])
    for measure in ("mean", "std", "min", "max"):
        np.testing.assert_allclose(own[f"mu_ratio_{measure}"], by_hand[measure], rtol=1e-14, atol=1e-15)
    assert (own.records_used == by_hand["count"]).all()
    assert (own.records_used == 2).all()


def test_swept_axes_come_first_and_zipped_keys_stand_side_by_side(swept):
    results = open_results(swept)
    table = results.storey()
    assert list(table.columns[:4]) == ["impact.damping_ratio", "impact.label", "records.scale", "case"]
    assert set(zip(table["impact.damping_ratio"], table["impact.label"], strict=True)) == {
        (0.1, "low"), (0.2, "middle"), (0.3, "high"),
    }  # fmt: skip
    assert results.axes == {
        "impact.damping_ratio": [0.1, 0.2, 0.3],
        "impact.label": ["low", "middle", "high"],
        "records.scale": [1.0, 2.0],
    }
    assert len(table) == 6 * 40
    assert list(results.link().columns[:3]) == ["impact.damping_ratio", "impact.label", "records.scale"]
    assert "impact.damping_ratio" not in results.buildings.columns  # no building changes


def test_buildings_and_records(plain):
    results = open_results(plain)
    assert list(results.buildings.place) == [1, 1, 1, 2, 2]
    assert list(results.buildings.storey) == [1, 2, 3, 1, 2]
    # one mass on one spring over another of the same size: w1 = sqrt(k/m) (sqrt(5) - 1) / 2
    soft = results.buildings[results.buildings.building == "soft"]
    assert soft.period.to_numpy() == pytest.approx(2 * np.pi / (np.sqrt(3e7 / 2e5) * (np.sqrt(5) - 1) / 2))
    records = results.records()
    assert list(records.columns) == ["record", "source", "digest", "scale", "window", "pga", "arias"]
    assert list(records.source) == ["stand-in"] * 2
    assert list(records.pga) == [1.0, 3.0]


def test_a_sweep_that_changes_the_motions_says_so_in_their_table(tmp_path):
    axes = (
        Axis(("impact.damping_ratio",), ((0.1,), (0.2,))),
        Axis(("records.scale",), ((1.0,), (2.0,), (3.0,))),
    )
    plan = small_plan(axes=axes)
    for point in np.ndindex(2, 3):
        factor = axes[1].values[point[1]][0]
        plan.study.uses[point] = tuple(replace(use, scale=factor, pga=factor * use.pga) for use in plan.motions)
    write_results(tmp_path / "r.h5", plan, solved(plan))
    table = open_results(tmp_path / "r.h5").records()
    assert list(table.columns[:3]) == ["records.scale", "record", "source"]
    assert list(table.pga) == [1.0, 3.0, 2.0, 6.0, 3.0, 9.0]
    with xarray.open_dataset(tmp_path / "r.h5", engine="h5netcdf") as data:
        assert data["record_pga"].dims == ("records.scale", "record")


def test_study_and_software_travel_with_the_numbers(plain):
    results = open_results(plain)
    assert results.study_text == "title: two buildings  # µ as written\n"
    assert results.resolved["group"] == ["stiff", "soft"]
    assert results.attrs["accuracy"] == 1e-6
    assert results.attrs["scenes"] == 2 * 2 * 2 + 2 * 2 * 2
    assert results.attrs["software_numpy"] == np.__version__


def test_zero_baseline_gives_nan_and_a_flag(tmp_path):
    plan = small_plan(records=(("none", 0.0), ("strong", 3.0)))
    write_results(tmp_path / "r.h5", plan, solved(plan))
    results = open_results(tmp_path / "r.h5")
    storey, scene = results.storey(), results.scene()
    assert storey[storey.record == "none"].V_ratio.isna().all()
    assert storey[storey.record == "strong"].V_ratio.notna().all()
    flagged = scene["flags"].str.contains("V0 = 0: ratio refused", regex=False)
    assert list(flagged) == list(scene.record == "none")
    summary = results.summary()
    assert (summary.records_used == 1).all()
    assert (summary.V_ratio_mean == 1.5).all()
    assert summary.V_ratio_std.isna().all()


def test_a_study_without_links_has_an_empty_link_table(tmp_path):
    plan = small_plan(cases=(("apart", None),))
    write_results(tmp_path / "r.h5", plan, solved(plan))
    results = open_results(tmp_path / "r.h5")
    assert len(results.link()) == 0
    assert "peak_force" in results.link().columns
    assert (results.storey().V_ratio == 1.0).all()


def test_a_case_without_links_has_no_rows_beside_one_with(tmp_path):
    plan = small_plan(cases=(("touching", 0.0), ("apart", None)))
    write_results(tmp_path / "r.h5", plan, solved(plan))
    assert set(open_results(tmp_path / "r.h5").link().case) == {"touching"}
    assert open_results(tmp_path / "r.h5").link().peak_force.notna().all()


def test_xarray_opens_it_with_names_units_and_coordinates(swept):
    with xarray.open_dataset(swept, engine="h5netcdf") as data:
        assert data["V"].dims == (
            "impact.damping_ratio", "records.scale", "case", "analysis", "record", "building", "storey",
        )  # fmt: skip
        assert data["V"].attrs == {"long_name": "largest storey shear, without damping force", "units": "N"}
        assert list(data["impact.label"].values) == ["low", "middle", "high"]
        assert {"impact.label", "link_left", "record_scale"} <= set(data.coords)
        one = data.sel(
            {"impact.damping_ratio": 0.2, "records.scale": 2.0, "case": "gap", "analysis": "elastic",
             "record": "weak", "building": "soft", "storey": 1}
        )  # fmt: skip
        assert float(one["V"]) == 1.5 * 2 * 2e5
        assert set(VARIABLES) - set(OF_COLUMNS) <= set(data.variables)
        assert not set(OF_COLUMNS) & set(data.variables)  # no slab strikes columns
        frame = data["V"].to_dataframe().dropna()
    assert len(frame) == len(open_results(swept).storey())


def test_h5py_alone_reads_it(plain):
    with h5py.File(plain) as file:
        assert [scale[0].name for scale in file["V_ratio"].dims] == [
            "/case", "/analysis", "/record", "/building", "/storey",
        ]  # fmt: skip
        assert file["kind"].asstr()[0, 0] == "pounding"
        assert file["V"].attrs["units"] == "N"
        assert file["study/text"].asstr()[()].startswith("title:")
        assert json.loads(file["study/resolved"][()])["accuracy"] == 1e-6
        assert np.isnan(file["V"][0, 0, 0, 1, 2])  # the second building has two storeys


def test_large_arrays_come_back_unchanged(tmp_path):
    axis = Axis(("impact.damping_ratio",), tuple((0.001 * i,) for i in range(1, 121)))
    plan = small_plan(axes=(axis,))
    write_results(tmp_path / "r.h5", plan, solved(plan))
    with h5py.File(tmp_path / "r.h5") as file:
        assert file["V"].compression == "gzip"
    table = open_results(tmp_path / "r.h5").storey()
    assert len(table) == 120 * 40
    assert (table.V == 1.5 * table.V0).all()


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda path: None, "no such results file"),
        (lambda path: path.mkdir(), "is a folder"),
        (lambda path: path.write_text("V,V0\n"), "cannot be read as HDF5"),
        (lambda path: h5py.File(path, "w").close(), "not a results file of pound"),
    ],
)
def test_what_is_not_a_results_file_is_refused(tmp_path, make, message):
    make(tmp_path / "r.h5")
    with pytest.raises(InputError, match=message) as refused:
        open_results(tmp_path / "r.h5")
    assert refused.value.problems[0].hint


@pytest.mark.parametrize(
    ("version", "message", "hint"),
    [
        (2, f"has the older format version 2 \\(now {FORMAT_VERSION}\\)", "run the study again"),
        (99, f"newer format version 99; this program reads version {FORMAT_VERSION}", "install"),
    ],
)
def test_another_format_version_is_refused(plain, version, message, hint):
    with edited(plain) as file:
        file.attrs["format_version"] = version
    with pytest.raises(InputError, match=message) as refused:
        open_results(plain)
    assert hint in refused.value.problems[0].hint


def test_a_failed_write_leaves_the_old_file_and_nothing_else(plain, monkeypatch):
    before = plain.read_bytes()
    plan = small_plan(study=FakeStudy(title="another"))

    def full(*_):
        raise OSError("no space left on device")

    monkeypatch.setattr("pounding_cli.store.write.write_solutions", full)
    with pytest.raises(OSError, match="no space"):
        write_results(plain, plan, solved(plan))
    assert plain.read_bytes() == before
    assert [path.name for path in plain.parent.iterdir()] == ["plain.h5"]


def test_elastic_scenes_of_buildings_that_never_yield_have_no_flag_about_ductility(tmp_path):
    """Fails if an elastic scene is flagged for a ductility that nobody asks of it; an inelastic one is: its ratio of
    ductilities is what the tables show."""
    text = """\
records: {use: [elcentro], duration: 2 s}
buildings:
  stiff: {storeys: 1, period: 0.3 s, yield_shear: never}
  soft: {like: stiff, period: 0.5 s}
group: [stiff, soft]
cases: {gap: {link: pounding, gap: 2 cm}}
analyses: [elastic, inelastic]
estimate: none
"""
    path = tmp_path / "never.yaml"
    path.write_text(text)
    scene = run(path, tmp_path / "never.h5").scene().set_index("analysis")
    assert scene.loc["elastic", "flags"] == ""
    assert "mu0 = 0" in scene.loc["inelastic", "flags"]
