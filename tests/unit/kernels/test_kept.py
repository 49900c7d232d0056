"""Compiled kernels on disk: damage is found before it is used, and no cache stops a run. The cache is numba's own, of a
function small enough to be compiled again and again."""

from __future__ import annotations

import errno
import fcntl
import importlib.util
import os
import sys
import threading
from pathlib import Path

import numba
import numba.core.caching
import pytest

from pounding_cli.kernels import kept

SOURCE = "from numba import njit\n\n\n@njit(cache=True)\ndef twice(x):\n    return 2 * x\n"


@pytest.fixture
def run(tmp_path, monkeypatch):
    """Load the function as a new process would, and call it through `kept`: its result and its cache hits."""
    source = tmp_path / "kernel_of_a_test.py"
    source.write_text(SOURCE)
    monkeypatch.setattr(kept, "FOLDER", tmp_path / "__pycache__")

    def call() -> tuple[int, int]:
        kept._seen.clear()
        kept.notes.clear()
        spec = importlib.util.spec_from_file_location("kernel_of_a_test", source)
        module = importlib.util.module_from_spec(spec)
        monkeypatch.setitem(sys.modules, "kernel_of_a_test", module)
        spec.loader.exec_module(module)
        found = kept.loaded(lambda: module.twice(21))
        return found, sum(module.twice.stats.cache_hits.values())

    return call


def files(ending: str = "") -> list[Path]:
    return [path for path in sorted(kept.FOLDER.iterdir()) if path.name.endswith(ending or (".nbi", ".nbc"))]


def test_a_sound_cache_is_used(run):
    assert run() == (42, 0)
    assert len(files()) == len(files(kept.SUM)) == 2
    assert run() == (42, 1)
    assert kept.notes == []


def test_who_waits_is_told_once_that_a_kernel_is_compiled(run):
    """Two are compiled, and none when it is loaded. Fails if a user reads twice that kernels are compiled, or reads it
    in later runs."""
    told = []
    with kept.when_compiling(lambda: told.append("compiled")):
        run()
        assert told == ["compiled"]
        numba.njit(lambda x: x)(1)
    assert told == ["compiled"]
    with kept.when_compiling(lambda: told.append("loaded")):
        assert run() == (42, 1)
    numba.njit(lambda x: x)(2)
    assert told == ["compiled"]


@pytest.mark.parametrize("ending", [".nbi", ".nbc", kept.SUM])
def test_truncated_files_are_compiled_anew(run, ending):
    run()
    for path in files(ending):
        os.truncate(path, 0)
    assert run() == (42, 0)
    assert "were damaged" in kept.notes[0]
    assert run() == (42, 1)
    assert kept.notes == []


def test_everything_truncated_is_compiled_anew(run):
    run()
    for path in kept.FOLDER.iterdir():
        os.truncate(path, 0)
    assert run() == (42, 0)
    assert run() == (42, 1)


def test_a_flipped_bit_is_never_run(run):
    run()
    (code,) = files(".nbc")
    whole = code.read_bytes()
    for place in range(0, len(whole), max(1, len(whole) // 12)):
        bad = bytearray(whole)
        bad[place] ^= 4
        code.write_bytes(bad)
        assert run() == (42, 0)


def test_damage_in_a_cache_that_never_had_checksums_is_survived(run):
    run()
    for path in files(kept.SUM):
        path.unlink()
    assert run() == (42, 1)  # sound ones are taken over
    assert len(files(kept.SUM)) == 2
    for path in files(kept.SUM):
        path.unlink()
    for path in files():
        os.truncate(path, 10)
    assert run() == (42, 0)
    assert "were damaged" in kept.notes[0]


def test_a_full_folder_is_done_without(run, monkeypatch):
    def full(*_):
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as disk:
        disk.setattr(numba.core.caching.IndexDataCacheFile, "_dump", full)
        assert run() == (42, 0)
    assert "cannot be kept" in kept.notes[0]
    assert "No space left on device" in kept.notes[0]
    assert files() == []


def test_other_faults_are_not_taken_for_the_cache():
    calls = []

    def fails():
        calls.append(1)
        raise ValueError("of the kernel")

    with pytest.raises(ValueError, match="of the kernel"):
        kept.loaded(fails)
    assert len(calls) == 1


def test_a_cache_that_is_being_written_is_not_damaged(run):
    """Another process has compiled and is about to write a checksum. Fails if its files are deleted."""
    run()
    (late,) = (path for path in files(kept.SUM) if path.name.endswith(f".nbc{kept.SUM}"))
    whole = late.read_text()
    late.write_text("00000000\n")
    handle = os.open(kept.FOLDER, os.O_RDONLY)
    fcntl.flock(handle, fcntl.LOCK_SH)

    def finish() -> None:
        late.write_text(whole)
        os.close(handle)

    timer = threading.Timer(0.5, finish)
    timer.start()
    assert run() == (42, 1)
    assert kept.notes == []
    timer.join()


def test_who_writes_for_ever_is_not_waited_for(run, monkeypatch):
    run()
    for path in files():
        os.truncate(path, 0)
    monkeypatch.setattr(kept, "_PATIENCE", 0.2)
    handle = os.open(kept.FOLDER, os.O_RDONLY)
    fcntl.flock(handle, fcntl.LOCK_SH)
    assert run() == (42, 0)
    os.close(handle)


def test_kernels_of_another_user_are_done_without(run, tmp_path, monkeypatch):
    """Files that cannot be read, in a folder where they cannot be deleted either. Fails if every call fails on them."""
    run()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "own"))
    monkeypatch.setattr(numba.config, "CACHE_DIR", "")
    assert kept._readable(kept.FOLDER) == kept.FOLDER
    monkeypatch.setattr(kept.os, "access", lambda path, mode: Path(path).parent != kept.FOLDER)
    own = kept._readable(kept.FOLDER)
    assert own.is_relative_to(tmp_path / "own" / "pound" / "kernels")
    assert "belong to another user" in kept.notes.pop()
    assert run() == (42, 0)
    assert list(own.parent.rglob("*.nbc"))


def test_a_folder_that_everyone_can_write_to_is_told(run):
    run()
    kept.FOLDER.chmod(0o777)
    run()
    assert "everyone can write to" in kept.notes[0]


def test_no_folder_at_all_is_done_without(monkeypatch):
    monkeypatch.setattr(kept, "njit", lambda **_: lambda function: (_ for _ in ()).throw(RuntimeError("no locator")))
    kept.notes.clear()
    assert kept._probe(lambda: None) is None
    assert "NUMBA_CACHE_DIR" in kept.notes.pop()
