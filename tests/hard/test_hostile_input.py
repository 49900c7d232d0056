"""Studies and motion files that once crashed, hung or ate the memory: each is answered within 5 s and 500 MB."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from click.testing import CliRunner

import pounding_cli as pound
from pounding_cli.cli.main import cli

from .guarded import guarded

BASE = """\
title: Test
records: {use: [elcentro], duration: 5 s}
buildings:
  stiff: {storeys: 3, period: 0.36 s}
  soft: {like: stiff, period: 0.60 s}
group: [stiff, soft]
cases:
  gap: {link: pounding, gap: 5 cm}
analyses: [elastic]
"""
BLANKS = " " * 100_000


def changed(old: str, new: str) -> str:
    assert old in BASE
    return BASE.replace(old, new, 1)


CHAIN = "".join(f"  b{n}: {{like: b{n + 1}}}\n" for n in range(5000)) + "  b5000: {storeys: 3, period: 1 s}\n"


def many(form: str, count: int) -> str:
    return ", ".join(form.format(n) for n in range(count))


STUDIES = {
    "sequences in a line": ("- " * 30_000, "nested too deeply"),
    "sequences by indentation": ("\n".join(" " * level + "-" for level in range(2000)), "nested too deeply"),
    "brackets": ("[" * 50_000, "nested too deeply"),
    "question marks": ("? " * 50_000, "nested too deeply"),
    "braces": ("{a: " * 50_000, "nested too deeply"),
    "a building like itself": (changed("like: stiff", "like: soft"), "is circular"),
    "a chain of buildings": (
        changed(
            "group:",
            "".join(f"  b{n}: {{like: b{n + 1}}}\n" for n in range(5000))
            + "  b5000: {storeys: 3, period: 1 s}\ngroup:",
        ),
        "buildings: 5003 entries",
    ),
    "powers of powers": (changed("0.36 s", "1 s**9**9**9"), "is not a unit"),
    "powers in brackets": (changed("0.36 s", f"1 N*{'(' * 15}s**9{')**9' * 15}"), "is not a unit"),
    "blanks, then a letter": (changed("0.36 s", f'"1 s{BLANKS}x"'), "is not a number with a unit"),
    "blanks around a fraction": (changed("0.36 s", f'"1{BLANKS}/{BLANKS}x"'), "is not a number with a unit"),
    "blanks in a rule": (changed("group:", f'impact: {{stiffness: "20 x{BLANKS}storey"}}\ngroup:'), "not a stiffness"),
    "unknown keys": (BASE + "".join(f"k{n}: 1\n" for n in range(45_000)), "and 44900 more problems"),
    "unknown keys of a building": (changed("0.36 s", f"0.36 s, {many('k{}: 1', 45_000)}"), "more problems"),
    "one key again and again": (BASE + "k: 1\n" * 45_000, "'k' occurs twice"),
    "a list without end": ("a: [" + "1, " * 1_300_000 + "1]", "more than 100000 keys and values"),
    "keys without end": (BASE + "".join(f"k{n}: 1\n" for n in range(100_000)), "motions stand in files"),
    "100 MB": ("a: [" + "1, " * 33_000_000 + "1]", "a study file of at most 4 MB"),
    "a group of thousands": (changed("[stiff, soft]", f"[{many('soft', 90_000)}]"), "90000 entries"),
    "a group of unknown names": (changed("[stiff, soft]", f"[{many('x{}', 90_000)}]"), "90000 entries"),
    "floors without end": (changed("5 cm}", f"5 cm, floors: [{many('7', 90_000)}]}}"), "90000 entries"),
    "a path without end": (changed("[elcentro]", f"[motions/{'a' * 1_000_000}]"), "a path of 1000008 characters"),
    "a name without end": (changed("[elcentro]", f"[{'a' * 1_000_000}]"), "no motion 'aaa"),
    "axes without end": (BASE + f"sweep: {{{many('k{}: [1]', 20_000)}}}\n", "the sweep has 20000 axes"),
    "every file of the machine": (changed("[elcentro]", '["/**/*.AT2"]'), ""),
    "a NUL in the title": (changed("title: Test", 'title: "a\\0b"'), "holds a control character"),
    "a device as record": (changed("[elcentro]", "[{file: /dev/zero}]"), "not a regular file"),
}


@pytest.mark.parametrize("name", STUDIES)
def test_a_study_is_refused_in_time(name, tmp_path):
    text, words = STUDIES[name]
    path = tmp_path / "study.yaml"
    path.write_text(text, encoding="utf-8")
    said = guarded(lambda: pound.load_study(path))
    assert said.startswith("refused: "), said[:300]
    assert words in said, said[:300]


def test_blanks_behind_a_value_cost_nothing(tmp_path):
    (tmp_path / "study.yaml").write_text(changed("0.36 s", f'"0.36 s{BLANKS}"'), encoding="utf-8")
    assert guarded(lambda: pound.load_study(tmp_path / "study.yaml")) == "done"


def test_check_counts_a_sweep_of_thousands(tmp_path):
    text = "sweep:\n  impact.restitution: {from: 0.1, to: 0.9, count: 100}\n"
    text += "  cases.gap.gap: {from: 0 m, to: 1 m, count: 101}\n"
    (tmp_path / "study.yaml").write_text(BASE + text, encoding="utf-8")
    result = CliRunner().invoke(cli, ["check", str(tmp_path / "study.yaml")], catch_exceptions=False)
    assert "10100 sweep points = 10100 rows" in result.output


BODY = "".join(f"{n * 0.01:.2f} {0.1 * (-1) ** n}\n" for n in range(500))
HEADERS = {
    "comment": "#{}\n",
    "comment without colon": "# dt{}x\n",
    "comment with a value": "# a: {}b\n",
    "blanks": "{}x\n",
    "units": "units{})\n",
    "channel": "CHAN{}1\n",
    "station": "sta chan{}x\n",
    "points": "NPTS{}x\n",
    "title": "CORRECTED{}x\n",
    "brackets": "time [{}s], acc [{}g]\n",
    "data": "100 accel points units={}x\n",
}


@pytest.mark.parametrize("name", HEADERS)
def test_a_long_header_is_answered_in_time(name, tmp_path):
    """200,000 blanks, and 2,000 of them, fifty lines on end, are read or refused, but soon."""
    path = tmp_path / "m.txt"
    for header in (HEADERS[name].replace("{}", " " * 200_000), HEADERS[name].replace("{}", " " * 2000) * 50):
        path.write_text(header + BODY)
        assert guarded(lambda: pound.motion(path)).startswith("refused: ")
        assert guarded(lambda: pound.motion(path, unit="g", time=1)).partition(":")[0] in ("done", "refused")


def test_a_motion_file_is_regular_and_of_bounded_size(tmp_path):
    os.mkfifo(tmp_path / "pipe.txt")
    for path in (tmp_path / "pipe.txt", Path("/dev/zero")):
        assert "this is not a regular file" in guarded(lambda path=path: pound.motion(path))
    with (tmp_path / "large.txt").open("wb") as file:
        file.truncate(10**12)
    assert "a motion file of at most 20 MB" in guarded(lambda: pound.motion(tmp_path / "large.txt"))
    (tmp_path / "oneline.txt").write_text("0.1 " * 1_000_000)
    assert "a line of 4000000 characters" in guarded(lambda: pound.motion(tmp_path / "oneline.txt"))


def test_a_study_file_is_regular(tmp_path):
    os.mkfifo(tmp_path / "pipe.yaml")
    assert "this is not a regular file" in guarded(lambda: pound.load_study(tmp_path / "pipe.yaml"))
    assert "this is not a regular file" in guarded(lambda: pound.load_study("/dev/zero"))
    assert "too long" in guarded(lambda: pound.load_study("a" * 1_000_000))


def test_a_results_file_is_regular(tmp_path):
    os.mkfifo(tmp_path / "pipe.h5")
    assert ": this is not a regular file\n" in guarded(lambda: pound.open_results(tmp_path / "pipe.h5"))
    assert "this is not a regular file" in guarded(lambda: pound.open_results("/dev/zero"))
    assert "cannot be read: File name too long" in guarded(lambda: pound.open_results("a" * 20_000))


@pytest.mark.parametrize("command", [("init",), ("records", "show")])
def test_a_name_without_end(command):
    """Of a new study, and of a motion in Python and on the command line."""
    result = CliRunner().invoke(cli, [*command, "a" * 10_000], standalone_mode=False)
    assert isinstance(result.exception, pound.InputError)
    with pytest.raises(pound.InputError):
        pound.motion("a" * 10_000)


def test_names_that_are_no_text(tmp_path):
    """A file name of bytes that are no UTF-8 is read, and shown with its bytes escaped."""
    path = Path(os.fsdecode(os.fsencode(tmp_path) + b"/\xff.yaml"))
    path.write_text(BASE.replace("title: Test\n", ""), encoding="utf-8")
    assert pound.load_study(path).title == "\\udcff"
    path.write_text("a: [", encoding="utf-8")
    with pytest.raises(pound.InputError) as caught:
        pound.load_study(path)
    str(caught.value).encode("utf-8")
