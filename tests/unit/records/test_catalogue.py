"""The catalogue: what Table 1 prints, where a name is found, and which label it gets."""

import os
from datetime import date
from pathlib import Path

import numpy as np
import pytest

from pounding_cli.errors import InputError
from pounding_cli.records import GRAVITY, Motion, arias, entry, find, locate, names
from pounding_cli.records.catalogue import catalogue, shipped_folder, user_folder
from pounding_cli.records.importing import differences
from pounding_cli.records.writers import motion_text


@pytest.fixture(autouse=True)
def _nothing_of_the_user(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.delenv("POUND_RECORDS", raising=False)
    monkeypatch.setenv("POUND_HOME", str(tmp_path / "home"))


def put(folder: Path, name: str, text: str) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_text(text)
    return folder / name


@pytest.mark.parametrize(
    ("name", "peak", "duration", "scale", "year"),
    [
        ("elcentro", 0.35, 10, 1.00, 1940),
        ("taft", 0.18, 15, 1.75, 1952),
        ("eureka", 0.26, 10, 1.33, 1954),
        ("olympia", 0.28, 23, 1.25, 1949),
        ("parkfield", 0.49, 10, 0.82, 1966),
    ],
)
def test_table1(name: str, peak: float, duration: float, scale: float, year: int) -> None:
    known = entry(name)
    assert known.peak == pytest.approx(peak * GRAVITY, rel=1e-15)
    assert (known.duration, known.scale, known.date.year) == (duration, scale, year)
    assert isinstance(known.date, date)
    assert str(year) in known.title
    assert known.sources


def test_names_stand_in_the_order_of_table1() -> None:
    assert names() == ("elcentro", "taft", "eureka", "olympia", "parkfield")


def test_facts_are_in_order() -> None:
    for known in catalogue().values():
        facts = known.facts
        assert (np.diff(facts.periods) > 0).all()
        assert facts.periods[0] == 0.05
        assert facts.periods[-1] == 4.0
        assert (np.diff(facts.husid_times) > 0).all()
        assert 0 < facts.husid_times[0] < facts.husid_times[-1] < known.duration
        # D5-95 stands in the file beside the Husid curve it follows from.
        at = dict(zip(facts.husid_fractions, facts.husid_times, strict=True))
        assert facts.significant_duration == pytest.approx(at[0.95] - at[0.05], abs=2e-3)


def test_estimated_arias_follows_from_table1() -> None:
    target = entry("elcentro").facts.arias
    for name, wanted in (("eureka", 0.644), ("olympia", 0.729)):
        assert entry(name).facts_of == "estimate"
        assert entry(name).facts.arias == pytest.approx(target / entry(name).scale ** 2, rel=1e-5)
        assert entry(name).facts.arias == pytest.approx(wanted, abs=5e-4)


@pytest.mark.parametrize("name", ["elcentro", "taft", "eureka", "olympia", "parkfield"])
def test_the_shipped_one_is_a_stand_in_and_says_so(name: str) -> None:
    motion = find(name)
    assert (motion.name, motion.source) == (name, "stand-in")
    place = locate(name)
    assert place.path.parent == shipped_folder()
    assert "STAND-IN" in place.path.read_text().splitlines()[0]


def test_label_survives_window_and_scale() -> None:
    assert find("taft").windowed(5.0).scaled(1.5).source == "stand-in"


@pytest.mark.parametrize(("typed", "near"), [("el centro", "elcentro"), ("Taft", "taft"), ("parkfeld", "parkfield")])
def test_unknown_names_get_the_nearest(typed: str, near: str) -> None:
    with pytest.raises(InputError, match=f"did you mean '{near}'"):
        find(typed)


def test_names_like_none_get_the_list() -> None:
    with pytest.raises(InputError) as caught:
        find("qqq")
    assert "did you mean" not in str(caught.value)
    assert "olympia" in str(caught.value)


def test_a_real_file_in_pound_records_comes_first(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    empty = tmp_path / "empty"
    empty.mkdir()
    put(tmp_path / "real", "Parkfield-1966-Cholame2-N65E.txt", "0.1\n-0.2\n0.3\n")
    put(user_folder(), "parkfield.txt", motion_text(Motion("parkfield", 0.02, [1.0, 2.0]), {}))
    monkeypatch.setenv("POUND_RECORDS", os.pathsep.join([str(empty), str(tmp_path / "real")]))
    motion = find("parkfield")
    assert (motion.source, motion.dt, motion.acceleration.size) == ("real", 0.01, 3)
    assert motion.acceleration == pytest.approx(np.array([0.1, -0.2, 0.3]) * GRAVITY)


def test_the_users_own_folder_comes_before_the_stand_in() -> None:
    own = Motion("eureka", 0.02, [0.1, 2.0, -1.0])
    put(user_folder(), "eureka.txt", motion_text(own, {"digest": own.digest}))
    assert find("eureka").source == "real"
    assert find("eureka").digest == own.digest


def test_two_files_that_look_alike_are_refused(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    put(tmp_path, "olympia-n86e.txt", "0 1\n1 2\n")
    put(tmp_path, "olympia-N86E-b.txt", "0 1\n1 2\n")
    monkeypatch.setenv("POUND_RECORDS", str(tmp_path))
    with pytest.raises(InputError, match="more than one file looks like 'olympia'"):
        find("olympia")


def test_a_folder_that_is_not_there_is_refused(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("POUND_RECORDS", str(tmp_path / "gone"))
    with pytest.raises(InputError, match="which is not a folder"):
        find("taft")


def test_user_folder_follows_the_platform(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    assert user_folder() == tmp_path / "home" / "records"
    monkeypatch.delenv("POUND_HOME")
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "xdg"))
    assert user_folder() == tmp_path / "xdg" / "pound" / "records"
    monkeypatch.setattr("sys.platform", "darwin")
    assert user_folder().parts[-4:] == ("Library", "Application Support", "pound", "records")
    monkeypatch.setattr("sys.platform", "win32")
    monkeypatch.setenv("LOCALAPPDATA", str(tmp_path / "local"))
    assert user_folder() == tmp_path / "local" / "pound" / "records"


def test_differences_are_told_one_by_one() -> None:
    known, same = entry("eureka"), find("eureka")
    assert differences(known, same) == []
    loud = differences(known, same.scaled(1.1))
    assert [line.split(":")[0] for line in loud] == ["peak", "Arias intensity"]
    # 1.1 times louder needs a scale 1.1 times smaller.
    assert "changes by 0.909" in loud[1]
    assert differences(known, same.windowed(9.0))[0].startswith("length: 9 s")
    other = differences(entry("elcentro"), Motion("e", 0.01, find("elcentro").acceleration))
    assert any(line.startswith("time step: 0.01 s, against 0.02 s") for line in other)
    assert any(line.startswith("whole length: 10 s, against 53.74 s") for line in other)


def test_arias_of_the_windows_prints_as_documented() -> None:
    for name, value in (("elcentro", 1.139), ("taft", 0.465), ("parkfield", 1.687)):
        assert entry(name).facts.arias == pytest.approx(value, abs=6e-4)
        assert arias(find(name).windowed(entry(name).duration)) == pytest.approx(value, rel=0.01)
