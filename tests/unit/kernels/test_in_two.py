"""Kernels whose pieces are compiled in two processes: what the other one does, and what is done without it."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from pounding_cli.kernels.pipelines import QUICK
from pounding_cli.solve import solve
from tests.helpers.scenes import INELASTIC, gather, pair, shake

pytestmark = pytest.mark.skipif(
    not QUICK or sys.platform != "linux", reason="by our pipeline, and where a process can be forked safely"
)

KERNELS = """
from numba import njit, types
from pounding_cli.kernels.frame import DOUBLES
from pounding_cli.kernels.layout import CALLED, OPTIONS, PART
from pounding_cli.kernels.pipelines import in_two
from pounding_cli.kernels.simd import no_inline, pointer

@njit(**PART)
def square(x):
    return x * x

@njit(**CALLED)
def squares(values, n):
    no_inline()
    total = 0.0
    for k in range(n):
        total += square(values[k])
    return total

@njit(**CALLED)
def last(spare, values, n):
    no_inline()
    return values[n - 1]

@njit(**CALLED)
def first_and_last(values, n):
    no_inline()
    return values[0], last(5.0, values, n)

PIECES = {
    squares: types.float64(DOUBLES, types.int64),
    first_and_last: types.UniTuple(types.float64, 2)(DOUBLES, types.int64),
}
BOTH = OPTIONS | in_two("test.share", PIECES)

@njit(**BOTH)
def mean(values):
    return squares(pointer(values), values.size) / values.size

@njit(**BOTH)
def more(values):
    first, last = first_and_last(pointer(values), values.size)
    return squares(pointer(values), values.size) + 100.0 * first + 1000.0 * square(last)

@njit(**OPTIONS)
def by_itself(values):
    return last(7.0, pointer(values), values.size)

@njit(**BOTH)
def wrong(values):
    return squares(pointer(values), values.size) + "two"
"""

DRIVER = """
import os, signal, sys, threading
import numpy as np
import kernels_in_two as m
from pounding_cli.kernels import apart, kept, pieces

VALUES = np.array([1.0, 2.0, 3.0])
forks, here = [], []
fork, compile = os.fork, pieces.Share._compile

def count_forks():
    forks.append(fork())
    return forks[-1]

def note_here(share):
    here.append(share.name)
    return compile(share)

os.fork, pieces.Share._compile = count_forks, note_here

def call(kernel):
    return float(kept.loaded(lambda: kernel(VALUES)))

def told(*more):
    try:
        os.waitpid(-1, os.WNOHANG)
        left = "a process is left"
    except ChildProcessError:
        left = "none left"
    print(*more, len(forks), "forks", len(here), "here", left)
