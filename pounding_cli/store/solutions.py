"""The group `/solutions` of a results file: every scene's response under its digest, kept for reuse."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import h5py
import numpy as np

from pounding_cli.errors import InputError
from pounding_cli.solve.response import Response
from pounding_cli.store.codec import decode, encode
from pounding_cli.store.files import opened


def write_solutions(file: h5py.File, responses: Mapping[str, Response]) -> None:
    """Write `digest`, `head` (JSON), `count` (numbers a scene) and `numbers` (one scene after another)."""
    coded = [encode(response) for response in responses.values()]
    group = file.create_group("solutions")
    group.attrs["long_name"] = "responses by scene digest, linked scenes and buildings alone; kept for reuse"
    group["digest"] = np.array(list(responses), dtype="S64")
    group.create_dataset("head", data=[head for head, _ in coded], dtype=h5py.string_dtype())
    group["count"] = np.array([numbers.size for _, numbers in coded], np.int64)
    group.create_dataset(
        "numbers", data=np.concatenate([numbers for _, numbers in coded]), compression="gzip", shuffle=True
    )


def stored_solutions(path: Path, key: str, wanted: Mapping[str, object]) -> dict[str, Response]:
    """The wanted responses that are done, by digest, if `path` is a results file with this `solution_key`."""
    try:
        with opened(path) as file:
            if file.attrs["solution_key"] != key:
                return {}
            group = file["solutions"]
            digests = [digest.decode() for digest in group["digest"][:]]
            heads, counts, numbers = group["head"].asstr()[:], group["count"][:], group["numbers"][:]
            pieces = np.split(numbers, np.cumsum(counts)[:-1])
            found = {
                digest: decode(head, piece)
                for digest, head, piece in zip(digests, heads, pieces, strict=True)
                if digest in wanted
            }
    except (InputError, OSError, KeyError, ValueError, TypeError):
        return {}
    return {digest: response for digest, response in found.items() if response.status == "done"}
