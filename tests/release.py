"""Builds the wheel and the sdist and tries them away from the source: `python -m tests.release` (`make dist`).

The wheel is built from the sdist. It is installed into a fresh environment of every Python named (3.11, 3.12 and 3.13
by default), the sdist into that of the first, in an empty folder and with an empty home. There the first steps of the
tutorial are run. A study is then run in this process, in forked workers and in spawned ones, which macOS and Windows
use: all three must give the same rows."""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tarfile
import tempfile
import time
import zipfile
from pathlib import Path

ROOT = Path(__file__).parents[1]
PYTHONS = ("3.11", "3.12", "3.13")
STEPS = (
    ("init", "my-study"),
    ("check", "my-study.yaml"),
    ("run", "my-study.yaml"),
    ("show", "results/my-study.h5"),
    ("report", "results/my-study.h5"),
    ("init", "published", "--like", "impact-oscillator"),
    ("check", "published.yaml"),
)
"""The first steps of the tutorial, and a study like one that the wheel brings with it."""

WORKERS = """
import multiprocessing
import pathlib
import sys

import pounding_cli
from pounding_cli.batch import solve

STUDY = {
    "records": {"use": ["elcentro", "taft"], "duration": "2 s"},
    "buildings": {"a": {"storeys": 2, "period": "0.3 s"}, "b": {"storeys": 2, "period": "0.5 s"}},
    "group": ["a", "b"],
    "cases": {"near": {"link": "pounding", "gap": "1 mm"}},
    "sweep": {"cases.near.gap": ["1 mm", "5 mm", "1 cm", "2 cm"]},
}

if __name__ == "__main__":
    place = pathlib.Path(pounding_cli.__file__)
    assert place.is_relative_to(sys.prefix), f"{place} is not what was installed"
    solve.MIN_PARALLEL_SECONDS = 0.0  # small as it is
    found = {}
    for name in ("serial", "fork", "spawn"):
        if name != "serial":
            multiprocessing.set_start_method(name, force=True)
        engine = "serial" if name == "serial" else "processes"
        results = pounding_cli.run(STUDY, f"{name}.h5", engine=engine, workers=2)
        assert results.attrs["engine"] == engine, results.attrs["engine"]
        found[name] = [results.storey(), results.floor(), results.link(), results.scene().drop(columns="seconds")]
    for name in ("fork", "spawn"):
        assert all(a.equals(b) for a, b in zip(found["serial"], found[name], strict=True)), name
    print(f"{len(found['spawn'][0])} rows of storeys are the same in this process, forked and spawned")
"""

NEEDED = {
    "wheel": (
        "pounding_cli/py.typed",
        "pounding_cli/data/records/catalogue.yaml",
        "pounding_cli/study/text/templates/pair.yaml",
        "pounding_cli/report/assets/page.html.j2",
    ),
    "sdist": (
        "README.md",
        "LICENSE",
        "CHANGELOG.md",
        "CITATION.cff",
        "records/catalogue.yaml",
        "tests/release.py",
        "docs/index.md",
    ),
}
"""Files without which an archive is of no use."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--python", action="append", metavar="X.Y", help=f"a version to try; {', '.join(PYTHONS)}")
    wanted = parser.parse_args().python or PYTHONS
    pythons = {version: _python(version) for version in wanted}
    with tempfile.TemporaryDirectory(prefix="pound-release-") as folder:
        archives = _built(Path(folder))
        for number, (version, python) in enumerate(pythons.items()):
            kinds = archives if number == 0 else {"wheel": archives["wheel"]}
            _try(version, python, kinds, Path(folder) / version)


def _python(version: str) -> str:
    """The interpreter of that version: on the PATH, or one of pyenv's."""
    pyenv = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv")) / "versions"
    for place in (shutil.which(f"python{version}"), *sorted(pyenv.glob(f"{version}.*/bin/python"))):
        if place and _said([str(place), "-c", "import sys; print('%d.%d' % sys.version_info[:2])"]) == version:
            return str(place)
    sys.exit(f"there is no Python {version} on the PATH or in {pyenv}; name those you have with --python")


def _said(command: list[str]) -> str:
    """What a command prints; nothing where it fails, as pyenv's shims of versions that are not chosen do."""
    return subprocess.run(command, capture_output=True, text=True).stdout.strip()


def _run(command: list[str | Path], **options: object) -> str:
    """What a command prints; ends the program with all that it said where it fails."""
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **options)  # type: ignore[call-overload]
    if done.returncode:
        sys.exit(f"{done.stdout}\nexit code {done.returncode}: {' '.join(map(str, command))}")
    return done.stdout


def _environment(python: str, folder: Path) -> Path:
    """The interpreter of a fresh virtual environment."""
    _run([python, "-m", "venv", folder])
    return folder / "bin" / "python"


def _built(folder: Path) -> dict[str, Path]:
    """The wheel and the sdist, checked, in dist/."""
    python = _environment(sys.executable, folder / "build")
    _run([python, "-m", "pip", "install", "--quiet", "build", "twine"])
    dist = ROOT / "dist"
    shutil.rmtree(dist, ignore_errors=True)
    _run([python, "-m", "build", "--outdir", dist, ROOT])
    (wheel,), (sdist,) = dist.glob("*.whl"), dist.glob("*.tar.gz")
    print(_run([python, "-m", "twine", "check", "--strict", wheel, sdist]).strip())
    with zipfile.ZipFile(wheel) as files, tarfile.open(sdist) as tar:
        names = {"wheel": files.namelist(), "sdist": [name.partition("/")[2] for name in tar.getnames()]}
    for kind, needed in NEEDED.items():
        if missing := sorted(set(needed) - set(names[kind])):
            sys.exit(f"the {kind} lacks {', '.join(missing)}")
    return {"wheel": wheel, "sdist": sdist}


def _try(version: str, python: str, archives: dict[str, Path], folder: Path) -> None:
    """Install the archives in turns and use them."""
    own = _environment(python, folder / "venv")
    keep = {name: os.environ[name] for name in ("PATH", "LANG", "PIP_INDEX_URL") if name in os.environ}
    for kind, archive in archives.items():
        _run([own, "-m", "pip", "install", "--quiet", archive])
        begin, work = time.monotonic(), folder / kind
        (work / "home").mkdir(parents=True)
        settings = {"cwd": work, "env": {**keep, "HOME": str(work / "home")}}
        for step in STEPS:
            _run([own.with_name("pound"), *step], **settings)
        (work / "workers.py").write_text(WORKERS)
        same = _run([own, "workers.py"], **settings).strip().splitlines()[-1]
        print(
            f"Python {version}, {kind}: the tutorial's first steps; {same} ({time.monotonic() - begin:.0f} s)",
            flush=True,
        )
        _run([own, "-m", "pip", "uninstall", "--quiet", "--yes", "pounding-cli"])


if __name__ == "__main__":
    main()
