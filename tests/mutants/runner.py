"""Apply each fault of the catalogue to a copy of the project and see that the test named for it fails."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from .markers import markers, mutated

ROOT = Path(__file__).parents[2]
COPIED = ("pounding_cli", "tests", "configs", "records", "pyproject.toml", "README.md")

NOTICED = re.compile(r"^FAILED \S.* - (assert |AssertionError|Failed: DID NOT RAISE)", re.MULTILINE)
"""A test that saw the fault, as opposed to one that broke on it."""


@dataclass(frozen=True)
class Mutant:
    """One fault: the line marked `# fault: marker` becomes another; then `test` (a pytest id) has to fail.

    `becomes` : what the line becomes, where `{line}` stands for what it was; or a piece of it, and what this becomes
    """

    marker: str
    fault: str
    becomes: str | tuple[str, str]
    test: str


@dataclass(frozen=True)
class Outcome:
    """What became of a mutant: `problem` is empty when the test noticed it."""

    mutant: Mutant
    problem: str
    seconds: float


class Copy:
    """The project in a folder of its own, with numba's cache inside; built once, mutated and healed again and again."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.places = dict(markers(ROOT))
        for name in COPIED:
            source = ROOT / name
            if source.is_dir():
                shutil.copytree(source, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
            elif source.exists():
                shutil.copy2(source, folder / name)

    def run(self, tests: Iterable[str], hurried: bool = False) -> subprocess.CompletedProcess[str]:
        """Run some tests in the copy, on the copy; stops at the first failure.

        `hurried` : compile kernels without optimising, in half the time, and keep nothing: numba cannot cache those
        """
        environment = os.environ | {
            "PYTHONPATH": str(self.folder),
            "PYTHONDONTWRITEBYTECODE": "1",
            "NUMBA_CACHE_DIR": str(self.folder / (".numba-hurried" if hurried else ".numba")),
            "NUMBA_OPT": "0" if hurried else "3",
            "COLUMNS": "400",
        }
        options = ["-x", "-rf", "--tb=no", "-p", "no:cacheprovider", "-p", "no:xdist"]
        command = [sys.executable, "-m", "pytest", *options, *tests]
        return subprocess.run(command, cwd=self.folder, env=environment, capture_output=True, text=True)

    def is_what_runs(self) -> bool:
        """Whether `import pounding_cli` in the copy finds the copy."""
        command = [sys.executable, "-c", "import pounding_cli; print(pounding_cli.__file__)"]
        environment = os.environ | {"PYTHONPATH": str(self.folder)}
        found = subprocess.run(command, cwd=self.folder, env=environment, capture_output=True, text=True).stdout
        return Path(found.strip()).is_relative_to(self.folder.resolve())

    def try_mutant(self, mutant: Mutant) -> Outcome:
        """Apply, run the test, heal."""
        begin = time.perf_counter()
        place = self.places.get(mutant.marker)
        if place is None:
            return Outcome(mutant, f"no line is marked '# fault: {mutant.marker}'", 0.0)
        path = self.folder / place.file
        text = path.read_text()
        try:
            changed = mutated(text, place.line, mutant.becomes)
        except ValueError as problem:
            return Outcome(mutant, str(problem), 0.0)
        times = path.stat().st_atime_ns, path.stat().st_mtime_ns
        try:
            path.write_text(changed)
            run = self.run([mutant.test], hurried="/kernels/" in place.file)  # a changed kernel compiles anew
        finally:
            path.write_text(text)
            os.utime(path, ns=times)  # the healthy cache goes by them
            shutil.rmtree(self.folder / ".numba-hurried", ignore_errors=True)
        return Outcome(mutant, verdict(run), time.perf_counter() - begin)


def verdict(run: subprocess.CompletedProcess[str]) -> str:
    """Empty if a test failed by an assertion; else what happened instead."""
    if run.returncode == 0:
        return "the test passes: nothing noticed the fault"
    tail = " | ".join(run.stdout.strip().splitlines()[-3:])
    if run.returncode != 1:
        return f"pytest ended with {run.returncode}: {tail}"
    return "" if NOTICED.search(run.stdout) else f"the test broke instead of noticing the fault: {tail}"


def try_all(mutants: list[Mutant], folder: Path) -> Iterator[Outcome]:
    """Run the tests on the healthy copy, then every mutant.

    Raises
    ------
    RuntimeError : a test fails without any fault, or another package than the copy would be tested
    """
    copy = Copy(folder)
    if not copy.is_what_runs():
        raise RuntimeError("the copy is not what Python imports; run from the repository root")
    healthy = copy.run(sorted({m.test for m in mutants}))
    if healthy.returncode:
        raise RuntimeError("tests fail without any fault:\n" + healthy.stdout[-3000:] + healthy.stderr[-3000:])
    for mutant in mutants:
        yield copy.try_mutant(mutant)
