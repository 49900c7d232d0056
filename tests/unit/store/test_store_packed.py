"""Pieces compressed outside of HDF5, and dimensions tied without its function for it, are what HDF5 itself makes."""

from __future__ import annotations

import math
import zlib

import h5py
import numpy as np
import pytest

from pounding_cli.store import datasets, packed, shared
from pounding_cli.store.datasets import Datasets
from pounding_cli.store.packed import Slabs


def folded(content: bytes) -> int:
    """Fletcher's checksum word by word, as in the HDF5 library (H5checksum.c)."""
    content += b"\0" * (len(content) % 2)
    first = second = 0
    for at in range(0, len(content), 2):
        first += content[at] << 8 | content[at + 1]
        second += first
        if at // 2 % 360 == 359:
            first, second = ((each & 0xFFFF) + (each >> 16) for each in (first, second))
    for _ in range(2):
        first, second = ((each & 0xFFFF) + (each >> 16) for each in (first, second))
    return second << 16 | first


@pytest.mark.parametrize("size", [0, 1, 2, 3, 719, 720, 721, 65535, 65536, 65537, 200001])
def test_the_checksum_is_that_of_hdf5(size):
    noise = np.random.default_rng(size).bytes(size)
    for content in (noise, bytes(size), b"\xff" * size):
        assert packed.fletcher32(content) == folded(content)


@pytest.fixture(params=["isal", "zlib"])
def deflate(request, monkeypatch):
    """Where there is no isal, zlib makes the same stream."""
    if request.param == "isal":
        return pytest.importorskip("isal.isal_zlib")
    monkeypatch.setattr(packed, "deflate", zlib)
    monkeypatch.setattr(packed, "_LEVEL", 1)
    return zlib


@pytest.mark.parametrize("shape", [(1,), (5,), (200_000,), (3, 2, 70_000), (300, 1000), (9, 20_000, 1, 3)])
def test_hdf5_reads_what_was_packed(tmp_path, deflate, shape):
    values = np.random.default_rng(0).random(shape)
    with h5py.File(tmp_path / "packed.h5", "w") as file:
        packed.write(file, "x", values)
        packed.write(file, "digests", np.array([f"{number:064x}" for number in range(3)], "S64"))
    with h5py.File(tmp_path / "packed.h5") as file:
        assert np.array_equal(file["x"][()], values)
        assert (file["x"].compression, file["x"].shuffle, file["x"].fletcher32) == ("gzip", True, True)
        assert np.prod(file["x"].chunks) * 8 <= packed.PIECE_BYTES
        assert file["digests"][2].decode() == f"{2:064x}"


def test_a_block_at_the_end_may_be_smaller_than_a_piece(tmp_path, deflate):
    values = np.arange(3 * 11 * 2).reshape(3, 11, 2)
    with h5py.File(tmp_path / "packed.h5", "w") as file:
        dataset = packed.create(file, "x", values.shape, values.dtype, (1, 4, 2))
        for first in range(3):
            for begin in (0, 4, 8):
                packed.put(dataset, (first, begin, 0), values[first : first + 1, begin : begin + 4])
        assert np.array_equal(dataset[()], values)


