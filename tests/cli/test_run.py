"""`pound run`: what it prints, what it writes, how it ends."""

from __future__ import annotations

import contextlib
import json
import os
import re
import signal
import sqlite3
import subprocess
import sys
import time
from pathlib import Path

import pandas as pd
import pytest

import pounding_cli
from pounding_cli.api import running

from .conftest import TWO

MAIN = "from pounding_cli.cli.main import main; main()"


def of_means(out: str) -> list[str]:
    """The lines of the table of means."""
    lines = out.splitlines()
    return lines[next(place for place, line in enumerate(lines) if line.startswith("Ratios to the same")) :]


def test_the_summary_is_that_of_the_tables(folder, pound):
    """Mean ratios at the top and the largest with its storey, of every case, building and analysis."""
    code, out, err = pound("run", "two.yaml")
    assert code == 0
    assert "16 time histories to solve" in err
    results = pounding_cli.open_results("results/two.h5")
    means = results.storey().groupby(["case", "building", "analysis", "storey"], observed=True)[["V_ratio", "mu_ratio"]]
    means = means.mean()
    lines = [line.split() for line in of_means(out)]
    for case in ("touching", "gap"):
        start = next(place for place, line in enumerate(lines) if line[:1] == [case])
        for line, building in ((lines[start][1:], "stiff"), (lines[start + 1][1:], "soft")):
            elastic = means.loc[case, building, "elastic"]["V_ratio"]
            inelastic = means.loc[case, building, "inelastic"]["mu_ratio"]
            wanted = [building]
            for ratio in (elastic, inelastic):
                wanted += [f"{ratio.iloc[-1]:#.4g}", f"{ratio.max():#.4g}", str(ratio.idxmax())]
            assert line[:7] == wanted
    assert "stand-in: elcentro, taft" in out
    assert re.search(r"Time histories: 16 solved, 0 reused, 0 failed.*; solver \d+ ms, in all", out)
    assert len(results.storey()) == 2 * 2 * 2 * 5


def test_what_is_known_is_not_solved_again(folder, pound):
    pound("run", "two.yaml", "-o", "r.h5", "-q")
    before = pounding_cli.open_results("r.h5").storey()
    assert "Time histories: 0 solved, 16 reused, 0 failed" in pound("run", "two.yaml", "-o", "r.h5")[1]
    (folder / "two.yaml").write_text(TWO + "sweep: {cases.gap.gap: [5 mm, 6 mm, 7 mm]}\n")
    code, out, _ = pound("run", "two.yaml", "-o", "r.h5")
    assert code == 0
    assert "Time histories: 8 solved, 16 reused, 0 failed" in out
    swept = pounding_cli.open_results("r.h5").storey()
    assert list(swept.columns[:2]) == ["cases.gap.gap", "case"]
    first = swept[swept["cases.gap.gap"] == 0.005].drop(columns="cases.gap.gap").reset_index(drop=True)
    pd.testing.assert_frame_equal(first, before)


def without_times(out: str) -> str:
    """Return the output of a run without its counts and times."""
    return re.sub(r"Time histories: .*", "", out)