"""

MEAN, MORE = 14 / 3, 14.0 + 100.0 + 9000.0


@pytest.fixture
def told(tmp_path):
    """What a process prints that runs the code after the driver's, with compiled kernels in a folder of the test."""
    (tmp_path / "kernels_in_two.py").write_text(KERNELS)
    (tmp_path / "driver.py").write_text(DRIVER)

    def run(code: str, status: int = 0) -> str:
        path = os.pathsep.join([str(tmp_path), *sys.path])
        variables = os.environ | {"PYTHONPATH": path, "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
        command = [sys.executable, "-c", "from driver import *\n" + code]
        done = subprocess.run(command, env=variables, capture_output=True, text=True, timeout=100, check=False)
        assert done.returncode == status, done.stderr
        return done.stdout.strip()

    return run


def test_a_kernel_does_not_call_the_pieces_of_a_share_by_their_names(told):
    """Inside of a share a piece loses arguments that it does not use. Fails if a kernel that has the same piece, loaded
    after the share, calls that one: it reads what was never given to it."""
    words = told("call(m.more); print(call(m.by_itself), call(m.by_itself))").split()
    assert words == ["3.0", "3.0"]


def test_a_share_is_compiled_by_another_process_once(told):
    """The second kernel takes what the first one has, in this process, and from the disk in the next, each alone, and
    called by itself, not through `kept`. Fails if this process compiles the share (1 here), if a kernel compiles it
    again (2 forks), or if a kernel on disk lacks it: then it calls address 0."""
    assert told("told(call(m.mean), call(m.more))") == f"{MEAN} {MORE} 1 forks 0 here none left"
    for kernel, value in (("more", MORE), ("mean", MEAN)):
        assert told(f"told(call(m.{kernel}))") == f"{value} 0 forks 0 here none left"
    assert told("told(float(m.mean(VALUES)), float(m.more(VALUES)))") == f"{MEAN} {MORE} 0 forks 0 here none left"


def test_a_kernel_takes_the_share_of_one_that_was_loaded(told):
    """Fails if a kernel that is compiled beside loaded ones compiles their pieces again."""
    assert told("told(call(m.mean))").startswith(f"{MEAN} 1 forks")
    assert told("told(call(m.mean), call(m.more))") == f"{MEAN} {MORE} 0 forks 0 here none left"


@pytest.mark.parametrize(
    "planted",
    [
        "os.kill(forks[-1], signal.SIGKILL)",
        "os.kill(forks[-1], signal.SIGSTOP)",
        "os.kill(forks[-1], signal.SIGKILL); os.waitpid(forks[-1], 0)",
    ],
    ids=["killed", "stopped", "waited-for"],
)
def test_what_the_other_process_does_not_give_is_compiled_here(told, planted):
    """Killed, stopped, or killed and waited for by somebody else, as it begins. Fails, by this test's time limit or a
    wrong sum, if its bytes are waited for without end or taken as they are."""
    code = f"""
apart.PATIENCE = 0.1, 0.0
def forked():
    if count_forks():
        {planted}
    return forks[-1]
os.fork = forked
told(call(m.mean), call(m.more))
"""
    assert told(code) == f"{MEAN} {MORE} 1 forks 1 here none left"
    assert told("told(call(m.more))") == f"{MORE} 0 forks 0 here none left"


def test_what_the_other_process_gives_in_part_is_not_taken(told):
    """It ends while it writes, as on a full disk. Fails if half of the machine code is loaded."""
    code = """
def cut(share):
    code = note_here(share)
    if os.getpid() != PARENT:
        other._file.write(code[: len(code) // 2])
        other._file.flush()
        os._exit(0)
    return code

class Kept(apart.Apart):
    def __init__(self, work):
        global other
        other = self
        super().__init__(work)

PARENT = os.getpid()
pieces.Apart, pieces.Share._compile = Kept, cut
told(call(m.mean))
"""
    assert told(code) == f"{MEAN} 1 forks 1 here none left"


def test_the_other_process_ends_with_this_one(told):
    """Which is killed while both compile; the pipe that both print to is read to its end. Fails if the other process
    goes on, and holds the terminal or the pipe as long as it takes."""
    code = """
import time
def forked():
    if count_forks():
        time.sleep(0.5)
        os.kill(os.getpid(), signal.SIGKILL)
    return forks[-1]
os.fork, pieces.Share._compile = forked, lambda share: time.sleep(60)
call(m.mean)
"""
    begin = time.monotonic()
    assert told(code, -signal.SIGKILL) == ""
    assert time.monotonic() - begin < 50


@pytest.mark.parametrize(
    "planted",
    [
        "threading.Thread(target=threading.Event().wait, daemon=True).start()",
        "def refuse(): raise BlockingIOError('no more processes')\nos.fork = refuse",
        "import multiprocessing\nmultiprocessing.parent_process = lambda: 'a run'",
    ],
    ids=["threads", "no-process", "worker"],
)
def test_a_kernel_is_compiled_alone_where_no_process_may_be_forked(told, planted):
    """Beside another thread, whose locks a fork would copy closed, where no process is left, or in a process
    that another one has begun. Fails if a process is forked all the same, or if the kernel is not compiled."""
    assert told(f"{planted}\ntold(call(m.mean), call(m.more))") == f"{MEAN} {MORE} 0 forks 0 here none left"


def test_a_kernel_that_cannot_be_compiled_ends_the_other_process(told):
    """And the next one, whose pieces are declared by then, is compiled. Fails if the other process is left to itself,
    or if the code of the pieces is looked for there."""
    code = """
from numba.core.errors import TypingError
try:
    call(m.wrong)
except TypingError:
    told("refused")
told(call(m.mean))
"""
    assert told(code).splitlines() == ["refused 1 forks 0 here none left", f"{MEAN} 1 forks 1 here none left"]


def test_a_piece_that_is_declared_wrongly_is_refused(told):
    """Fails if a kernel takes for an integer what is a double."""
    code = """
from numba import int64
m.PIECES[m.squares] = int64(*m.PIECES[m.squares].args)
m.BOTH["pipeline_class"].share._pieces.update(m.PIECES)
try:
    call(m.mean)
except TypeError as error:
    told(error)
"""
    assert told(code).startswith("test.share.kernels_in_two.squares gives float64, not int64 1 forks 1 here")


def pair_that_strikes() -> str:
    """Numbers of an inelastic pair and of its tangent, to the last bit."""
    response = solve(pair("pounding", 0.0, shake(6.0), INELASTIC), tangent=True)
    numbers = [gather(response, name).ravel() for name in ("shear", "ductility", "acceleration")]
    return np.concatenate([*numbers, response.links.peak_force, response.moved]).tobytes().hex()


def test_the_integrator_is_compiled_in_two(told):
    """Every piece that is declared is called as it is declared, and the numbers are those that this process finds.
    Fails if a declaration meets no call: the piece would be compiled twice; or if code in two computes otherwise."""
    code = f"""
sys.path.insert(0, {str(Path(__file__).parent)!r})
import test_in_two
found = test_in_two.pair_that_strikes()
from pounding_cli.kernels import taylor
share = taylor._options()["pipeline_class"].share
missed = [p.__name__ for p, s in share._pieces.items() if not isinstance(p.overloads[s.args].library, pieces._Declared)]
print(missed, len(here), found)
"""
    assert told(code) == f"[] 0 {pair_that_strikes()}"
