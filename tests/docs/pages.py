"""Blocks of the documentation that a reader would run, and how the tests run them."""

from __future__ import annotations

import contextlib
import importlib.util
import io
import os
import re
import shlex
import shutil
import subprocess
import sys
import types
from dataclasses import dataclass
from pathlib import Path

import yaml

from pounding_cli.cli.main import main

ROOT = Path(__file__).parents[2]
PAGES = sorted([ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "docs").rglob("*.md")])

_FENCE = re.compile(r"^(?P<indent> *)```(?P<word>\w*)[^\n]*\n(?P<text>.*?)^(?P=indent)```", re.MULTILINE | re.DOTALL)
_MARK = re.compile(r"<!-- not run: (?P<reason>.+?) -->\s*\Z")
_NEEDS = re.compile(r"<!-- needs (?P<module>\w+): (?P<reason>.+?) -->\s*\Z")
# Such a block is run every night, where the module is installed.
_SHELL = set("|&;<>(){}$*`!'\"\\")
"""Signs that only a shell understands: a line without them is run in this process, which is much quicker."""


@dataclass(frozen=True)
class Block:
    """A fenced block: its first line in the page, its language, its text, and why it is not run ("" where it is)."""

    line: int
    word: str
    text: str
    reason: str


def blocks(page: Path) -> list[Block]:
    """The fenced blocks of a page, in order."""
    text = page.read_text(encoding="utf-8")
    found = []
    for fence in _FENCE.finditer(text):
        mark = _MARK.search(text[: fence.start()])
        needs = _NEEDS.search(text[: fence.start()])
        if needs and not (os.environ.get("POUND_NIGHTLY") and importlib.util.find_spec(needs["module"])):
            mark = needs
        line = text.count("\n", 0, fence.start()) + 1
        found.append(Block(line, fence["word"], fence["text"], mark["reason"] if mark else ""))
    return found


def hook(name: str) -> types.ModuleType:
    """A module of docs/hooks/, which writes pages from the code."""
    spec = importlib.util.spec_from_file_location(f"hook_{name}", ROOT / "docs" / "hooks" / f"{name}.py")
    module = sys.modules[spec.name] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def generated() -> set[Path]:
    """The pages that the site has besides those of docs/."""
    text = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    named = {ROOT / "docs" / name for name in re.findall(r"^ +- (.+\.md)$", text, re.MULTILINE)}
    return {path for path in named if not path.exists()}


def loose_commands(page: Path) -> list[str]:
    """Command lines outside blocks marked `sh` or `console`: nothing would run them."""
    text = _FENCE.sub(lambda f: "" if f["word"] in ("sh", "console") else f["text"], page.read_text(encoding="utf-8"))
    return re.findall(r"^ *(?:\$ )?(?:pound|make|pip|python -m|git) [a-z.-]+.*$", text, flags=re.MULTILINE)


def run_block(block: Block, folder: Path, names: dict[str, object]) -> None:
    """Run a block's commands where a reader would stand; a `console` block's output must be the one it shows.

    `names` is what the page's Python knows so far.
    """
    if block.word == "python":
        exec(compile(block.text, f"block at line {block.line}", "exec"), names)
        return
    if block.word == "sh":
        _run(block.text, folder)
        return
    for part in re.split(r"^\$ ", block.text, flags=re.MULTILINE)[1:]:
        command, _, shown = part.partition("\n")
        said = _refused(command) if shown.startswith("error:") else _run(command + "\n", folder)
        assert re.fullmatch(pattern(shown), said, flags=re.DOTALL), f"$ {command}\nsaid\n{said}\nnot\n{shown}"


def pattern(shown: str) -> str:
    """A regular expression for output as a page shows it: blanks count as one, `...` stands for anything."""
    found, between = r"\s*", ""
    for word in shown.split():
        if word == "...":
            between = r"(?:.*\s)?" if found == r"\s*" else r"\s(?:.*\s)?"
        else:
            found += between + re.escape(word).replace(r"\.\.\.", ".*?")
            between = r"\s+"
    return found + (r"(?:\s.*)?" if between.endswith(")?") else r"\s*")


def _run(text: str, folder: Path) -> str:
    """Standard output of command lines; a command that fails fails the test."""
    for name in re.findall(r"results/([\w-]+)\.h5", text):
        provide(name, folder)
    if "export " in text:  # what is exported must reach the lines that follow
        return _bash(text)
    said, rest = "", ""
    for line in text.splitlines():
        plain = line.partition(" #")[0]
        if plain.startswith("pound ") and not _SHELL & set(plain):
            said += _bash(rest) + _pound(shlex.split(plain))
            rest = ""
        else:
            rest += line + "\n"
    return said + _bash(rest)


def _bash(text: str) -> str:
    if not text.strip():
        return ""
    done = subprocess.run(["bash", "-euo", "pipefail", "-c", text], capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{text}\n{done.stdout}\n{done.stderr}"
    return done.stdout


def _refused(command: str) -> str:
    """Standard error of a command that must be refused."""
    done = subprocess.run(["bash", "-c", command], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (2, ""), f"{command}\n{done.stdout}"
    return done.stderr


def _pound(arguments: list[str]) -> str:
    if arguments[1] == "report" and any(argument.startswith("results/fig") for argument in arguments):
        arguments = [*arguments, "--no-figures"]  # drawn by tests of their own; README's report is drawn here too
    out, err, before, code = io.StringIO(), io.StringIO(), sys.argv, None
    sys.argv = arguments
    try:
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            main()
    except SystemExit as end:
        code = end.code
    finally:
        sys.argv = before
    assert not code, f"{shlex.join(arguments)}\n{out.getvalue()}\n{err.getvalue()}"
    return out.getvalue()


def provide(name: str, folder: Path) -> None:
    """Results that a page takes for granted: those of a study that ships."""
    path = folder / "results" / f"{name}.h5"
    if path.exists():
        return
    for study in (folder / "configs" / f"{name}.yaml", folder / "configs" / "sensitivity" / f"{name}.yaml"):
        if study.exists():
            _pound(["pound", "run", "-q", "-o", str(path), str(study)])


def stand_in(folder: Path) -> None:
    """The folder a reader stands in: the studies that ship, cut short, so that every command takes moments."""
    shutil.copytree(ROOT / "configs", folder / "configs")
    shutil.copytree(ROOT / "tests" / "hard" / "scenes", folder / "tests" / "hard" / "scenes")
    for path in (folder / "configs").rglob("*.yaml"):
        study = yaml.safe_load(path.read_text(encoding="utf-8"))
        if "records" in study:
            use = study["records"]["use"][: 2 if "uncertain" in study else 1]
            study["records"] |= {"use": use, "duration": "3 s"}
            study |= {"accuracy": 1e-3, "estimate": "none"}
        if "uncertain" in study:
            study["uncertain"] = [entry for entry in study["uncertain"] if "records.duration" not in entry]
            study["sensitivity"]["samples"] = 4
        if "mesh" in study or "wall" in study:
            study |= {"mesh": {"size": "1 m"}, "time": {"end": "20 ms"}}
            study["sweep"] = {"contact.over": ["patch"]}
        path.write_text(yaml.safe_dump(study, sort_keys=False), encoding="utf-8")


def environment(folder: Path) -> dict[str, str]:
    """Home and own motions in the folder; the program of this environment first on the path."""
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
    return {
        "HOME": str(folder / "home"),
        "POUND_HOME": str(folder / "home" / "pound"),
        "PATH": path,
        "MPLBACKEND": "Agg",
    }
