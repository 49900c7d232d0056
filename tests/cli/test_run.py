"""`pound run`: what it prints, what it writes, how it ends."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path

import pytest

from pounding_cli.laws.connector import Connector
from pounding_cli.store import open_results
from tests.helpers.two_buildings import STUDY, fails, known, strikes

SOLVE = known

ROOT = str(Path(__file__).parents[2])


def test_summary_shows_ratios_motions_flags_counts_and_times(folder, pound):
    code, out, err = pound("run", "two.yaml")
    assert code == 0
    assert out.splitlines()[0] == "Two small buildings"
    lines = [line.split() for line in out[out.index("height.\n") :].splitlines()]  # behind the first table
    columns = "{} at roof largest (storey) ± numerical sensitivity"
    assert " ".join(lines[4]) == f"case building {columns.format('V/V0')} {columns.format('mu/mu0')}"
    # this solver's peaks follow the motion's largest sample, which stands after half a second's sixth part
    touching = next(line for line in lines if line[:1] == ["touching"])
    # the run that judges them is driven by a motion that is nudged by 1e-8
    assert touching[:6] == ["touching", "stiff", "2.000", "2.000", "(3)", "1e-08"]
    assert touching[7:11] == ["2.000", "2.000", "(3)", "1e-08"]
    assert 0 < float(touching[6]) < 1
    soft = next(line for line in lines if line[:1] == ["soft"])
    assert soft[:5] == ["soft", "2.000", "2.000", "(2)", "1e-08"]
    assert "Motions, user, unit g assumed: weak, strong" in out
    assert "Note: gap, elastic, 2 of 2 scenes (all): a sentence to know\n" in out
    assert "Note: gap, inelastic, 2 of 2 scenes (all): a sentence to know\n" in out
    assert re.search(r"Scenes: 16 solved, 0 reused, 0 failed(, \d side by side)?; solver 2 ms, in all", out)
    assert "16 scenes to solve" in err
    assert (folder / "results" / "two.h5").is_file()
    assert len(open_results("results/two.h5").storey()) == 2 * 2 * 2 * 5


def test_one_of_a_thing_is_told_in_the_singular(folder, pound):
    one = STUDY.replace("{file: weak.txt}, ", "").replace("[elastic, inelastic]", "[elastic]")
    (folder / "two.yaml").write_text(one)
    out = pound("run", "two.yaml")[1]
    assert "Means over 1 motion.\n" in out
    assert "Note: gap, elastic, 1 of 1 scene (strong): a sentence to know\n" in out


def test_a_case_without_meaning_is_marked_in_the_table_and_in_the_last_sentence(folder, pound):
    _, out, _ = pound("run", "two.yaml", solve=strikes)
    means = out[out.index("height.\n") :]
    rows = [line.split() for line in means.splitlines() if line.count(".") > 3]
    assert [row.count("!") for row in rows] == [0, 0, 3, 2]
    assert rows[2][:8] == ["gap", "!", "stiff", "2.000", "!", "2.000", "(3)", "!"]  # V/V0, and nothing of mu/mu0
    where = "stiff | soft, floor 2, by 3 mm"
    assert f"Meaningless (!): gap, elastic, 1 of 2 scenes (strong): {Connector.beyond_gap}: {where}\n" in out
    assert "Scenes: 16 solved, 0 reused, 0 failed, 1 row meaningless (!)" in out


def test_flagged_scenes_of_a_sweep_are_named_with_their_point(folder, pound):
    (folder / "two.yaml").write_text(STUDY + "sweep: {cases.gap.gap: [1 cm, 0 cm]}\n")
    _, out, _ = pound("run", "two.yaml", solve=strikes)
    assert "gap, elastic, 1 of 4 scenes (cases.gap.gap = 1 cm: strong): connector closes" in out
    means = out[out.index("height.\n") :].splitlines()
    gap = next(at for at, line in enumerate(means) if line.startswith(" gap !"))
    swept = means[gap : gap + 2]
    assert [line.count(" !") for line in swept] == [3, 0]  # beside the case's name, and only at the point concerned


def test_second_run_solves_nothing_and_says_so(folder, pound):
    pound("run", "two.yaml", "-o", "r.h5")
    code, out, err = pound("run", "two.yaml", "-o", "r.h5", solve=lambda *_, **__: 1 / 0)
    assert (code, err) == (0, "")
    assert "Scenes: 0 solved, 16 reused, 0 failed" in out
    assert "touching" in out


def test_a_changed_study_solves_only_what_is_new(folder, pound):
    pound("run", "two.yaml", "-o", "r.h5")
    (folder / "two.yaml").write_text(STUDY + "sweep: {cases.gap.gap: [1 cm, 2 cm, 3 cm]}\n")
    code, out, _ = pound("run", "two.yaml", "-o", "r.h5")
    assert code == 0
    assert "Scenes: 8 solved, 16 reused, 0 failed" in out
    assert "Line 3, cases.gap.gap = 3 cm\nMeans over 2 motions at 3 points of the sweep." in out
    assert list(open_results("r.h5").storey().columns[:2]) == ["cases.gap.gap", "case"]


def test_quiet_prints_nothing(folder, pound):
    assert pound("run", "two.yaml", "-q") == (0, "", "")


def test_json_lines_and_nothing_else(folder, pound):
    code, out, err = pound("run", "two.yaml", "--log-json", solve=fails)
    assert (code, err) == (1, "")
    lines = [json.loads(line) for line in out.splitlines()]
    assert [line["event"] for line in lines if line["event"] != "progress"] == [
        "start", "stop", "failed", "failed", "end",
    ]  # fmt: skip
    assert lines[-2]["scene"] == "gap, elastic, strong"
    assert lines[-2]["advice"] == "check the links' stiffness"
    end = lines[-1]
    assert (end["done"], end["failed"], end["reused"]) == (14, 2, 0)
    assert end["results"] == os.path.join("results", "two.h5")


def test_engines_offered_are_those_there_are():
    from pounding_cli.batch.engines import ENGINES
    from pounding_cli.cli.run import command

    choice = next(option for option in command.params if "--engine" in option.opts)
    assert tuple(choice.type.choices) == ENGINES


def test_failed_scenes_are_listed_and_the_exit_code_is_1(folder, pound):
    code, out, err = pound("run", "two.yaml", "-q", solve=fails)
    assert code == 1
    assert out == ""
    assert err.splitlines() == [
        "failed: gap, elastic, weak: event bound reached",
        "    check the links' stiffness",
        "failed: gap, elastic, strong: event bound reached",
        "    check the links' stiffness",
    ]
    code, out, _ = pound("run", "two.yaml", solve=fails)
    assert code == 1
    means = out[out.index("height.\n") :].splitlines()
    gap = next(line.split() for line in means if line.strip().startswith("gap"))
    assert gap[:9] == ["gap", "stiff", "-", "-", "-", "-", "2.000", "2.000", "(3)"]
    assert "Scenes: 0 solved, 14 reused, 2 failed" in out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["run", "nothing.yaml"], "nothing.yaml"),
        (["run", "two.yaml", "-o", "."], "the output is a folder"),
        (["run", "two.yaml", "-o", "two.yaml"], "the output is the file that this command reads"),
        (["run", "two.yaml", "-o", "two.yaml/r.h5"], "cannot be written"),
        (["run", "two.yaml", "--workers", "0"], "0 is not in the range x>=1"),
        (["run", "two.yaml", "--engine", "abacus"], "'abacus' is not one of"),
        (["run", "two.yaml", "--scheduler", "tcp://node:8786"], "write `--engine dask"),
        (["run"], "Missing argument 'STUDY'"),
    ],
)
def test_refused_before_anything_is_solved(folder, pound, arguments, message):
    def never(*_, **__):
        raise AssertionError("solved")

    before = sorted(folder.rglob("*"))
    code, out, err = pound(*arguments, solve=never)
    assert (code, out) == (2, "")
    assert message in err
    assert "Traceback" not in err
    assert sorted(folder.rglob("*")) == before


def test_ctrl_c_keeps_what_is_solved_and_says_how_to_go_on(folder, pound):
    script = textwrap.dedent(
        f"""
        import signal, sys, time
        signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background job is born deaf to it
        sys.path.insert(0, {ROOT!r})
        import pounding_cli.solve
        from tests.helpers.two_buildings import known

        def slow(scene, accuracy, method, **_):
            time.sleep(0.4)
            return known(scene, accuracy, method)

        pounding_cli.solve.solve = slow
        sys.argv = ["pound", "run", "two.yaml", "-o", "r.h5", "--engine", "serial"]
        from pounding_cli.cli.main import main
        main()
        """
    )
    running = subprocess.Popen([sys.executable, "-c", script], stderr=subprocess.PIPE, text=True)
    parts = folder / "r.h5.parts"
    while not list(parts.glob("*.part")) and running.poll() is None:
        time.sleep(0.05)
    running.send_signal(signal.SIGINT)
    _, err = running.communicate(timeout=30)
    assert running.returncode == 130, err
    assert "of 16 scenes kept in r.h5.parts" in err
    assert "run the same command again to resume" in err
    assert "Traceback" not in err
    assert not (folder / "r.h5").exists()
    kept = int(err.split(" of 16 scenes kept")[0].split()[-1])
    assert 0 < kept < 16
    code, out, _ = pound("run", "two.yaml", "-o", "r.h5")
    assert code == 0
    assert f"Scenes: {16 - kept} solved, {kept} reused, 0 failed" in out
    assert not parts.exists()


def test_the_solver_gives_the_same_rows_in_processes_and_in_this_one(folder, pound, monkeypatch):
    monkeypatch.setattr("pounding_cli.batch.runner.WORTH_WORKERS", 0.0)
    for engine in ("serial", "processes", "threads"):
        code, out, _ = pound("run", "two.yaml", "-o", f"{engine}.h5", "--engine", engine, "--workers", 2, solve=None)
        assert code == 0
        assert ("2 side by side" in out) == (engine != "serial")
    serial = open_results("serial.h5")
    for side in (open_results("processes.h5"), open_results("threads.h5")):
        assert serial.storey().equals(side.storey())
        assert serial.link().equals(side.link())
        assert serial.floor().equals(side.floor())
    assert (serial.storey().V > 0).all()
    assert (serial.scene().status == "done").all()


def test_python_gives_the_same_tables(folder, pound, monkeypatch):
    import pounding_cli

    monkeypatch.setattr("pounding_cli.solve.solve", known)
    results = pounding_cli.run("two.yaml")
    assert str(results.path) == os.path.join("results", "two.h5")
    again = pounding_cli.run(pounding_cli.load_study("two.yaml"), "again.h5")
    assert results.storey().equals(again.storey())
    assert pounding_cli.open_results("again.h5").title == "Two small buildings"


@pytest.mark.parametrize("command", ["check", "plan", "run"])
def test_what_is_unlikely_and_floors_that_meet_nothing_are_told_and_the_study_goes_on(folder, pound, command):
    text = STUDY.replace("gap: 1 cm", "gap: 2").replace("storeys: 2,", "storeys: 5, height: 2.25 m,")
    (folder / "two.yaml").write_text(text)
    code, _, err = pound(command, "two.yaml", solve=known if command == "run" else None)
    assert code == 0
    assert "warning: two.yaml:14:30: gap is 2 m: " in err
    assert "did you mean 2 cm?" in err
    assert "warning: two.yaml:10:16: stiff and soft meet at 1 floor only (3 with 4): " in err
    assert "floors 1 and 2 of stiff and floors 1 to 3 of soft meet no floor" in err
    if command == "run":
        found = open_results("results/two.h5").warnings
        assert [(warning.line, warning.column) for warning in found] == [(10, 16), (14, 30)]
        assert found[1].hint.startswith("did you mean 2 cm?")
