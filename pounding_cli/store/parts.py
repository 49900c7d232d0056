"""The parts of an unfinished run in `FILE.h5.parts/`: files of solved scenes, each whole or not there."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import shutil
import time
import uuid
from pathlib import Path

import numpy as np

from pounding_cli.solve.response import Response
from pounding_cli.store.codec import decode, encode

_MAGIC = b"pound part 1\n"
_SECONDS = 1.0
_SCENES = 2000


class PartStore:
    """Keeps solved scenes on disk so that a stopped run goes on where it was.

    A part is a magic line, a line with the SHA-256 of the rest, a line of JSON, and the numbers as
    little-endian doubles.
    Scenes are gathered for a second before they are written: a study that takes less never touches the disk.

    Parameters
    ----------
    output : the results file the parts belong to
    key : `solution_key`; parts with another key are not read
    """

    def __init__(self, output: Path, key: str) -> None:
        self.folder = output.with_name(output.name + ".parts")
        self.key = key
        self._waiting: dict[str, Response] = {}
        self._last = time.monotonic()

    def load(self) -> dict[str, Response]:
        """Solved scenes by digest; a part that is damaged or of another key is passed over."""
        found: dict[str, Response] = {}
        for path in sorted(self.folder.glob("*.part")):
            with contextlib.suppress(OSError, ValueError, KeyError, TypeError):
                found.update(_read(path.read_bytes(), self.key))
        return found

    def add(self, digest: str, response: Response) -> None:
        """Keep a solved scene; it is on disk after a second, or after `flush`."""
        self._waiting[digest] = response
        if len(self._waiting) >= _SCENES or time.monotonic() - self._last > _SECONDS:
            self.flush()

    def flush(self) -> None:
        """Write what waits."""
        self._last = time.monotonic()
        if not self._waiting:
            return
        self.folder.mkdir(parents=True, exist_ok=True)
        name = uuid.uuid4().hex
        hidden = self.folder / f".{name}.tmp"
        with hidden.open("wb") as stream:
            stream.write(_bytes(self._waiting, self.key))
            stream.flush()
            os.fsync(stream.fileno())
        hidden.replace(self.folder / f"{name}.part")
        self._waiting = {}

    def remove(self) -> None:
        """Delete the parts: the results file has everything."""
        self._waiting = {}
        shutil.rmtree(self.folder, ignore_errors=True)


def _bytes(responses: dict[str, Response], key: str) -> bytes:
    coded = {digest: encode(response) for digest, response in responses.items()}
    facts = {
        "key": key,
        "digests": list(coded),
        "heads": [head for head, _ in coded.values()],
        "counts": [int(numbers.size) for _, numbers in coded.values()],
    }
    numbers = np.concatenate([numbers for _, numbers in coded.values()]).astype("<f8")
    body = json.dumps(facts).encode() + b"\n" + numbers.tobytes()
    return _MAGIC + hashlib.sha256(body).hexdigest().encode() + b"\n" + body


def _read(content: bytes, key: str) -> dict[str, Response]:
    magic, sha, body = (
        content[: len(_MAGIC)],
        content[len(_MAGIC) : len(_MAGIC) + 64],
        content[len(_MAGIC) + 65 :],
    )
    if magic != _MAGIC or hashlib.sha256(body).hexdigest().encode() != sha:
        raise ValueError("damaged part")
    line, _, rest = body.partition(b"\n")
    facts = json.loads(line)
    if facts["key"] != key:
        return {}
    numbers = np.frombuffer(rest, "<f8").astype(float)
    pieces = np.split(numbers, np.cumsum(facts["counts"])[:-1])
    return {
        digest: decode(head, piece)
        for digest, head, piece in zip(facts["digests"], facts["heads"], pieces, strict=True)
    }
