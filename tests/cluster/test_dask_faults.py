"""What can go wrong with a cluster: told in a sentence, with what to do, in time, and nobody is left behind."""

from __future__ import annotations

import http.server
import os
import signal
import socket
import subprocess
import sys
import textwrap
import threading
import time

import dask.config
import distributed  # noqa: F401  its defaults have to stand before a test sets one and takes it back
import pytest

from pounding_cli.batch import cluster, run_plan
from pounding_cli.errors import InputError
from tests.helpers.clusters import IMPORTED, AfterSome
from tests.helpers.slow_solver import solve_slowly


@pytest.fixture
def refused(plan, tmp_path, monkeypatch, capfd):
    """Runs the plan on a scheduler that fails it; returns the one problem told, and nothing else may be said.

    A busy machine may take long to answer: `patience` is short only where nobody will. Dask's own is longer than any
    run here may take.
    """

    def run(address: str, progress=None, patience: float = 180.0):
        monkeypatch.setattr("pounding_cli.batch.cluster.PATIENCE", patience)
        capfd.readouterr()  # what Dask said while a busy machine started it
        begin = time.monotonic()
        with dask.config.set({"distributed.comm.timeouts.connect": "600s"}), pytest.raises(InputError) as refusal:
            run_plan(
                plan,
                tmp_path / "d.h5",
                engine_name="dask",
                scheduler=address,
                solve=solve_slowly,
                progress=progress,
            )
        assert time.monotonic() - begin < 500  # starting takes minutes on a busy machine; Dask waits longer
        time.sleep(0.3)  # what is said late is said too
        assert capfd.readouterr() == ("", "")
        (problem,) = refusal.value.problems
        assert "\n" not in problem.message
        return problem

    return run


@pytest.fixture
def less_patient(monkeypatch):
    """From now on nobody will answer, or no worker come."""
    return lambda: monkeypatch.setattr("pounding_cli.batch.cluster.PATIENCE", 8.0)


@pytest.mark.parametrize(
    ("address", "told"),
    [
        ("http://127.0.0.1:8786", "no scheduler is reached by http://"),
        ("foo://127.0.0.1:8786", "no scheduler is reached by foo://"),
        ("tcp://127.0.0.1", "no port"),
        ("127.0.0.1:dask", "no port"),
    ],
)
def test_an_address_that_can_be_none(refused, address, told):
    problem = refused(address)
    assert told in problem.message
    assert "tcp://HOST:8786" in problem.hint


def test_a_scheduler_that_is_not_there(refused, tmp_path):
    problem = refused("tcp://127.0.0.1:9", patience=2.0)
    assert "tcp://127.0.0.1:9 does not answer" in problem.message
    assert "run the same command again" in problem.hint
    assert [path.name for path in tmp_path.glob("d.h5*")] == ["d.h5.parts"]


@pytest.mark.parametrize("kind", ["a web page", "nothing at all"])
def test_a_port_that_is_not_a_schedulers(refused, kind):
    """Such as the dashboard's. Fails if the time that connecting takes is left to Dask."""
    if kind == "a web page":
        server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), http.server.SimpleHTTPRequestHandler)
        threading.Thread(target=server.serve_forever, daemon=True).start()
        port, close = server.server_address[1], server.shutdown
    else:
        listening = socket.create_server(("127.0.0.1", 0))
        port, close = listening.getsockname()[1], listening.close
    try:
        problem = refused(f"tcp://127.0.0.1:{port}", patience=2.0)
    finally:
        close()
    assert "does not answer" in problem.message
    assert "dashboard's (8787)" in problem.hint


def test_a_scheduler_that_is_killed(refused, machines, less_patient):
    """Fails if the futures it cancels end in a traceback."""
    address, scheduler = machines.scheduler()
    machines.worker(address)
    machines.wait(address, 1)
    problem = refused(address, AfterSome(lambda: (less_patient(), scheduler.kill())))
    assert f"{address} does not answer" in problem.message
    assert "solved scenes are kept" in problem.hint


def test_workers_that_are_all_killed(refused, machines, less_patient):
    """Fails if the scenes they were at are waited for."""
    address, _ = machines.scheduler()
    workers = [machines.worker(address) for _ in range(2)]
    machines.wait(address, 2)
    problem = refused(address, AfterSome(lambda: (less_patient(), [worker.kill() for worker in workers])))
    assert "has had no worker for 8 s" in problem.message
    assert f"dask worker {address}" in problem.hint


def test_workers_that_are_killed_before_they_send_a_result(refused, machines, less_patient, monkeypatch):
    """Fails if a result that does not come is taken for a scheduler that does not answer."""
    address, _ = machines.scheduler()
    workers = [machines.worker(address) for _ in range(2)]
    machines.wait(address, 2)
    received = cluster._received

    def killed_first(*arguments):
        less_patient()
        for worker in workers:
            worker.kill()
            worker.wait()
        return received(*arguments)

    monkeypatch.setattr(cluster, "_received", killed_first)
    assert "has had no worker for 8 s" in refused(address).message


@pytest.mark.parametrize("where", ["scheduler", "workers"])
def test_the_package_is_missing(refused, machines, where):
    address, _ = machines.scheduler(without=where == "scheduler")
    machines.worker(address, without=where == "workers")
    machines.wait(address, 1)
    problem = refused(address)
    assert f"the {where} cannot" in problem.message
    assert "pounding_cli" in problem.message
    assert "install this version of pounding-cli" in problem.hint


