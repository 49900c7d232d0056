"""Ctrl-C, SIGTERM and a pool that ends, each in the middle of a time history that takes minutes."""

from __future__ import annotations

import hashlib
import signal
import subprocess
import sys
import threading
import time

import pytest

import pounding_cli as pound
from pounding_cli.batch.pool import open_pool, stop_executor
from pounding_cli.signals import take_signals
from pounding_cli.solver.solve import solve
from tests.adapter import scenes
from tests.warm import all_of

ENDLESS = """\
title: Two high buildings, under a motion of hours
records: {use: [{sine: 1.5 Hz, amplitude: 3 m/s2, cycles: 10000}]}
buildings:
  stiff: {storeys: 40, period: 0.9 s, mass: 100 t}
  soft: {like: stiff, period: 1.7 s}
group: [stiff, soft]
cases: {gap: {link: pounding, gap: 1 cm}}
analyses: [elastic]
estimate: none
"""
METHODS = {
    "taylor": {},
    "dop853": {"method": "dop853"},
    "newmark": {"method": "newmark", "time_step": 1e-3},
}
MAIN = "from pounding_cli.cli.main import main; main()"
SOON = 5.0
"""Time in which whatever was asked to stop has ended [s]: a third of a second where no other test runs."""


@pytest.fixture(scope="module")
def endless(tmp_path_factory) -> pound.Scene:
    """A scene that is not done in minutes; its kernels are compiled first, as nothing stops the compiler."""
    all_of(("taylor", "smooth", "fixed steps"))
    study = tmp_path_factory.mktemp("endless") / "study.yaml"
    study.write_text(ENDLESS)
    return next(scene for _, scene, _ in scenes(study) if scene.links)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_stops_a_kernel(endless, sent, method, monkeypatch):
    before = signal.signal(sent, signal.default_int_handler)
    start = time.monotonic()
    try:
        timer = threading.Timer(0.3, signal.raise_signal, [sent])
        timer.start()
        with pytest.raises(KeyboardInterrupt):
            solve(endless, **METHODS[method])
    finally:
        timer.join()
        signal.signal(sent, before)
    assert time.monotonic() - start < 0.3 + SOON


def test_threads_that_are_ended_leave_their_scenes(endless):
    executor = open_pool("threads", 2).open()
    running = [executor.submit(solve, endless) for _ in range(2)]
    while not all(future.running() for future in running):
        time.sleep(0.01)
    time.sleep(0.2)
    start = time.monotonic()
    stop_executor(executor, running)
    executor.shutdown(wait=True)
    assert time.monotonic() - start < SOON
    assert [type(future.exception()) for future in running] == [KeyboardInterrupt] * 2


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGTERM that a program can take")
def test_a_run_ends_and_nothing_unfinished_is_kept(tmp_path):
    (tmp_path / "study.yaml").write_text(ENDLESS)
    words = [sys.executable, "-c", MAIN, "run", "study.yaml", "-o", "r.h5", "--log-json"]
    running = subprocess.Popen(words, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    while not (tmp_path / "r.h5.cache").exists() and running.poll() is None:
        time.sleep(0.02)
    time.sleep(0.5)
    start = time.monotonic()
    running.send_signal(signal.SIGTERM)
    out, err = running.communicate(timeout=60)
    assert time.monotonic() - start < SOON
    assert running.returncode == 130, out + err
    assert "same command again" in err
    assert "Traceback" not in err
    assert "0 time histories solved now" in out
    assert not (tmp_path / "r.h5").exists()


def test_what_nothing_can_stop_is_cut_off():
    """Here a key that takes half a second to derive, in a library that knows of no flag."""
    ended = threading.Event()
    before = signal.signal(signal.SIGINT, lambda *_: None)
    try:
        with take_signals(0.05, ended.set):
            threading.Timer(0.05, signal.raise_signal, [signal.SIGINT]).start()
            hashlib.pbkdf2_hmac("sha256", b"word", b"salt", 1_000_000)
            assert ended.is_set()
    finally:
        signal.signal(signal.SIGINT, before)
