"""Solved scenes in an SQLite file beside the results: one row a scene, safe against kills, one run at a time."""

from __future__ import annotations

import contextlib
import sqlite3
import zlib
from collections.abc import Iterator, Sequence
from pathlib import Path

from pounding_cli.errors import InputError, Problem
from pounding_cli.results.solved import Row

_TABLES = """
CREATE TABLE IF NOT EXISTS text (id INTEGER PRIMARY KEY, text TEXT UNIQUE NOT NULL);
CREATE TABLE IF NOT EXISTS scene (digest BLOB, key INTEGER, kind INTEGER, numbers BLOB, sum INTEGER,
    PRIMARY KEY (digest, key)) WITHOUT ROWID;
"""

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
        self._db = sqlite3.connect(self.path, timeout=0.2, isolation_level=None)
        self._db.executescript("PRAGMA locking_mode=EXCLUSIVE; PRAGMA journal_mode=WAL; PRAGMA synchronous=NORMAL;")
        self._db.executescript(f"BEGIN IMMEDIATE; {_TABLES} COMMIT;")
        (found,) = self._db.execute("PRAGMA integrity_check(1)").fetchone()
        if found != "ok":
            raise sqlite3.DatabaseError(found)
        self._texts = {text: number for number, text in self._db.execute("SELECT id, text FROM text")}

    def _renew(self) -> None:
        """Make a damaged file anew; its sound rows go on."""
        rows: dict[str, dict[bytes, Row]] = {}
        with contextlib.suppress(sqlite3.DatabaseError, AttributeError):  # a page that is damaged ends it
            texts = dict(self._db.execute("SELECT id, text FROM text"))
            for digest, key, kind, numbers, checksum in self._db.execute("SELECT * FROM scene"):
                row = _sound(digest, texts.get(kind), numbers, checksum)
                if row is not None and key in texts:
                    rows.setdefault(texts[key], {})[digest] = row
        with contextlib.suppress(AttributeError):
            self._db.close()
        for path in self.path.parent.glob(f"{self.path.name}*"):
            path.unlink()
        self.was_damaged = True
        self._open()
        for key, some in rows.items():
            self.put(key, some)

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

    def put(self, key: str, rows: dict[bytes, Row]) -> None:
        """Keep responses by digest, all or none.  Raises InputError."""
        with self._told():
            self._db.execute("BEGIN")
            known = dict(self._texts)
            try:
                place = self._number(key)
                self._db.executemany(
                    "INSERT OR REPLACE INTO scene VALUES (?, ?, ?, ?, ?)",
                    (
                        (d, place, self._number(kind), numbers, _sum(d, kind, numbers))
                        for d, (kind, numbers) in rows.items()
                    ),
                )
                self._db.execute("COMMIT")
            except BaseException:
                self._texts = known
                if self._db.in_transaction:
                    self._db.execute("ROLLBACK")
                raise

    def get(self, key: str, digests: Sequence[bytes]) -> Iterator[tuple[bytes, Row]]:
        """Those of the responses that are there, in any order.  Raises InputError."""
        place, texts = self._texts.get(key, -1), {number: text for text, number in self._texts.items()}
        with self._told():
            for begin in range(0, len(digests), _AT_ONCE):
                some = digests[begin : begin + _AT_ONCE]
                marks = ",".join("?" * len(some))
                question = f"SELECT digest, kind, numbers, sum FROM scene WHERE key = ? AND digest IN ({marks})"
                for digest, kind, numbers, checksum in self._db.execute(question, (place, *some)):
                    if (row := _sound(digest, texts.get(kind), numbers, checksum)) is not None:
                        yield digest, row

    def keep_only(self, key: str, digests: Sequence[bytes]) -> None:
        """Forget all other scenes, and those of other keys.  Raises InputError."""
        kept = dict(self.get(key, digests))
        with self._told():
            self._db.execute("DELETE FROM scene")
        self.put(key, kept)

    def forget_other(self, version: str) -> list[str]:
        """Forget the scenes of keys that do not begin with a version of the solver; returns these keys.

        Raises InputError.
        """
        with self._told():
            used = "SELECT id, text FROM text WHERE id IN (SELECT DISTINCT key FROM scene)"
            other = [(number, text) for number, text in self._db.execute(used) if not text.startswith(version)]
            self._db.executemany("DELETE FROM scene WHERE key = ?", [(number,) for number, _ in other])
        return [text for _, text in other]

    def _number(self, text: str) -> int:
        if text not in self._texts:
            self._texts[text] = int(self._db.execute("INSERT INTO text (text) VALUES (?)", (text,)).lastrowid or 0)
        return self._texts[text]

    def close(self) -> None:
        """Write what is left and let others at it."""
        self._db.close()


def _code(error: sqlite3.Error) -> int:
    """What SQLite calls an error; damage where it does not say."""
    return getattr(error, "sqlite_errorcode", sqlite3.SQLITE_CORRUPT) & 0xFF


def _sum(digest: bytes, kind: str, numbers: bytes) -> int:
    return zlib.crc32(numbers, zlib.crc32(kind.encode(), zlib.crc32(digest)))


def _sound(digest: bytes, kind: str | None, numbers: bytes, checksum: int) -> Row | None:
    """A row as it was written; None where it is damaged."""
    try:
        return (kind, numbers) if kind is not None and _sum(digest, kind, numbers) == checksum else None
    except (TypeError, AttributeError):
        return None