PROGRAM = """
    import pathlib, signal, subprocess, sys, warnings
    warnings.filterwarnings("ignore", "coroutine .* was never awaited")  # Dask's, where it has no time to close
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background job ignores it
    sys.path[:0] = {imported!r}
    import pounding_cli.batch.cluster, pounding_cli.batch.runner
    from pounding_cli.batch.progress import Quiet
    from tests.helpers.slow_solver import solve_slowly
    from tests.helpers.plans import small_plan

    class Telling(subprocess.Popen):
        def __init__(self, *arguments, **options):
            super().__init__(*arguments, **options)
            print(self.pid, flush=True)

    class Working(Quiet):
        def step(self, done, failed):
            print("working", flush=True)

    subprocess.Popen = Telling
    pounding_cli.batch.runner.WORTH_WORKERS = 0.0
    pounding_cli.batch.cluster.GOODBYE = {goodbye}
    pounding_cli.batch.cluster.PATIENCE = 180.0  # a busy machine may take minutes to start workers
    plan = small_plan(records=tuple((f"r{{n}}", float(n)) for n in range(1, 60)))
    file = pathlib.Path({output!r})
    try:
        pounding_cli.batch.run_plan(plan, file, engine_name="dask", workers=2, solve=solve_slowly, progress=Working())
    except KeyboardInterrupt:
        sys.exit(130)
"""


@pytest.mark.skipif(not hasattr(os, "killpg"), reason="process groups")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL])
@pytest.mark.parametrize(("moment", "goodbye"), [("starting", 5.0), ("working", 5.0), ("working", 0.0)])
def test_a_cluster_on_this_machine_ends_with_the_run(tmp_path, moment, goodbye, number):
    """Ctrl-C while its workers start and while they work, and the program killed. Fails if the cluster gets the Ctrl-C
    itself, if it is not told that the program is gone, or if a connection that closes too late ends in a traceback."""
    program = textwrap.dedent(PROGRAM.format(imported=IMPORTED, output=str(tmp_path / "d.h5"), goodbye=goodbye))
    pipe = subprocess.PIPE
    run = subprocess.Popen([sys.executable, "-c", program], stdout=pipe, stderr=pipe, text=True, start_new_session=True)
    lines = iter(run.stdout.readline, "")
    session = next((line for line in lines if line.strip().isdigit()), None)
    assert session, run.communicate()[1]
    if moment == "working":  # scenes come back from the cluster; those solved here came before it started
        assert next(lines, None), run.communicate()[1]
    os.killpg(run.pid, number)
    _, said = run.communicate(timeout=120)
    assert run.returncode == (130 if number == signal.SIGINT else -number)
    assert said == ""
    deadline = time.monotonic() + 120
    while alive(int(session)) and time.monotonic() < deadline:
        time.sleep(0.1)
    assert not alive(int(session))


def alive(session: int) -> bool:
    try:
        os.killpg(session, 0)
    except OSError:
        return False
    return True


@pytest.fixture
def certificates(tmp_path, monkeypatch):
    """An authority, and a key and certificate signed by it, for all three of Dask's roles."""
    key, cert = str(tmp_path / "key.pem"), str(tmp_path / "cert.pem")
    try:
        subprocess.run(
            ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", "/CN=pound",
             "-keyout", key, "-out", cert],
            check=True, capture_output=True,
        )  # fmt: skip
    except FileNotFoundError:
        pytest.skip("openssl is not installed")
    options = ("--tls-ca-file", cert, "--tls-cert", cert, "--tls-key", key)
    env = {"CA_FILE": cert, "CLIENT__CERT": cert, "CLIENT__KEY": key}
    return options, {f"DASK_DISTRIBUTED__COMM__TLS__{name}": value for name, value in env.items()}


RUN_THERE = """
    import pathlib, sys
    sys.path[:0] = {imported!r}
    import pounding_cli.batch.cluster, pounding_cli.batch.runner
    from tests.helpers.slow_solver import solve_slowly
    from tests.helpers.plans import small_plan

    pounding_cli.batch.runner.WORTH_WORKERS = 0.0
    pounding_cli.batch.cluster.WORK = 0.1
    pounding_cli.batch.cluster.PATIENCE = 100.0  # a busy machine may take minutes to answer
    plan = small_plan(records=tuple((f"r{{n}}", float(n)) for n in range(1, 16)))
    outcome = pounding_cli.batch.run_plan(
        plan, pathlib.Path({output!r}), engine_name="dask", scheduler={address!r}, solve=solve_slowly
    )
    assert outcome.done == len(plan.scenes) - outcome.reused
    print(outcome.engine)
"""


def test_a_scheduler_behind_tls(refused, machines, certificates, tmp_path):
    """With certificates from Dask's configuration, which a process reads when it starts; without them in a sentence."""
    options, environment = certificates
    address, _ = machines.scheduler("--protocol", "tls", *options)
    machines.worker(address, *options)
    assert address.startswith("tls://")
    assert "no certificates" in refused(address).message
    program = textwrap.dedent(RUN_THERE.format(imported=IMPORTED, output=str(tmp_path / "t.h5"), address=address))
    run = [sys.executable, "-c", program]
    done = subprocess.run(run, capture_output=True, text=True, env=os.environ | environment, timeout=200)
    assert done.stdout.split()[-1:] == ["dask"], done.stderr
