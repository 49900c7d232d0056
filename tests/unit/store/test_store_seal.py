"""The checksums behind a results file: nothing damaged is handed out."""

from __future__ import annotations

import os
from dataclasses import replace

import h5py
import numpy as np
import pytest

from pounding_cli.batch import run_plan
from pounding_cli.batch.progress import Quiet
from pounding_cli.errors import InputError
from pounding_cli.store import open_results, write_results
from pounding_cli.store.seal import BLOCK, Sealed, Unsealed, is_sealed, seal
from tests.helpers.plans import known, small_plan


@pytest.fixture
def large(tmp_path):
    """A sealed file of five blocks, the last one not full, and its content."""
    path = tmp_path / "large"
    content = np.random.default_rng(0).bytes(4 * BLOCK + 100)
    path.write_bytes(content)
    handle = os.open(path, os.O_RDWR)
    seal(handle)
    os.close(handle)
    return path, content


def flip(path, place: int, bit: int = 0) -> None:
    with path.open("r+b") as stream:
        stream.seek(place)
        byte = stream.read(1)[0]
        stream.seek(place)
        stream.write(bytes([byte ^ 1 << bit]))


def test_what_is_read_is_what_was_written(large):
    path, content = large
    with Sealed(path) as sealed:
        assert sealed.size == len(content)
        assert sealed.read() == content
        for begin, count in ((0, 10), (BLOCK - 3, 6), (BLOCK, 2 * BLOCK), (4 * BLOCK + 90, 50)):
            sealed.seek(begin)
            assert sealed.read(count) == content[begin : begin + count]
        sealed.verify()
        assert sealed.damage == ""


@pytest.mark.parametrize("place", [0, BLOCK - 1, BLOCK, 4 * BLOCK + 99])
def test_a_damaged_block_is_never_handed_out(large, place):
    path, content = large
    flip(path, place)
    bad = place // BLOCK
    with Sealed(path) as sealed:
        for block in range(5):
            sealed.seek(block * BLOCK)
            if block == bad:
                with pytest.raises(OSError, match=f"bytes {bad * BLOCK} to"):
                    sealed.read(1)
            else:
                assert sealed.read(1) == content[block * BLOCK : block * BLOCK + 1]
        assert sealed.damage
        with pytest.raises(OSError, match="are not those that were written"):
            sealed.verify()


def test_a_damaged_seal_is_refused(large):
    path, content = large
    whole = path.stat().st_size
    for place in range(len(content), whole):
        flip(path, place)
        with pytest.raises(Unsealed):
            Sealed(path)
        flip(path, place)
    assert is_sealed(path)
    os.truncate(path, whole - 1)
    with pytest.raises(Unsealed, match="cut short"):
        Sealed(path)
    assert not is_sealed(path)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes")
def test_a_pipe_is_refused_at_once(tmp_path):
    os.mkfifo(tmp_path / "pipe.h5")
    with pytest.raises(InputError, match="not a regular file"):
        open_results(tmp_path / "pipe.h5")


class Told(Quiet):
    def __init__(self) -> None:
        self.said: list[str] = []

    def say(self, text: str) -> None:
        self.said.append(text)


def test_a_run_solves_again_what_is_damaged_and_keeps_the_rest(tmp_path):
    """Four thousand scenes; the damage lies in the numbers of some."""
    plan = replace(small_plan(cases=[(f"gap{i}", 0.001 * i) for i in range(1000)]), all_effects=True)
    path = tmp_path / "r.h5"
    write_results(path, plan, {digest: known(scene) for digest, scene in plan.scenes.items()})
    before = open_results(path).storey()
    with h5py.File(path) as file:
        numbers = file["solutions/numbers"].id
        assert numbers.get_num_chunks() > 2
        at = numbers.get_chunk_info(1).byte_offset
    flip(path, at + 5, 3)
    solved = []

    def counting(scene, accuracy, method, **_):
        solved.append(scene.digest)
        return known(scene, accuracy, method)

    told = Told()
    run_plan(plan, path, solve=counting, engine_name="serial", progress=told)
    assert 0 < len(solved) < len(plan.scenes) / 2
    assert "is damaged (bytes" in told.said[0]
    assert open_results(path).storey().equals(before)
    told.said.clear()
    run_plan(plan, path, solve=counting, engine_name="serial", progress=told)
    assert told.said == []
