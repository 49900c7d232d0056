"""Solved scenes in an SQLite file beside the results: one row a scene, safe against kills, one run at a time."""

from __future__ import annotations

import contextlib
import sqlite3
import zlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from pounding_cli.errors import InputError, Problem
from pounding_cli.results.solved import Row

_TABLE = """
CREATE TABLE IF NOT EXISTS scene (digest BLOB, key TEXT, kind BLOB, numbers BLOB, sum INTEGER,
    PRIMARY KEY (digest, key));
CREATE TABLE IF NOT EXISTS summary (key TEXT PRIMARY KEY, text TEXT);
"""
_BUSY = sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED
_DAMAGE = sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_NOTADB, sqlite3.SQLITE_CONSTRAINT, sqlite3.SQLITE_ERROR

_AT_ONCE = 500
"""Scenes that are asked for in one statement."""


def cache_of(output: Path) -> Path:
    """The cache beside a results file."""
    return output.with_name(f"{output.name}.cache")


class Cache:
    """Responses by scene digest and by the key of how they were solved (`solution_key`); a row that is damaged is as if
    it were not there.

    Parameters
    ----------
    path : the file; one that is damaged is made anew, and `was_damaged`
    read_only : nothing is written; a file that is missing or damaged holds nothing then

    Raises
    ------
    InputError : another run is at work on it; it cannot be written
    """

    def __init__(self, path: Path, read_only: bool = False) -> None:
        self.path = path
        self.was_damaged = False
        if read_only:
            self._open_to_read()
            return
        with self._told():
            try:
                self._open()
            except sqlite3.DatabaseError as error:
                if _code(error) not in _DAMAGE:
                    raise
                self._db.close()
                for part in path.parent.glob(f"{path.name}*"):
                    part.unlink()
                self.was_damaged = True
                self._open()

    def _open(self) -> None:
        self._db = sqlite3.connect(self.path, timeout=0.2)
        self._db.executescript("PRAGMA locking_mode=EXCLUSIVE; PRAGMA journal_mode=WAL; PRAGMA synchronous=NORMAL;")
        self._db.executescript(f"BEGIN IMMEDIATE; {_TABLE} COMMIT;")
        (found,) = self._db.execute("PRAGMA integrity_check(1)").fetchone()
        if found != "ok":
            raise sqlite3.DatabaseError(found)

    def _open_to_read(self) -> None:
        """Open the file without writing to it, or a database in memory where it is missing or damaged."""
        if self.path.is_file():
            is_closed = not self.path.with_name(f"{self.path.name}-wal").exists()
            how = "mode=ro&immutable=1" if is_closed else "mode=ro"  # the other files of one in use are needed
            with self._told():
                self._db = sqlite3.connect(f"{self.path.absolute().as_uri()}?{how}", uri=True, timeout=0.2)
                try:
                    self._db.execute("SELECT digest, key, kind, numbers, sum FROM scene LIMIT 1").fetchone()
                    return
                except sqlite3.DatabaseError as error:
                    self._db.close()
                    if _code(error) in _BUSY:
                        raise
                    self.was_damaged = True
        self._db = sqlite3.connect(":memory:")
        self._db.executescript(_TABLE)

    @contextlib.contextmanager
    def _told(self) -> Iterator[None]:
        """Errors of SQLite in words."""
        try:
            yield
        except sqlite3.Error as error:
            if _code(error) in _BUSY:
                problem = Problem("another run is at work on these results", "wait for it, or end it", str(self.path))
            else:
                hint = "free some space or choose another place; what was solved is kept, and the same command goes on"
                problem = Problem(f"cannot be written: {error}", hint, str(self.path))
            raise InputError(problem) from None

    def put(self, key: str, rows: Mapping[bytes, Row]) -> None:
        """Keep responses by digest, all or none.  Raises InputError."""
        texts = ((digest, zlib.compress(kind.encode(), 1), numbers) for digest, (kind, numbers) in rows.items())
        with self._told(), self._db:
            self._db.executemany(
                "INSERT OR REPLACE INTO scene VALUES (?, ?, ?, ?, ?)",
                ((digest, key, kind, numbers, _sum(digest, kind, numbers)) for digest, kind, numbers in texts),
            )

    def get(self, key: str, digests: Sequence[bytes]) -> Iterator[dict[bytes, Row]]:
        """Those of the responses that are there by digest, some at a time.  Raises InputError."""
        for begin in range(0, len(digests), _AT_ONCE):
            some = digests[begin : begin + _AT_ONCE]
            places = ",".join("?" * len(some))
            question = f"SELECT digest, kind, numbers, sum FROM scene WHERE key = ? AND digest IN ({places})"
            with self._told():
                found = self._db.execute(question, (key, *some)).fetchall()
            yield {row[0]: (zlib.decompress(row[1]).decode(), row[2]) for *row, total in found if _sum(*row) == total}

    def count_by_key(self, digests: Sequence[bytes]) -> dict[str, int]:
        """Return how many of some scenes are kept, by the key of how they were solved.  Raises InputError."""
        counts = dict[str, int]()
        for begin in range(0, len(digests), _AT_ONCE):
            some = digests[begin : begin + _AT_ONCE]
            places = ",".join("?" * len(some))
            question = f"SELECT key, COUNT(*) FROM scene WHERE digest IN ({places}) GROUP BY key"
            with self._told():
                found = self._db.execute(question, some).fetchall()
            for key, count in found:
                counts[key] = counts.get(key, 0) + count
        return counts

    def keep_only(self, key: str, digests: Sequence[bytes]) -> None:
        """Forget all other scenes, and those of other keys.  Raises InputError."""
        with self._told(), self._db:
            self._db.execute("DELETE FROM scene WHERE key != ?", (key,))
            there = {digest for (digest,) in self._db.execute("SELECT digest FROM scene")}
            others = ((digest,) for digest in there.difference(digests))
            self._db.executemany("DELETE FROM scene WHERE digest = ?", others)

    def forget_other(self, version: str) -> bool:
        """Forget the scenes of keys that do not begin with a version of the solver; whether there were any.

        Raises InputError.
        """
        with self._told(), self._db:
            other = "DELETE FROM scene WHERE substr(key, 1, ?) != ?"
            return self._db.execute(other, (len(version), version)).rowcount > 0

    def find_summary(self, key: str) -> str | None:
        """Return the summary of results that was kept under a key; None where there is none."""
        try:
            found = self._db.execute("SELECT text FROM summary WHERE key = ?", (key,)).fetchone()
        except sqlite3.DatabaseError:  # of an older program, or damaged
            return None
        return None if found is None else str(found[0])

    def keep_summary(self, key: str, text: str) -> None:
        """Keep a summary of results in place of the one before.  Raises InputError."""
        with self._told(), self._db:
            self._db.execute("DELETE FROM summary")
            self._db.execute("INSERT INTO summary VALUES (?, ?)", (key, text))

    def close(self) -> None:
        """Write what is left and let others at it."""
        self._db.close()


def _code(error: sqlite3.Error) -> int:
    """What SQLite calls an error; damage where it does not say."""
    return getattr(error, "sqlite_errorcode", sqlite3.SQLITE_CORRUPT) & 0xFF


def _sum(*parts: Any) -> int:
    """CRC-32 of the parts of a row, which damage may have turned into anything."""
    return zlib.crc32(b"".join(part for part in parts if isinstance(part, bytes)))
