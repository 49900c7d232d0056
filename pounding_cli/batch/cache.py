"""Keep solved scenes in an SQLite file beside the results: one row a scene, safe against kills, one run at a time."""

from __future__ import annotations

import contextlib
import sqlite3
import zlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from pounding_cli.errors import InputError, Issue
from pounding_cli.results.responses import Row

_TABLE = """
CREATE TABLE IF NOT EXISTS scene (digest BLOB, key TEXT, kind BLOB, numbers BLOB, sum INTEGER,
    PRIMARY KEY (digest, key));
CREATE TABLE IF NOT EXISTS summary (key TEXT PRIMARY KEY, text TEXT);
"""
_BUSY_CODES = (sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED)
_DAMAGE_CODES = (sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_NOTADB, sqlite3.SQLITE_CONSTRAINT, sqlite3.SQLITE_ERROR)

_MAX_DIGESTS = 500
"""Largest number of scenes in one statement."""


def cache_path(output: Path) -> Path:
    """Return the path of the cache beside a results file."""
    return output.with_name(f"{output.name}.cache")


class Cache:
    """Responses by scene digest and by the key of how they were solved (`solution_key`).

    A damaged row counts as missing.

    Parameters
    ----------
    path : the file; a damaged one is made anew, and `was_damaged` is true
    read_only : write nothing; a file that is missing or damaged holds nothing then
    shared : cache of another run from which responses are taken that this one lacks; nothing is written to it

    Raises
    ------
    InputError : another run uses it; it cannot be written
    """

    def __init__(self, path: Path, read_only: bool = False, shared: Path | None = None) -> None:
        self.path = path
        self.read_only = read_only
        self.was_damaged = False
        self._shared: Cache | None = None
        if shared is not None and shared != path:
            with contextlib.suppress(InputError):  # another run uses it; these scenes are solved again then
                self._shared = Cache(shared, read_only=True)
        if read_only:
            self._open_to_read()
            return
        with self._explain_errors():
            try:
                self._open()
            except sqlite3.DatabaseError as error:
                if _error_code(error) not in _DAMAGE_CODES:
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
        (verdict,) = self._db.execute("PRAGMA integrity_check(1)").fetchone()
        if verdict != "ok":
            raise sqlite3.DatabaseError(verdict)

    def _open_to_read(self) -> None:
        """Open the file without writing to it, or a database in memory where it is missing or damaged."""
        if self.path.is_file():
            is_closed = not self.path.with_name(f"{self.path.name}-wal").exists()
            mode = "mode=ro&immutable=1" if is_closed else "mode=ro"  # the other files of one in use are needed
            with self._explain_errors():
                self._db = sqlite3.connect(f"{self.path.absolute().as_uri()}?{mode}", uri=True, timeout=0.2)
                try:
                    self._db.execute("SELECT digest, key, kind, numbers, sum FROM scene LIMIT 1").fetchone()
                    return
                except sqlite3.DatabaseError as error:
                    self._db.close()
                    if _error_code(error) in _BUSY_CODES:
                        raise
                    self.was_damaged = True
        self._db = sqlite3.connect(":memory:")
        self._db.executescript(_TABLE)

    @contextlib.contextmanager
    def _explain_errors(self) -> Iterator[None]:
        """Turn errors of SQLite into InputError, with what to do about them."""
        try:
            yield
        except sqlite3.Error as error:
            if _error_code(error) in _BUSY_CODES:
                problem = Issue(
                    (), "another run is using these results", "wait until it ends, or stop it", file=str(self.path)
                )
            else:
                hint = "free some space or choose another place; solved scenes are kept, and the same command resumes"
                problem = Issue((), f"cannot be written: {error}", hint, file=str(self.path))
            raise InputError(problem) from None

    def store(self, key: str, rows: Mapping[bytes, Row]) -> None:
        """Keep responses by digest, all or none.

        Raises
        ------
        InputError : they cannot be written
        """
        records = []
        for digest, (kind, numbers) in rows.items():
            packed_kind = zlib.compress(kind.encode(), 1)
            records.append((digest, key, packed_kind, numbers, _checksum(digest, packed_kind, numbers)))
        with self._explain_errors(), self._db:
            self._db.executemany("INSERT OR REPLACE INTO scene VALUES (?, ?, ?, ?, ?)", records)

    def iter_rows(self, key: str, digests: Sequence[bytes]) -> Iterator[dict[bytes, Row]]:
        """Yield the responses that are there by digest, some at a time.

        Raises
        ------
        InputError : another run uses the file
        """
        for part in _iter_parts(digests):
            rows = self._read_rows(key, part)
            if self._shared is not None:
                missing = [digest for digest in part if digest not in rows]
                taken = self._shared._read_rows(key, missing)
                if taken and not self.read_only:
                    self.store(key, taken)
                rows |= taken
            yield rows

    def _read_rows(self, key: str, digests: Sequence[bytes]) -> dict[bytes, Row]:
        """Return the responses of some scenes that stand in the file itself."""
        query = f"SELECT digest, kind, numbers, sum FROM scene WHERE key = ? AND digest IN ({_placeholders(digests)})"
        with self._explain_errors():
            records = self._db.execute(query, (key, *digests)).fetchall()
        rows = dict[bytes, Row]()
        for digest, packed_kind, numbers, checksum in records:
            if _checksum(digest, packed_kind, numbers) == checksum:
                rows[digest] = (zlib.decompress(packed_kind).decode(), numbers)
        return rows

    def find_keys(self, digests: Sequence[bytes]) -> dict[bytes, set[str]]:
        """Return of some scenes that are kept the keys of how they were solved.

        Raises
        ------
        InputError : another run uses the file
        """
        found: dict[bytes, set[str]] = {} if self._shared is None else self._shared.find_keys(digests)
        for part in _iter_parts(digests):
            query = f"SELECT digest, key FROM scene WHERE digest IN ({_placeholders(part)})"
            with self._explain_errors():
                records = self._db.execute(query, part).fetchall()
            for digest, key in records:
                found.setdefault(digest, set()).add(key)
        return found

    def delete_others(self, key: str, digests: Sequence[bytes]) -> None:
        """Delete all other scenes, and those of other keys.

        Raises
        ------
        InputError : the file cannot be written
        """
        with self._explain_errors(), self._db:
            self._db.execute("DELETE FROM scene WHERE key != ?", (key,))
            stored = {digest for (digest,) in self._db.execute("SELECT digest FROM scene")}
            others = [(digest,) for digest in stored.difference(digests)]
            self._db.executemany("DELETE FROM scene WHERE digest = ?", others)

    def delete_other_versions(self, version: str) -> bool:
        """Delete the scenes of keys that do not begin with a version of the solver; return whether there were any.

        Raises
        ------
        InputError : the file cannot be written
        """
        with self._explain_errors(), self._db:
            statement = "DELETE FROM scene WHERE substr(key, 1, ?) != ?"
            return self._db.execute(statement, (len(version), version)).rowcount > 0

    def find_summary(self, key: str) -> str | None:
        """Return the summary of results that was kept under a key; None where there is none."""
        try:
            record = self._db.execute("SELECT text FROM summary WHERE key = ?", (key,)).fetchone()
        except sqlite3.DatabaseError:  # of an older program, or damaged
            return None
        return None if record is None else str(record[0])

    def store_summary(self, key: str, text: str) -> None:
        """Keep a summary of results in place of the one before.

        Raises
        ------
        InputError : it cannot be written
        """
        with self._explain_errors(), self._db:
            self._db.execute("DELETE FROM summary")
            self._db.execute("INSERT INTO summary VALUES (?, ?)", (key, text))

    def close(self) -> None:
        """Write the rest and let other runs use the file."""
        if self._shared is not None:
            self._shared.close()
        self._db.close()


def _iter_parts(digests: Sequence[bytes]) -> Iterator[Sequence[bytes]]:
    """Yield the digests in parts that fit into one statement."""
    for begin in range(0, len(digests), _MAX_DIGESTS):
        yield digests[begin : begin + _MAX_DIGESTS]


def _placeholders(digests: Sequence[bytes]) -> str:
    return ",".join("?" * len(digests))


def _error_code(error: sqlite3.Error) -> int:
    """Return SQLite's code of an error; that of damage where the error has none."""
    return getattr(error, "sqlite_errorcode", sqlite3.SQLITE_CORRUPT) & 0xFF


def _checksum(*parts: Any) -> int:
    """Return the CRC-32 of the parts of a row, which damage may have turned into anything."""
    return zlib.crc32(b"".join(part for part in parts if isinstance(part, bytes)))
