"""Two commands that start at once: neither takes the other's work for a fault."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor

from pounding_cli.outputs import check_folder
from pounding_cli.store import locked
from pounding_cli.store.locks import lock_of


def test_many_starts_in_one_folder_look_at_it_at_once(tmp_path):
    """Fails with a probe of one name, which one of them deletes under the others."""
    with ThreadPoolExecutor(16) as pool:
        list(pool.map(lambda _: check_folder(tmp_path / "results", tmp_path / "results" / "r.h5"), range(2000)))
    assert list((tmp_path / "results").iterdir()) == []


def test_a_lock_that_its_holder_deletes_between_two_looks_is_taken_anew(tmp_path, monkeypatch):
    path, real = tmp_path / "r.h5", os.fstat
    gone = []

    def fstat(handle):
        if not gone:
            gone.append(lock_of(path).unlink())
        return real(handle)

    monkeypatch.setattr(os, "fstat", fstat)
    with locked(path):
        assert gone
        assert lock_of(path).exists()
    assert not lock_of(path).exists()
