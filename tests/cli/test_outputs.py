"""One check of outputs for every command that writes: nothing of the user's is lost."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from click.testing import CliRunner

from pounding_cli.cli.main import cli
from pounding_cli.errors import InputError
from pounding_cli.outputs import check_folder, check_output

ROOT = Path(__file__).parents[2]
QUICK = """\
title: Quick
records: {use: [elcentro], duration: 1 s}
buildings: {stiff: {storeys: 1, period: 0.2 s}, soft: {like: stiff, period: 0.5 s}}
group: [stiff, soft]
cases: {touching: {link: pounding, gap: 0 cm}}
keep: histories
"""


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    folder = tmp_path_factory.mktemp("outputs")
    (folder / "quick.yaml").write_text(QUICK)
    call("run", folder / "quick.yaml", "-o", folder / "quick.h5", "--workers", "1")
    return folder / "quick.h5"


def call(*arguments: object) -> str:
    return CliRunner().invoke(cli, [str(each) for each in arguments], catch_exceptions=False).output


WRITERS = {
    "run": ("{study}", "-o", "{out}"),
    "connector": (ROOT / "configs" / "fig5.yaml", "-o", "{out}"),
    "wall": (ROOT / "configs" / "fig8.yaml", "-o", "{out}"),
    "export csv": ("{results}", "storey", "--format", "csv", "-o", "{out}.csv"),
    "export parquet": ("{results}", "storey", "-o", "{out}.parquet"),
    "export excel": ("{results}", "-o", "{out}.xlsx"),
    "export netcdf": ("{results}", "-o", "{out}.nc"),
    "schema": ("-o", "{out}"),
    "records show": ("taft", "-o", "{out}.png"),
}


@pytest.mark.parametrize("command", WRITERS)
def test_a_file_of_another_kind_is_not_replaced(command, results, tmp_path):
    places = {"study": results.with_suffix(".yaml"), "results": results, "out": tmp_path / "notes"}
    arguments = [str(each).format(**places) for each in WRITERS[command]]
    target = Path(arguments[arguments.index("-o") + 1])
    target.write_text("my notes, not to be lost")
    with pytest.raises(InputError, match="the output exists and was not written by this command") as refused:
        call(*command.split()[: 2 if command.startswith("records") else 1], *arguments)
    assert refused.value.problems[0].hint
    assert target.read_text() == "my notes, not to be lost"
    assert [path.name for path in tmp_path.iterdir()] == [target.name]


TARGETS = {
    "a folder": (lambda target, own, foreign: target.mkdir(), "is a folder"),
    "a device": (lambda target, own, foreign: target.symlink_to("/dev/null"), "not a regular file"),
    "a pipe": (lambda target, own, foreign: os.mkfifo(target), "not a regular file"),
    "a foreign file": (lambda target, own, foreign: target.write_bytes(b"notes"), "was not written by this command"),
    "a link to one": (lambda target, own, foreign: target.symlink_to(foreign), "was not written by this command"),
    "a hard link to one": (lambda target, own, foreign: target.hardlink_to(foreign), "not written by this command"),
    "a link to the input": (lambda target, own, foreign: target.symlink_to(own), "that this command reads"),
    "a hard link to the input": (lambda target, own, foreign: target.hardlink_to(own), "that this command reads"),
}


@pytest.mark.parametrize("kind", TARGETS)
def test_nothing_is_written_where_it_should_not(kind, tmp_path):
    make, words = TARGETS[kind]
    own, foreign, target = tmp_path / "own.png", tmp_path / "foreign.png", tmp_path / "out.png"
    own.write_bytes(b"\x89PNG\r\n\x1a\n")
    foreign.write_bytes(b"notes")
    make(target, own, foreign)
    before = {path: path.read_bytes() for path in tmp_path.iterdir() if path.is_file()}
    with pytest.raises(InputError, match=words) as refused:
        check_output(target, [own])
    assert refused.value.problems[0].hint
    assert {path: path.read_bytes() for path in tmp_path.iterdir() if path.is_file()} == before


def test_an_export_does_not_replace_what_it_reads(results):
    before = results.read_bytes()
    with pytest.raises(InputError, match="the file that this command reads"):
        call("export", results, "--format", "netcdf", "-o", results)
    assert results.read_bytes() == before


def test_an_older_export_is_replaced(results, tmp_path):
    for name in ("s.csv", "s.nc", "folder"):
        tables = ("storey",) if name == "s.csv" else ()
        for _ in range(2):
            assert "wrote" in call("export", results, *tables, "-o", tmp_path / name)


def test_an_export_does_not_replace_results(results, tmp_path):
    other = tmp_path / "other.nc"
    other.write_bytes(results.read_bytes())
    with pytest.raises(InputError, match="was not written by this command"):
        call("export", results, "-o", other)


def test_stand_ins_and_schemas_replace_only_their_like(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    call("records", "synthesize", "taft")
    call("records", "synthesize", "taft")
    Path("taft.txt").write_text("mine")
    with pytest.raises(InputError, match="was not written by this command"):
        call("records", "synthesize", "taft")
    Path("pound.schema.json").write_text("{}")
    with pytest.raises(InputError, match="was not written by this command"):
        call("init", "new")
    assert not Path("new.yaml").exists()


def test_folders_that_are_files_are_refused(results, tmp_path):
    (tmp_path / "file").write_text("mine")
    for arguments in (("report", results), ("accuracy", results.with_suffix(".yaml"), "--budget", "1 s")):
        with pytest.raises(InputError, match="cannot be written"):
            call(*arguments, "-o", tmp_path / "file")
    with pytest.raises(InputError, match="cannot be written"):
        check_folder(tmp_path / "file" / "x")


def test_what_is_no_place_for_a_file_is_refused(tmp_path):
    for path, words in (
        (tmp_path, "is a folder"),
        (Path("/dev/null"), "not a regular file"),
        (tmp_path / ("x" * 5000), "cannot be written"),
        (tmp_path / "a\0b", "cannot be written"),
    ):
        with pytest.raises(InputError, match=words):
            check_output(path)
