"""The results file and the cache beside it: what is damaged, of another version, or made to mislead is refused."""

from __future__ import annotations

import hashlib
import random
import sqlite3
import subprocess
import sys

import h5py
import pytest
import xarray

import pounding_cli as pound

STUDY = {
    "title": "A pair",
    "records": {"use": ["elcentro"], "duration": "2 s"},
    "buildings": {"a": {"storeys": 2, "period": "0.3 s"}, "b": {"storeys": 1, "period": "0.5 s"}},
    "group": ["a", "b"],
    "cases": {"near": {"link": "pounding", "gap": "2 mm"}},
    "estimate": "none",
}
SEAL = b"pound seal 2\n\0\0\0"


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """The results of STUDY."""
    return pound.run(STUDY, tmp_path_factory.mktemp("file") / "r.h5")


@pytest.fixture
def changed(results, tmp_path):
    """Gives a copy of the results whose HDF5 content `change(file)` altered, sealed anew: someone meant it."""

    def made(change) -> object:
        path = tmp_path / "changed.h5"
        path.write_bytes(results.path.read_bytes()[: -len(SEAL) - 32])
        with h5py.File(path, "a") as file:
            change(file)
        content = path.read_bytes()
        path.write_bytes(content + SEAL + hashlib.sha256(content).digest())
        return path

    return made


def refusal(path) -> str:
    with pytest.raises(pound.InputError) as caught:
        pound.open_results(path).storey()
    (problem,) = caught.value.issues
    assert problem.hint
    return str(problem)


def test_other_programs_open_it(results):
    with xarray.open_dataset(results.path, engine="h5netcdf") as data, h5py.File(results.path) as file:
        assert data["V"].attrs["units"] == "N"
        assert data["V"].dims == ("case", "analysis", "record", "building", "storey")
        assert float(data["V"].max()) == file["V"][()][~(file["V"][()] != file["V"][()])].max()
        assert data["status"].values.tolist() == [[["done"]]] * 1 or set(data["status"].values.ravel()) == {"done"}
        assert data["link_floor"].dims == ("link",)


@pytest.mark.parametrize("seed", range(30))
def test_a_changed_bit_is_refused(results, tmp_path, seed):
    draw, content = random.Random(seed), bytearray(results.path.read_bytes())
    content[draw.randrange(len(content))] ^= 1 << draw.randrange(8)
    path = tmp_path / "flipped.h5"
    path.write_bytes(content)
    assert "damaged" in refusal(path) or "HDF5" in refusal(path)


def test_a_file_that_is_cut_is_refused(results, tmp_path):
    path = tmp_path / "cut.h5"
    path.write_bytes(results.path.read_bytes()[:-1000])
    refusal(path)


@pytest.mark.parametrize(
    ("change", "word"),
    [
        (lambda file: file.__setitem__("V2", h5py.ExternalLink("/etc/passwd", "/")), "elsewhere"),
        (lambda file: file.__setitem__("V2", h5py.SoftLink("/V")), "elsewhere"),
        (lambda file: file.create_dataset("bomb", (1 << 40,), "f8", chunks=(1 << 20,)), "more values"),
        (lambda file: file.create_dataset("far", (4,), "f8", external=[("/etc/passwd", 0, 32)]), "elsewhere"),
        (lambda file: file.attrs.modify("format_version", 3), "older format version 3"),
        (lambda file: file.attrs.modify("format_version", 99), "newer format version 99"),
        (lambda file: file.attrs.modify("format", "theirs"), "not a results file"),
        (lambda file: file.__delitem__("drift"), "does not hold"),
    ],
)
def test_what_is_made_to_mislead_is_refused(changed, change, word):
    assert word in refusal(changed(change))


def test_an_older_file_names_the_command_that_makes_it_anew(changed):
    assert "pound run STUDY -o changed.h5" in refusal(changed(lambda file: file.attrs.modify("format_version", 3)))


def test_a_second_run_on_the_same_results_is_refused(tmp_path):
    output = tmp_path / "r.h5"
    other = sqlite3.connect(output.with_name("r.h5.cache"), isolation_level=None)
    other.execute("BEGIN EXCLUSIVE")
    with pytest.raises(pound.InputError, match="another run is using"):
        pound.run(STUDY, output)
    other.close()
    assert pound.run(STUDY, output).attrs["scenes"] == 6


def test_a_damaged_cache_is_made_anew(results, tmp_path):
    output = tmp_path / "r.h5"
    cache = bytearray(results.path.with_name("r.h5.cache").read_bytes())
    cache[:100] = bytes(100)  # the header: nothing in it can be found any more
    output.with_name("r.h5.cache").write_bytes(cache)
    again = pound.run(STUDY, output)
    assert again.attrs["scenes_solved_last"] == 6
    assert again.storey().equals(results.storey())


@pytest.mark.skipif(sys.platform == "win32", reason="no ulimit there")
def test_a_full_disk_is_one_sentence_and_nothing_is_lost(tmp_path):
    """The limit on a file's size stands for the disk: the same command goes on once there is room."""
    study, output = tmp_path / "pair.yaml", tmp_path / "r.h5"
    study.write_text(
        "title: A pair\nrecords: {use: [elcentro], duration: 2 s}\ngroup: [a, b]\nestimate: none\n"
        "buildings: {a: {storeys: 2, period: 0.3 s}, b: {storeys: 1, period: 0.5 s}}\n"
        "cases: {near: {link: pounding, gap: 2 mm}}\nsweep: {cases.near.gap: {from: 1 mm, to: 9 mm, count: 200}}\n"
    )
    command = f"'{sys.executable}' -B -c 'from pounding_cli.cli.main import main; main()' run {study} -o {output} -q"
    full = subprocess.run(["bash", "-c", f"ulimit -f 120; {command}"], capture_output=True, text=True)
    assert full.returncode == 2
    assert "cannot be written" in full.stderr
    assert "Traceback" not in full.stderr
    assert not output.exists()
    assert subprocess.run(["bash", "-c", command]).returncode == 0
    found = pound.open_results(output)
    assert found.attrs["scenes_failed"] == 0
    assert found.attrs["scenes_reused_last"] > 0
