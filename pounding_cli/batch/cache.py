"""Solved scenes in an SQLite file beside the results: one row a scene, safe against kills, one run at a time."""

from __future__ import annotations

import contextlib
import sqlite3
import zlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from pounding_cli.errors import InputError, Problem
from pounding_cli.results.solved import Row

_TABLES = """
CREATE TABLE IF NOT EXISTS text (id INTEGER PRIMARY KEY, text TEXT UNIQUE NOT NULL);
CREATE TABLE IF NOT EXISTS scene (digest BLOB, key INTEGER, kind INTEGER, numbers BLOB, sum INTEGER,
    PRIMARY KEY (digest, key)) WITHOUT ROWID;
"""
_TEXT = "(SELECT id FROM text WHERE text = ?)"
_PUT = f"INSERT OR REPLACE INTO scene VALUES (?, {_TEXT}, {_TEXT}, ?, ?)"
_ROWS = "SELECT digest, kinds.text, numbers, sum FROM scene JOIN text AS kinds ON kinds.id = kind"

_DAMAGE = sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_NOTADB, sqlite3.SQLITE_CONSTRAINT, sqlite3.SQLITE_ERROR

_AT_ONCE = 500
"""Scenes that are asked for in one statement."""


def cache_of(output: Path) -> Path:
    """The cache beside a results file."""
    return output.with_name(f"{output.name}.cache")


class Cache:
    """Responses by scene digest and by the key of how they were solved (`keys.solution_key`); a row that is damaged is
    as if it were not there.

    Parameters
    ----------
    path : the file; one that is damaged is made anew from its sound rows

    Raises
    ------
    InputError : another run is at work on it; it cannot be written
    """

    def __init__(self, path: Path) -> None:
        self.path, self.was_damaged = path, False
        with self._told():
            try:
                self._open()
            except sqlite3.DatabaseError as error:
                if _code(error) not in _DAMAGE:
                    raise
                self._renew()

    def _open(self) -> None:
        self._db = sqlite3.connect(self.path, timeout=0.2)
        self._db.executescript("PRAGMA locking_mode=EXCLUSIVE; PRAGMA journal_mode=WAL; PRAGMA synchronous=NORMAL;")
        self._db.executescript(f"BEGIN IMMEDIATE; {_TABLES} COMMIT;")
        (found,) = self._db.execute("PRAGMA integrity_check(1)").fetchone()
        if found != "ok":
            raise sqlite3.DatabaseError(found)

    def _renew(self) -> None:
        """Make a damaged file anew; its sound rows go on."""
        rows: dict[str, dict[bytes, Row]] = {}
        with contextlib.suppress(sqlite3.DatabaseError):  # a page that is damaged ends it
            keys = dict(self._db.execute("SELECT id, text FROM text"))
            for key, *row in self._db.execute(_ROWS.replace("digest", "key, digest", 1)):
                if key in keys and _is_sound(*row):
                    rows.setdefault(keys[key], {})[row[0]] = row[1], row[2]
        self._db.close()
        for path in self.path.parent.glob(f"{self.path.name}*"):
            path.unlink()
        self.was_damaged = True
        self._open()
        for name, some in rows.items():
            self.put(name, some)

    @contextlib.contextmanager
    def _told(self) -> Iterator[None]:
        """Errors of SQLite in words."""
        try:
            yield
        except sqlite3.Error as error:
            if _code(error) in (sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED):
                problem = Problem("another run is at work on these results", "wait for it, or end it", str(self.path))
            else:
                hint = "free some space or choose another place; what was solved is kept, and the same command goes on"
                problem = Problem(f"cannot be written: {error}", hint, str(self.path))
            raise InputError(problem) from None

    def put(self, key: str, rows: Mapping[bytes, Row]) -> None:
        """Keep responses by digest, all or none.  Raises InputError."""
        texts = {key, *(kind for kind, _ in rows.values())}
        with self._told(), self._db:
            self._db.executemany("INSERT OR IGNORE INTO text (text) VALUES (?)", [(text,) for text in texts])
            self._db.executemany(
                _PUT, ((d, key, kind, numbers, _sum(d, kind, numbers)) for d, (kind, numbers) in rows.items())
            )

    def get(self, key: str, digests: Sequence[bytes]) -> Iterator[tuple[bytes, Row]]:
        """Those of the responses that are there, in any order.  Raises InputError."""
        with self._told():
            for begin in range(0, len(digests), _AT_ONCE):
                some = digests[begin : begin + _AT_ONCE]
                question = f"{_ROWS} WHERE key = {_TEXT} AND digest IN ({','.join('?' * len(some))})"
                for row in self._db.execute(question, (key, *some)):
                    if _is_sound(*row):
                        yield row[0], row[1:3]

    def keep_only(self, key: str, digests: Sequence[bytes]) -> None:
        """Forget all other scenes, and those of other keys.  Raises InputError."""
        kept = dict(self.get(key, digests))
        with self._told(), self._db:
            self._db.execute("DELETE FROM scene")
        self.put(key, kept)

    def forget_other(self, version: str) -> bool:
        """Forget the scenes of keys that do not begin with a version of the solver; whether there were any.

        Raises InputError.
        """
        with self._told(), self._db:
            other = "SELECT id FROM text WHERE substr(text, 1, ?) != ?"
            return self._db.execute(f"DELETE FROM scene WHERE key IN ({other})", (len(version), version)).rowcount > 0

    def close(self) -> None:
        """Write what is left and let others at it."""
        self._db.close()


def _code(error: sqlite3.Error) -> int:
    """What SQLite calls an error; damage where it does not say."""
    return getattr(error, "sqlite_errorcode", sqlite3.SQLITE_CORRUPT) & 0xFF


def _sum(digest: bytes, kind: str, numbers: bytes) -> int:
    return zlib.crc32(numbers, zlib.crc32(kind.encode(), zlib.crc32(digest)))


def _is_sound(digest: bytes, kind: str, numbers: bytes, checksum: int) -> bool:
    """Whether a row is as it was written."""
    try:
        return _sum(digest, kind, numbers) == checksum
    except (TypeError, AttributeError):
        return False