def test_what_is_current_is_told_without_the_results(folder, pound):
    """Fails if the summary of a file that is current is not the one of that file, or needs what makes it anew."""
    _, first, _ = pound("run", "two.yaml")
    code = (
        "import sys; from click.testing import CliRunner; from pounding_cli.cli.main import cli\n"
        "done = CliRunner().invoke(cli, ['run', 'two.yaml'], catch_exceptions=False)\n"
        "sys.stdout.write(done.output)\n"
        "print([name for name in ('numba', 'pandas', 'scipy', 'xarray') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    again, _, loaded = done.stdout.strip().rpartition("\n")
    assert loaded == "[]"
    assert without_times(again) == without_times(first).strip()


@pytest.mark.parametrize("change", ["another program", "no cache", "damaged summary", "other results"])
def test_a_summary_that_is_not_of_these_results_is_made_anew(folder, pound, monkeypatch, change):
    """The text that is kept is replaced by one that would be seen. Fails if it is printed all the same."""
    _, first, _ = pound("run", "two.yaml")
    cache = Path("results/two.h5.cache")
    with contextlib.closing(sqlite3.connect(cache)) as kept, kept:
        (text,) = kept.execute("SELECT text FROM summary").fetchone()
        kept.execute("UPDATE summary SET text = ?", (text.replace("Two small buildings", "Something else"),))
    assert "Something else" in pound("run", "two.yaml")[1]
    if change == "another program":
        monkeypatch.setattr(running, "program_digest", lambda: "of another program")
    elif change == "no cache":
        cache.unlink()
    elif change == "damaged summary":
        with contextlib.closing(sqlite3.connect(cache)) as kept, kept:
            kept.execute("UPDATE summary SET text = '{'")
    else:
        (folder / "two.yaml").write_text(TWO + "# a comment\n")
    assert without_times(pound("run", "two.yaml")[1]) == without_times(first)


def test_quiet_prints_nothing(folder, pound):
    assert pound("run", "two.yaml", "-q") == (0, "", "")


UNSTABLE = TWO.replace("estimate: none", "method: central-difference\ntime_step: 20 ms").replace(", inelastic", "")


def test_failed_scenes_are_listed_and_the_exit_code_is_1(folder, pound):
    (folder / "two.yaml").write_text(UNSTABLE)
    code, out, err = pound("run", "two.yaml", "-q")
    assert (code, out) == (1, "")
    failed = [line for line in err.splitlines() if line.startswith("failed: ")]
    assert failed[0] == "failed: touching, elastic, elcentro: unstable step"
    assert len(failed) == 4
    assert "time step below" in err
    code, out, _ = pound("run", "two.yaml")
    assert code == 1
    assert "4 reused, 4 failed" in out
    found = pounding_cli.open_results("results/two.h5")
    assert (found.scene()["status"] == "unstable step").all()
    assert found.storey()["V"].isna().all()
    assert found.storey()["V0"].notna().all()


def test_json_lines_and_nothing_else(folder, pound):
    (folder / "two.yaml").write_text(UNSTABLE)
    code, out, err = pound("run", "two.yaml", "--log-json")
    assert (code, err) == (1, "")
    lines = [json.loads(line) for line in out.splitlines()]
    assert [line["event"] for line in lines if line["event"] != "progress"] == ["start", *["failed"] * 4, "end"]
    assert {line["scene"] for line in lines if line["event"] == "failed"} >= {"gap, elastic, taft"}
    end = lines[-1]
    assert (end["done"], end["failed"], end["reused"]) == (4, 4, 0)
    assert end["results"] == os.path.join("results", "two.h5")


def test_a_collapse_is_no_failure(folder, pound):
    """It is counted, left out of the means, and told by `show` and `compare`."""
    (folder / "two.yaml").write_text(
        TWO.replace("mass: 200 t", "mass: 200 t, collapse: 0.18 %").replace("elastic, inelastic", "inelastic")
    )
    code, out, _ = pound("run", "two.yaml", "-o", "a.h5")
    assert code == 0
    scene = pounding_cli.open_results("a.h5").scene()
    down = scene[scene["status"] == "collapsed"]
    assert 0 < len(down) < len(scene)
    assert (down["collapse_time"] > 0).all()
    assert "collapsed" in out
    assert "0 failed" in out
    summary = pounding_cli.open_results("a.h5").summary()
    assert summary["records_collapsed"].max() == 1
    (folder / "two.yaml").write_text(TWO.replace("elastic, inelastic", "inelastic"))
    pound("run", "two.yaml", "-o", "b.h5", "-q")
    assert f"{len(down)} with another outcome" in pound("compare", "a.h5", "b.h5")[1]


def test_a_case_without_meaning_is_marked(folder, pound):
    """A connector that closes the whole gap: the floors would have struck."""
    spring = "spring: {link: connector, gap: 1 mm, stiffness: 1 kN/mm}"
    (folder / "two.yaml").write_text(TWO.replace("gap: {link: pounding, gap: 5 mm}", spring).replace(", inelastic", ""))
    _, out, _ = pound("run", "two.yaml")
    rows = [line for line in out.splitlines() if line.startswith(" spring")]
    assert len(rows) == 3
    assert "† Case spring, elastic: the numbers mean nothing under 2 of 2 motions" in out
    assert all("†" in row for row in rows)
    assert not any("†" in line for line in out.splitlines() if line.strip().startswith("touching"))
    assert "Not meaningful (†): spring, elastic, 2 of 2 rows" in out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["nothing.yaml"], "nothing.yaml"),
        (["two.yaml", "-o", "."], "folder"),
        (["two.yaml", "-o", "two.yaml"], "reads"),
        (["two.yaml", "-o", "two.yaml/r.h5"], "cannot be written"),
        (["two.yaml", "--workers", "0"], "range"),
        (["two.yaml", "--engine", "abacus"], "abacus"),
        (["two.yaml", "--scheduler", "tcp://node:8786"], "--engine dask"),
        ([], "STUDY"),
    ],
)
def test_refused_before_anything_is_solved(folder, pound, arguments, message):
    before = sorted(folder.rglob("*"))
    code, out, err = pound("run", *arguments)
    assert (code, out) == (2, "")
    assert message in err
    assert "Traceback" not in err
    assert sorted(folder.rglob("*")) == before


def test_ctrl_c_keeps_what_is_solved_and_says_how_to_go_on(folder, pound):
    study = TWO.replace("3 s", "15 s") + "sweep: {impact.restitution: {from: 0.3, to: 0.9, count: 1200}}\n"
    (folder / "two.yaml").write_text(study)
    # a shell's background job is born deaf to Ctrl-C
    script = f"import signal; signal.signal(signal.SIGINT, signal.default_int_handler); {MAIN}"
    running = subprocess.Popen(
        [sys.executable, "-c", script, "run", "two.yaml", "-o", "r.h5", "--engine", "serial"],
        stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    while (not (kept := Path("r.h5.cache-wal")).exists() or kept.stat().st_size < 2e5) and running.poll() is None:
        time.sleep(0.02)
    running.send_signal(signal.SIGINT)
    _, err = running.communicate(timeout=60)
    assert running.returncode == 130, err
    assert int(re.search(r"(\d+) time histories solved now and kept in r.h5.cache", err)[1]) > 0
    assert "same command" in err
    assert "Traceback" not in err
    assert not Path("r.h5").exists()


def test_python_gives_the_same_tables(folder, pound):
    pound("run", "two.yaml", "-q")
    results = pounding_cli.open_results("results/two.h5")
    again = pounding_cli.run("two.yaml", "again.h5")
    for name in ("storey", "floor", "link"):
        assert results.table(name).equals(again.table(name))
    assert again.title == "Two small buildings"