def test_a_damaged_piece_is_refused_by_any_reader(tmp_path):
    path = tmp_path / "packed.h5"
    with h5py.File(path, "w") as file:
        piece = packed.write(file, "x", np.random.default_rng(0).random(1000)).id.get_chunk_info(0)
    content = bytearray(path.read_bytes())
    for at in (piece.byte_offset + piece.size // 2, piece.byte_offset + piece.size - 1):  # numbers, checksum
        path.write_bytes(content[:at] + bytes([content[at] ^ 1]) + content[at + 1 :])
        with h5py.File(path) as file, pytest.raises(OSError, match="filter returned failure"):
            file["x"][()]


def test_dimensions_are_those_that_hdf5_would_tie(tmp_path):
    """Also after HDF5 has tied another dataset to the same scales, which reads and rewrites both attributes."""
    texts = np.array(["one", "two"], dtype=object)
    with h5py.File(tmp_path / "tied.h5", "w") as file:
        datasets = Datasets(file)
        datasets.scale("case", texts, "", "name of the case")
        datasets.scale("storey", np.arange(1, 4), "1", "storey")
        datasets.write("V", ("case", "storey"), np.ones((2, 3)), "N", "shear")
        named = datasets.empty("status", ("case",), (2,), texts.dtype, (1,), "", "outcome")
        datasets.put(named, (1,), texts[1:])
        datasets.tie()
        dataset = file.create_dataset("mu", data=np.ones((2, 3)))
        for place, dim in enumerate(("case", "storey")):
            dataset.dims[place].attach_scale(file[dim])
    with h5py.File(tmp_path / "tied.h5") as file:
        for name, dims in (("V", ["case", "storey"]), ("mu", ["case", "storey"]), ("status", ["case"])):
            assert [[scale.name for scale in dim.values()] for dim in file[name].dims] == [[f"/{dim}"] for dim in dims]
        for dim, along in (("case", {("/V", 0), ("/status", 0), ("/mu", 0)}), ("storey", {("/V", 1), ("/mu", 1)})):
            assert h5py.h5ds.is_scale(file[dim].id)
            assert {(file[each].name, int(place)) for each, place in file[dim].attrs["REFERENCE_LIST"]} == along
        assert file["status"].asstr()[1] == "two"
        assert (file["V"].attrs["units"], file["V"].attrs["long_name"]) == ("N", "shear")


@pytest.mark.parametrize("shape", [(50, 3, 2), (3, 40), (1, 30), (29,), (5,)])
@pytest.mark.parametrize("kind", ["texts", "numbers"])
def test_arrays_are_written_some_at_a_time(tmp_path, monkeypatch, shape, kind):
    """At hand or made a slab at a time. Fails if a slab is left out, stands elsewhere or is too large."""
    size = 16 if kind == "texts" else 8
    monkeypatch.setattr(datasets, "_PIECES_ABOVE", size * 24)
    monkeypatch.setattr(packed, "PIECE_BYTES", size * 24)
    values = np.arange(math.prod(shape), dtype=float).reshape(shape)
    if kind == "texts":
        values = np.array([f"text {number:g}" for number in values.flat], object).reshape(shape)
    sizes = []

    def made(at):
        sizes.append(values[at].size)
        return values[at]

    with h5py.File(tmp_path / "r.h5", "w") as file:
        found = Datasets(file)
        found.write("whole", ("row",), values, "", "")
        found.write("slabs", ("row",), Slabs(shape, values.dtype, made), "", "")
    assert max(sizes) <= 24
    with h5py.File(tmp_path / "r.h5") as file:
        for name in ("whole", "slabs"):
            assert ((file[name].asstr() if kind == "texts" else file[name])[()] == values).all()


def test_texts_in_pieces_are_not_held(tmp_path):
    """Fails if HDF5 holds the pieces of texts until the file is closed: 8 MB of each variable."""
    texts = np.array(["text"] * 100, object)
    with h5py.File(tmp_path / "r.h5", "w") as file:
        datasets = Datasets(file)
        dataset = datasets.empty("status", ("row",), (1000,), texts.dtype, texts.shape, "", "")
        _, most, _ = dataset.id.get_access_plist().get_chunk_cache()
        assert most < texts.size
        datasets.put(dataset, (100,), texts)
        assert dataset.asstr()[99:101].tolist() == ["", "text"]


def test_texts_that_values_share_are_written_once(tmp_path):
    """Over pieces and variables, also where all of a piece differ, the last piece is smaller, and more texts come than
    are known again. Fails if a value refers to another text, or if texts are written again."""
    words = ["done", "", "déjà vu\n" * 40, *(f"other {number}" for number in range(300))]
    rows = np.array([words[number % 3 if number < 2050 else number % 303] for number in range(4000)], object)
    apart = np.array([f"{number:064x}" for number in range(4000)], object)
    with h5py.File(tmp_path / "r.h5", "w", libver=("v110", "latest")) as file:
        found = Datasets(file)
        for name, values in (("status", rows), ("again", rows[::-1]), ("scene", apart)):
            dataset = found.empty(name, ("row",), values.shape, values.dtype, (2050,), "", "")
            for begin in range(0, 4000, 2050):
                found.put(dataset, (begin,), values[begin : begin + 2050])
    with h5py.File(tmp_path / "r.h5") as file:
        assert file["status"].asstr()[()].tolist() == rows.tolist()
        assert file["again"].asstr()[()].tolist() == rows[::-1].tolist()
        assert file["scene"].asstr()[()].tolist() == apart.tolist()
        written = file["texts/text"].asstr()[()]
        assert sorted(filter(None, written)) == sorted(filter(None, words))


def test_few_texts_are_known_at_a_time(tmp_path, monkeypatch):
    """Fails if memory grows with the number of texts, or if what was forgotten is taken for another text."""
    monkeypatch.setattr(shared, "_MOST_KNOWN", 10)
    with h5py.File(tmp_path / "r.h5", "w") as file:
        found = Datasets(file)
        dataset = found.empty("flags", ("row",), (4000,), np.dtype(object), (100,), "", "")
        rows = np.array([f"flag {number // 10}" for number in range(4000)], object)
        for begin in range(0, 4000, 100):
            found.put(dataset, (begin,), rows[begin : begin + 100])
            assert len(found._shared._known) <= 20
        assert dataset.asstr()[()].tolist() == rows.tolist()
