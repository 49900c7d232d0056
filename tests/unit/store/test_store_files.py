"""Places where results may be written, and two runs on one file."""

from __future__ import annotations

import os
import signal
import subprocess
import sys

import pytest

from pounding_cli.errors import InputError
from pounding_cli.store import (
    check_results,
    files,
    former_run,
    locked,
    open_results,
    overview,
    solution_key,
    write_results,
)
from pounding_cli.store.files import refused_write
from pounding_cli.store.keys import FORMAT_VERSION
from tests.helpers.plans import FakeStudy, known, small_plan
from tests.helpers.sealing import edited


@pytest.fixture
def results(tmp_path):
    plan = small_plan()
    path = tmp_path / "r.h5"
    write_results(path, plan, {digest: known(scene) for digest, scene in plan.scenes.items()})
    return path


def test_results_of_a_newer_program_are_not_overwritten(results):
    check_results(results, FakeStudy())
    with edited(results) as file:
        file.attrs["format_version"] = FORMAT_VERSION + 1
    with pytest.raises(InputError, match="newer than this program's") as refused:
        check_results(results, FakeStudy(), replace=True)
    assert "move it away" in refused.value.problems[0].hint


def test_the_structure_of_a_file_is_checked_once_for_all_its_tables_and_again_when_it_changed(results, monkeypatch):
    checked = []
    monkeypatch.setattr(files, "_checked", set())
    monkeypatch.setattr(files, "check_study", lambda file: checked.append(file.attrs["title"]))
    found = open_results(results)
    found.storey()
    overview(results)
    assert checked == ["two buildings"]
    with edited(results) as file:
        file.attrs["title"] = "changed"
    overview(results)
    assert checked == ["two buildings", "changed"]


def test_a_former_run_tells_what_keeps_its_scenes_from_being_used(results):
    key = solution_key(1e-6, "taylor")
    assert former_run(results, key).differs == ""
    assert former_run(results, key).scenes == 16
    assert former_run(results, solution_key(1e-9, "taylor")).differs == "accuracy 1e-06 (now 1e-09)"
    assert former_run(results.with_name("none.h5"), key) is None


def test_a_second_run_on_one_file_is_refused(tmp_path):
    path = tmp_path / "r.h5"
    with locked(path):
        with pytest.raises(InputError, match="another run is using this file"), locked(path):
            pass
        with locked(tmp_path / "other.h5"):
            pass
    assert list(tmp_path.iterdir()) == []
    with locked(path):
        pass


HOLD = """
import os, sys, time
from pathlib import Path
from pounding_cli.store.locks import locked
with locked(Path(sys.argv[1])):
    if os.fork() == 0:  # a worker outlives a parent that is killed
        time.sleep(60)
    print("held", flush=True)
    time.sleep(60)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="forks")
def test_a_lock_goes_with_the_process_that_holds_it(tmp_path):
    path = tmp_path / "r.h5"
    holder = subprocess.Popen(
        [sys.executable, "-c", HOLD, path], stdout=subprocess.PIPE, text=True, start_new_session=True
    )
    try:
        assert holder.stdout.readline() == "held\n"
        with pytest.raises(InputError, match=f"process {holder.pid} on") as refused, locked(path):
            pass
        assert "-o FILE.h5" in refused.value.problems[0].hint
        holder.kill()
        holder.wait()
        with locked(path):
            pass
    finally:
        os.killpg(holder.pid, signal.SIGKILL)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (OSError(28, "No space left on device"), "no space left"),
        (OSError("Can't write data (file write failed: No space left on device)"), "no space left"),
        (OSError(27, "File too large"), "no space left"),
        (OSError(30, "Read-only file system", "x"), "may not be written"),
        (OSError(5, "Input/output error"), "Input/output error"),
    ],
)
def test_a_failed_write_is_told_in_words(tmp_path, error, words):
    problem = refused_write(error, tmp_path / "r.h5", tmp_path / "r.h5.parts").problems[0]
    assert words in problem.message
    assert "run the same command again" in problem.hint
    assert str(tmp_path / "r.h5.parts") in problem.hint
