"""Commands that write: nothing of the user's is lost."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
import yaml

import pounding_cli

from .conftest import TWO

STUDY = TWO.replace(", taft", "").replace("3 s}", "1 s}").replace(", inelastic", "") + "keep: histories\n"
CONFIGS = Path(__file__).parents[2] / "configs"

WRITERS = {
    "run": "run two.yaml -o out",
    "connector": f"connector {CONFIGS}/fig5.yaml -o out",
    "wall": f"wall {CONFIGS}/fig8.yaml -o out",
    "export csv": "export r.h5 storey --format csv -o out.csv",
    "export parquet": "export r.h5 storey -o out.parquet",
    "export excel": "export r.h5 -o out.xlsx",
    "export netcdf": "export r.h5 -o out.nc",
    "schema": "schema -o out",
    "picture": "records show taft -o out.png",
    "report": "report r.h5 -o out",
    "accuracy": "accuracy two.yaml --budget 1s -o out",
}


@pytest.fixture
def results(folder, pound) -> Path:
    pound("run", "two.yaml", "-o", "r.h5", "-q")
    return folder / "r.h5"


@pytest.mark.parametrize("command", WRITERS)
def test_a_file_of_another_kind_is_not_replaced(results, folder, pound, command):
    words = WRITERS[command].split()
    target = Path(words[words.index("-o") + 1])
    target.write_text("my notes, not to be lost")
    before = {path: path.read_bytes() for path in folder.iterdir() if path.is_file()}
    code, out, err = pound(*words)
    assert (code, out) == (2, "")
    assert str(target) in err
    assert len(err.splitlines()) == 2  # what is wrong, and what to do
    assert {path: path.read_bytes() for path in folder.iterdir() if path.is_file()} == before


TARGETS = {
    "a folder": lambda target: target.mkdir(),
    "a device": lambda target: target.symlink_to("/dev/null"),
    "a pipe": os.mkfifo,
    "a link to a file of another kind": lambda target: target.symlink_to("notes"),
    "a hard link to one": lambda target: target.hardlink_to("notes"),
    "a link to the input": lambda target: target.symlink_to("r.h5"),
    "a hard link to the input": lambda target: target.hardlink_to("r.h5"),
}


@pytest.mark.parametrize("kind", TARGETS)
def test_nothing_is_written_where_it_should_not(results, folder, pound, kind):
    Path("notes").write_text("mine")
    TARGETS[kind](Path("out.nc"))
    before = {path: path.read_bytes() for path in folder.iterdir() if path.is_file()}
    code, out, _ = pound("export", "r.h5", "-o", "out.nc")
    assert (code, out) == (2, "")
    assert {path: path.read_bytes() for path in folder.iterdir() if path.is_file()} == before


def test_what_the_command_wrote_itself_is_replaced(results, pound):
    for words in ("export r.h5 storey -o s.csv", "export r.h5 -o s.nc", "export r.h5 -o folder", "schema -o s.json"):
        for _ in range(2):
            assert pound(*words.split())[0] == 0
    Path("other.nc").write_bytes(results.read_bytes())
    assert pound("export", "r.h5", "-o", "other.nc")[0] == 2


@pytest.mark.parametrize("name", ["x" * 5000, "two.yaml/x"])
def test_what_is_no_place_for_a_file_is_refused(results, pound, name):
    code, out, err = pound("export", "r.h5", "--format", "netcdf", "-o", name)
    assert (code, out) == (2, "")
    assert "Traceback" not in err


def test_python_data_and_a_file_of_one_title_do_not_replace_each_other(folder, pound):
    """Untitled data is called `study`, as a file study.yaml is without a title."""
    study = {"buildings": {"A": {"storeys": 1, "period": "0.3 s"}}, "group": ["A", "A"],
             "cases": {"near": {"link": "pounding", "gap": "1 cm"}}, "records": {"use": ["elcentro"]}}  # fmt: skip
    path = pounding_cli.run(study).path
    Path("study.yaml").write_text(yaml.safe_dump(study))
    code, _, err = pound("run", "study.yaml", "-q", "-o", path)
    assert code == 2
    assert "the output holds another study: 'study'" in err
    assert pound("run", "study.yaml", "-q", "-o", path, "--replace")[0] == 0
    Path("study.yaml").unlink()
    with pytest.raises(pounding_cli.InputError, match="another study"):
        pounding_cli.run(study, path)
