"""Kept histories in the results file: their layout by h5py and xarray, and how one is asked for."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from zlib import crc32

import h5py
import numpy as np
import pytest

from pounding_cli.api import histories as api
from pounding_cli.errors import InputError
from pounding_cli.solve.histories import ENERGIES, History
from pounding_cli.store import open_results, write_results
from pounding_cli.store.histories import FIELDS, Kept, kept_places
from tests.helpers.plans import Axis, known, small_plan
from tests.helpers.sealing import edited

TIMES, STOREYS = 7, 3


def made_up(row, links=("stiff|soft floor 2", "stiff|soft floor 1")) -> History:
    """Numbers that tell where they belong: seed by row; the soft building has no third storey."""
    noise = np.random.default_rng(crc32(repr((row.point, row.case, row.analysis, row.record)).encode()))
    by_storey = [noise.normal(size=(TIMES, 2, STOREYS)) for _ in range(4)]
    for values in by_storey:
        values[:, 1, 2] = np.nan
    return History(
        0.002 * np.arange(TIMES), *noise.normal(size=(2, TIMES)), *by_storey, *noise.normal(size=(2, TIMES, 2)),
        noise.normal(size=(TIMES, len(links))), {name: noise.normal(size=TIMES) for name in ENERGIES},
        ("stiff", "soft"), tuple(links), noise.normal(size=(TIMES, len(links))),
    )  # fmt: skip


@pytest.fixture
def kept(tmp_path):
    """A sweep of two axes, the first of two keys; all rows of the case gap under the strong motion are kept."""
    axes = (
        Axis(("impact.damping_ratio", "impact.label"), ((0.1, "low"), (0.3, "high"))),
        Axis(("records.scale",), ((1.0,), (2.0,))),
    )
    plan = small_plan(axes=axes)
    plan = replace(plan, kept=tuple(r for r in plan.rows if r.case == "gap" and r.record == "strong"))
    path = tmp_path / "kept.h5"
    responses = {digest: known(scene) for digest, scene in plan.scenes.items()}
    write_results(path, plan, responses, histories=(Kept(row, plan.every, made_up(row)) for row in plan.kept))
    return path, plan


def test_a_history_comes_back_as_it_was(kept):
    """Links in the file's order, in 32 bits. Fails if the links keep the scene's order."""
    path, plan = kept
    results = open_results(path)
    row = next(r for r in plan.kept if r.point == (1, 0) and r.analysis == "inelastic")
    found = results.history(analysis="inelastic", **{"impact.label": "high", "records.scale": 1})
    expected = made_up(row)
    assert found.buildings == ("stiff", "soft")
    assert found.links == ("stiff|soft floor 1", "stiff|soft floor 2")
    of_links = [name for name, (dims, *_) in FIELDS.items() if "link" in dims]
    for name in of_links:
        assert (getattr(found, name) == getattr(expected, name)[:, ::-1].astype(np.float32)).all()
    assert (found.time == expected.time).all()
    for name in FIELDS:
        if name not in of_links and not name.startswith("energy"):
            ours = getattr(expected, name).astype(np.float32)
            assert np.array_equal(getattr(found, name), ours, equal_nan=True), name
    for name in ENERGIES:
        assert (found.energy[name] == expected.energy[name].astype(np.float32)).all()


def test_a_file_of_before_tells_no_closings(tmp_path):
    """They follow from the floors there. Fails if such a file is refused, or a left floor is taken for a right one."""
    plan = small_plan()
    row = next(r for r in plan.rows if r.case == "gap")
    responses = {digest: known(scene) for digest, scene in plan.scenes.items()}
    of_before = replace(made_up(row), closing=None)
    write_results(tmp_path / "old.h5", replace(plan, kept=(row,)), responses, histories=[Kept(row, 0.002, of_before)])
    found = open_results(tmp_path / "old.h5").history()
    assert found.closing is None
    floors = of_before.displacement[:, 0, :2] - of_before.displacement[:, 1, :2]
    assert api.History.of(found).closing == pytest.approx(floors, rel=1e-6, abs=1e-6)  # kept in single precision


def test_the_frame_says_which_are_kept(kept):
    path, _ = kept
    frame = open_results(path).histories()
    assert list(frame.columns) == [
        "impact.damping_ratio", "impact.label", "records.scale", "case", "analysis", "record", "number", "scene",
        "every", "times",
    ]  # fmt: skip
    assert len(frame) == 2 * 2 * 2
    assert list(frame["number"]) == list(range(8))
    assert set(frame["case"]) == {"gap"}
    assert set(frame["every"]) == {0.002}
    assert set(frame["times"]) == {TIMES}
    assert list(frame["records.scale"][:4]) == [1.0, 1.0, 2.0, 2.0]


def test_h5py_alone_reads_it(kept):
    path, plan = kept
    with h5py.File(path) as file:
        assert sorted(file["histories"], key=int) == [str(i) for i in range(8)]
        group = file["histories/5"]
        assert {k: group.attrs[k] for k in ("case", "analysis", "record")} == {
            "case": "gap", "analysis": "inelastic", "record": "strong",
        }  # fmt: skip
        assert (group.attrs["impact.damping_ratio"], group.attrs["impact.label"]) == (0.3, "high")
        assert group.attrs["scene"] == plan.kept[5].scene
        for name, (dims, unit, _) in FIELDS.items():
            dataset = group[name]
            assert [scale[0].name.rsplit("/", 1)[1] for scale in dataset.dims] == list(dims)
            assert (dataset.attrs["units"], dataset.dtype, dataset.compression) == (unit, np.float32, "gzip")
            assert dataset.attrs["long_name"]


def test_the_page_tells_every_dataset():
    page = (
        (Path(__file__).parents[3] / "docs" / "histories.md").read_text(encoding="utf-8").split("## In the results")[1]
    )
    rows = [line.split("|")[1:4] for line in page.splitlines() if line.startswith("| `")]
    told = {name.strip(" `"): (dims.strip(), unit) for names, dims, unit in rows for name in names.split(",")}
    assert told.pop("time")[0] == "time"
    assert set(told) == set(FIELDS)
    for name, (dims, unit, _) in FIELDS.items():
        assert told[name][0] == ", ".join(dims)
        assert unit in told[name][1]


def test_xarray_opens_a_group(kept):
    xarray = pytest.importorskip("xarray")
    path, plan = kept
    with xarray.open_dataset(path, engine="h5netcdf", group="histories/0") as data:
        found = data["shear"].sel(building="stiff", storey=3).to_numpy()
        assert (found == made_up(plan.kept[0]).shear[:, 0, 2].astype(np.float32)).all()
        assert data["time"].to_numpy()[1] == 0.002
        assert data["link_force"].dims == ("time", "link")


def test_a_scene_with_fewer_links_or_storeys_is_padded(tmp_path):
    """The case far has no links."""
    plan = small_plan(cases=(("gap", 0.05), ("far", None)))
    plan = replace(plan, kept=plan.rows)
    path = tmp_path / "padded.h5"
    responses = {digest: known(scene) for digest, scene in plan.scenes.items()}

    def shorter(row):
        whole = made_up(row, () if row.case == "far" else ("stiff|soft floor 2",))
        return replace(whole, shear=whole.shear[:, :, :2], drift=whole.drift[:, :, :2])

    write_results(path, plan, responses, histories=(Kept(row, plan.every, shorter(row)) for row in plan.kept))
    results = open_results(path)
    far = results.history(case="far", analysis="elastic", record="weak")
    assert far.link_force.shape == (TIMES, 2)
    assert np.isnan(far.link_force).all()
    assert np.isnan(far.shear[:, :, 2]).all()
    assert np.isfinite(far.shear[:, :, :2]).all()
    gap = results.history(case="gap", analysis="elastic", record="weak")
    assert np.isnan(gap.link_force[:, 0]).all()
    assert np.isfinite(gap.link_force[:, 1]).all()


def test_all_histories_are_looked_for_once_and_again_when_the_file_has_changed(kept, monkeypatch):
    path, plan = kept
    looked = []
    monkeypatch.setattr(
        "pounding_cli.store.results.kept_places",
        lambda file: looked.append(file.id.get_filesize()) or kept_places(file),
    )
    found = open_results(path)
    for place in found.histories().to_dict("records"):
        found.history(**{name: place[name] for name in (*found.axes, "case", "analysis", "record")})
    assert len(looked) == 1
    fewer = replace(plan, kept=plan.kept[:1])
    responses = {digest: known(scene) for digest, scene in plan.scenes.items()}
    write_results(path, fewer, responses, histories=[Kept(plan.kept[0], plan.every, made_up(plan.kept[0]))])
    assert len(found.histories()) == 1
    assert len(looked) == 2


@pytest.mark.parametrize(
    ("wanted", "message", "hint"),
    [
        ({}, "keeps 8 histories", "say which of: impact.damping_ratio = 0.1, impact.label = low, records.scale = 1.0"),
        ({"case": "touching"}, "keeps no history of case touching", "gap, elastic, strong"),
        (
            {"analysis": "elastic", "impact.label": "low"},
            "keeps 2 histories of analysis elastic",
            "records.scale = 2.0",
        ),
        ({"records.skale": 1.0}, "keeps no history of records.skale 1.0", "kept are"),
    ],
)
def test_what_is_not_one_history_is_refused_with_what_is_there(kept, wanted, message, hint):
    with pytest.raises(InputError) as refused:
        open_results(kept[0]).history(**wanted)
    (problem,) = refused.value.problems
    assert message in problem.message
    assert hint in problem.hint


def test_a_file_without_histories_says_how_to_get_them(tmp_path):
    plan = small_plan()
    write_results(tmp_path / "r.h5", plan, {digest: known(scene) for digest, scene in plan.scenes.items()})
    results = open_results(tmp_path / "r.h5")
    assert len(results.histories()) == 0
    with pytest.raises(InputError, match="keep: histories"):
        results.history()


def without(name):
    def change(group):
        del group[name]

    return change


def standing_still(group):
    group["time"][2] = group["time"][1]


def beyond_numbers(group):
    group["displacement"][2, 0, 0] = np.inf


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (beyond_numbers, "its histories/0/displacement is not finite"),
        (without("building"), "its histories/0/building is missing"),
        (without("link"), "its histories/0/link is missing"),
        (standing_still, "its histories/0/time does not go on"),
    ],
)
def test_a_forged_history_is_refused_by_name(kept, change, words):
    path, plan = kept
    with edited(path) as file:
        change(file["histories/0"])
    names = [name for axis in plan.axes for name in axis.names]
    results = open_results(path)
    first = results.histories().iloc[0]
    with pytest.raises(InputError, match=words):
        results.history(**{name: first[name] for name in (*names, "case", "analysis", "record")})


def test_a_unit_that_is_none_is_refused(kept):
    path, _ = kept
    with edited(path) as file:
        file["records.scale"].attrs["unit_factor"] = 0.0
    with pytest.raises(InputError, match=r"its records.scale has a unit that is not positive"):
        open_results(path)
