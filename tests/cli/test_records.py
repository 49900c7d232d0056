"""`pound records`: what it prints, writes and refuses."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

SINE = "".join(f"{0.3 * np.sin(0.1 * i):.6f}\n" for i in range(1201))
"""12 s at 0.01 s, of 10 rad/s, in g."""


@pytest.fixture
def records(folder, pound):
    Path("sine.txt").write_text(SINE)
    return lambda *words: pound("records", *words)


def rows(out: str) -> dict[str, str]:
    return {line.split()[0]: line for line in out.splitlines() if line.strip()}


def test_list_and_import(records):
    """An imported motion takes the place of its stand-in, and replaces another only by force."""
    listed = rows(records("list")[1])
    assert " stand-in " in listed["taft"]
    assert "0.180" in listed["taft"]
    code, out, _ = records("import", "sine.txt", "--as", "taft", "--dt", "0.01", "--unit", "g")
    assert code == 0
    for word in ("length: 12 s", "peak: 0.300 g", "Arias intensity:"):
        assert word in out
    listed = rows(records("list")[1])
    assert " real " in listed["taft"]
    assert "0.300" in listed["taft"]
    assert " stand-in " in listed["eureka"]
    code, _, err = records("import", "sine.txt", "--as", "taft", "--dt", "0.02", "--unit", "g")
    assert (code, "--force" in err) == (2, True)
    assert "1201 at 0.01 s" in records("show", "taft", "--window", "100")[1]
    assert records("import", "sine.txt", "--as", "taft", "--dt", "0.02", "--unit", "g", "--force")[0] == 0
    assert "1201 at 0.02 s" in records("show", "taft", "--window", "100")[1]
    assert "parkfield" in records("import", "sine.txt", "--as", "parkfild", "--dt", "0.01", "--unit", "g")[2]


def test_show_measures_a_file(records):
    """Arias: pi / (2 g) A^2 (T / 2 - sin(2 w T) / (4 w))."""
    code, out, _ = records("show", "sine.txt", "--dt", "0.01", "--unit", "g")
    assert code == 0
    assert out.startswith("sine.txt: 1201 values one a line, every 0.01 s to 12 s, g; peak 2.942 m/s2 = 0.3 g at ")
    assert "peak              0.3000 g" in out
    (line,) = (line for line in out.splitlines() if line.startswith("Arias"))
    arias = np.pi / 2 * 9.80665 * 0.3**2 * (6.0 - np.sin(240.0) / 40.0)
    assert float(line.split()[2]) == pytest.approx(arias, rel=2e-3)
    out = records("show", "sine.txt", "--dt", "0.01", "--unit", "m/s2", "--window", "2")[1]
    assert "0.3000 m/s2" in out
    assert "201 at 0.01 s: 2 s" in out


@pytest.mark.parametrize(("ending", "magic"), [("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")])
def test_show_draws(records, ending, magic):
    picture = Path("drawn", f"sine.{ending}")
    assert records("show", "sine.txt", "--dt", "0.01", "--unit", "g", "-o", picture)[0] == 0
    assert picture.read_bytes().startswith(magic)
    assert list(picture.parent.iterdir()) == [picture]


def test_show_takes_a_column(records):
    lines = (f"{0.01 * i:.2f},0.1,{0.2 * (-1) ** i}\n" for i in range(100))
    Path("t.csv").write_text("t,x (g),y (g)\n" + "".join(lines))
    refused = records("show", "t.csv", "--unit", "g", "--time", 1)[2]
    assert "write `column:`, one of 2, 3: {file: t.csv, unit: g, time: 1, column: 2}" in " ".join(refused.split())
    assert "peak              0.2000 g" in records("show", "t.csv", "--unit", "g", "--time", 1, "--column", 3)[1]


def test_import_proposes_what_may_be_declared(records):
    """Columns numbered, the peak of each in the usual units with what is impossible struck out, and a line to paste."""
    lines = (f"{0.02 * i:.2f};{250 * np.sin(0.3 * i):.3f}\n".replace(".", ",") for i in range(100))
    Path("t.csv").write_text("Zeit;Beschleunigung [gal]\n" + "".join(lines))
    code, out, _ = records("import", "t.csv")
    assert code == 0
    table = {line.split()[0]: line.split()[1:] for line in out.splitlines() if line[:1].isdigit()}
    assert table["1"] == ["0,00", "0,02", "0,04", "0.02", "1.98"]
    assert table["2"][-7:] == ["249.998", "impossible", "impossible", "0.255", "g", "0.0255", "g"]
    (line,) = (line for line in out.splitlines() if line.startswith("  - {"))
    assert line == '  - {file: t.csv, unit: gal, time: 1, column: 2, decimal: ","}'
    words = ("--unit", "gal", "--time", 1, "--column", 2, "--decimal", ",")
    assert "peak 2.5 m/s2 = 0.2549 g" in records("import", "t.csv", *words)[1]


def test_stand_ins_have_the_measures_of_their_motions(records):
    """Of the catalogue, which `tools/stand_ins.py` aims at."""
    path = next(word for word in rows(records("list")[1])["eureka"].split() if word.endswith("eureka.txt"))
    out = records("import", path, "--as", "eureka")[1]
    for name in ("peak", "Arias intensity"):
        found, aim = re.findall(rf"{name}: ([\d.]+) .*; ([\d.]+) ", out)[0]
        assert float(found) == pytest.approx(float(aim), rel=0.02)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("show tafft", "'taft'"), ("show none.AT2", "none.AT2"), ("show taft --window -1", "above 0 s"),
        ("show bad.txt --unit g --time 1", "bad.txt:2:6: "), 
        ("show sine.txt --dt 0.01 --unit g --channel 2", "channel"),
        ("show taft --unit cm/s2", "--unit says how a file is read"), ("show late.txt --window 2", "at rest"),
        ("show sine.txt --dt 0.01", "unit: UNIT"),
        ("show sine.txt --unit g --dt 0.01 --separator x", "unknown separator 'x'"),
    ],
)  # fmt: skip
def test_refusals(records, words, message):
    Path("bad.txt").write_text("0 0.1\n0.01 oops\n")
    Path("late.txt").write_text("# dt: 0.01 s\n# unit: g\n" + "0\n" * 300 + SINE)
    code, out, err = records(*words.split())
    assert (code, out) == (2, "")
    assert message in err
    assert "Traceback" not in err
