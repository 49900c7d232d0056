"""When `pound run` starts numba, and what it keeps numba from doing then."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = """
import sys
from pounding_cli.cli.solving import numba_without_blas
if {before}:
    import numba.np.arraymath
held = sys.modules.get("scipy.linalg.cython_blas")
numba_without_blas()
print(sys.modules["numba.np.arraymath"]._HAVE_BLAS)
print("scipy.linalg" in sys.modules)
print(sys.modules.get("scipy.linalg.cython_blas") is held)
import scipy.linalg.cython_blas, scipy.linalg.blas
print(scipy.linalg.blas.ddot([1.0, 2.0], [3.0, 4.0]))
"""


@pytest.mark.parametrize(("before", "words"), [(False, "False False True 11.0"), (True, "True True True 11.0")])
def test_numba_does_without_scipys_linear_algebra(before, words):
    """SciPy is not imported for it, and whole afterwards; who has numba already keeps what it found. Fails if SciPy's
    module stays hidden, or is taken from a numba that is there."""
    program = PROGRAM.format(before=before)
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60, check=True)
    assert done.stdout.split() == words.split()


def test_a_spawned_worker_reads_no_study():
    """Fails if what a worker imports brings the schema of studies with it: a tenth of a second for each."""
    program = "import sys, pounding_cli.batch.processes; print('pydantic' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60, check=True)
    assert done.stdout.split() == ["False"]


RUN = """
import sys
from pounding_cli.cli.main import main
sys.argv = ["pound", "run", "study.yaml", *sys.argv[1:]]
try:
    main()
except SystemExit as end:
    maths = sys.modules.get("numba.np.arraymath")
    print(end.code, "numba" in sys.modules, "scipy.linalg" in sys.modules, maths and maths._HAVE_BLAS)
"""

SOUND = (Path(__file__).parents[3] / "configs" / "quickstart.yaml").read_text(encoding="utf-8")

WARNED = SOUND + "impact: {dashpot: printed}\n"

UNSOUND_TOGETHER = (
    WARNED.replace("{link: pounding, gap: 5 cm}", "{link: pounding, gap: 5 cm, floors: [1]}")
    + "sweep: {buildings.stiff.storeys: [5, 2], cases.gap.floors: [[1], [3]]}\n"
)
"""Every value is sound by itself, but floor 3 of two storeys is none: found when the study is expanded."""


def run(folder: Path, study: str | None, *options: str) -> tuple[list[str], str]:
    """`pound run study.yaml` in a process of its own.

    Returns the lines it printed and what it said to stderr; the last line: exit code, whether numba and SciPy's linear
    algebra were imported, whether numba found a BLAS.
    """
    if study is not None:
        (folder / "study.yaml").write_text(study, encoding="utf-8")
    command = [sys.executable, "-c", RUN, *options]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=60, check=True)
    return done.stdout.splitlines(), done.stderr


@pytest.mark.parametrize(
    ("study", "message"),
    [
        (None, "no such file"),
        ("title: [x\n", "this is not YAML"),
        (SOUND + "titel: x\n", "unknown key 'titel'"),
        (UNSOUND_TOGETHER, "no common floor 3"),
    ],
)
def test_a_refused_study_starts_no_numba(tmp_path, study, message):
    """Twice as quick. Fails if numba, or the solver with it, is imported before the study is read and expanded."""
    printed, said = run(tmp_path, study)
    assert printed == ["2 False False None"]
    assert message in said


def test_warnings_of_a_refused_study_are_told(tmp_path):
    """Before the refusal, as lines and as JSON."""
    printed, said = run(tmp_path, UNSOUND_TOGETHER)
    assert 0 <= said.index("warning: ") < said.index("error: ")
    printed, said = run(tmp_path, UNSOUND_TOGETHER, "--log-json")
    warning, end = printed
    assert json.loads(warning)["event"] == "warning"
    assert "eq. (7)" in json.loads(warning)["text"]
    assert end == "2 False False None"
    assert said.startswith("error: ")


@pytest.mark.parametrize("accuracy", ["1e-6", "auto"])
def test_a_run_starts_numba_without_scipys_linear_algebra(tmp_path, accuracy):
    """An output that is refused ends the run when numba is there. Fails if expanding a study starts numba on its own,
    or if anything on the way imports SciPy's linear algebra."""
    printed, said = run(tmp_path, f"{SOUND}accuracy: {accuracy}\n", "-o", ".")
    assert printed == ["2 True False False"]
    assert "the output is a folder" in said
