"""Mutations of results files and parts: `python -m tests.hard.damage --tries 1000` counts what comes of them.

`damaged`: bits, bytes and lengths change, as disks and networks change them; nothing may be shown that is not what was
written. `forged`: what someone makes who knows how the file is written, checksums included; the numbers may then be
anything, but each command ends with a sentence. `parts`: the same of what an unfinished run left.
"""

from __future__ import annotations

import argparse
import contextlib
import hashlib
import io
import json
import random
import shutil
import signal
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from unittest import mock

import h5py
import numpy as np

from pounding_cli import open_results
from pounding_cli.cli.main import main as pound
from pounding_cli.errors import InputError
from pounding_cli.store import PartStore, stored_chunks
from tests.helpers.sealing import edited

from .hunting import faults, pooled

LONGEST = 20.0
"""Commands on one file of the small study never take so long [s of the processor]; who waits uses none."""

STUDY = """\
title: A small study
records: {use: [elcentro, taft], duration: 1 s}
buildings: {stiff: {storeys: 2, period: 0.2 s}, soft: {like: stiff, storeys: 1, period: 0.5 s}}
group: [stiff, soft]
cases: {touching: {link: pounding, gap: 0 cm}, gap: {link: pounding, gap: 2 cm}}
keep: {histories: {cases: [gap], records: [taft], every: 0.02 s, where: {impact.restitution: 0.5}}}
sweep: {impact.restitution: [0.5, 0.7]}
"""

COMMANDS: tuple[Callable[[str, str], list[str]], ...] = (
    lambda file, out: ["show", file, "storey"],
    lambda file, out: ["show", file, "scene", "--format", "csv"],
    lambda file, out: ["show", file, "link", "--format", "json"],
    lambda file, out: ["report", file, "-o", f"{out}/report", "--no-figures"],
    lambda file, out: ["export", file, "-o", f"{out}/csv"],
    lambda file, out: ["export", file, "-o", f"{out}/r.nc"],
    lambda file, out: ["compare", file, f"{out}/../whole.h5"],
    lambda file, out: ["cite", file],
)

ODD = (
    "", "\x1b[31mred", "../../../PWNED", "=1+1", "$\\frac{1}$", "<script>alert(1)</script>", "a\0b", "x" * 10_000,
    "\ud800", "nan", "a\nb", "{", "[]", "null", "[[1]]", '{"buildings": 3}',
)  # fmt: skip


DIMENSIONS = {"REFERENCE_LIST", "DIMENSION_LIST"}
"""Attributes by which HDF5 attaches dimension scales."""


class Hang(BaseException):
    """A command took longer than LONGEST."""


@contextlib.contextmanager
def no_longer(seconds: float) -> Iterator[None]:
    def ring(*_: object) -> None:
        raise Hang

    clocks = {signal.ITIMER_PROF: (signal.SIGPROF, seconds), signal.ITIMER_REAL: (signal.SIGALRM, 60 * seconds)}
    former = {number: signal.signal(number, ring) for number, _ in clocks.values()}
    for clock, (_, longest) in clocks.items():
        signal.setitimer(clock, longest)
    try:
        yield
    finally:
        for clock in clocks:
            signal.setitimer(clock, 0)
        for number, handler in former.items():
            signal.signal(number, handler)


def called(arguments: list[str]) -> tuple[int, str]:
    """Exit code and what a command printed.  Raises what gets through `main`."""
    said = io.StringIO()
    with (
        mock.patch.object(sys, "argv", ["pound", "--debug", *arguments]),
        contextlib.redirect_stdout(said),
        contextlib.redirect_stderr(said),
    ):
        try:
            pound()
        except SystemExit as end:
            return int(end.code or 0), said.getvalue()
    return 0, said.getvalue()


class Bench:
    """A small study, its results, and copies of them to be spoiled."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.study, self.whole, self.file = folder / "study.yaml", folder / "whole.h5", folder / "now.h5"
        self.out = folder / "out"
        self.study.write_text(STUDY)
        code, said = called(["run", str(self.study), "-o", str(self.whole), "--workers", "1"])
        assert code == 0, said
        self.content = self.whole.read_bytes()
        self.tables = tables_of(self.whole)
        key = str(open_results(self.whole).attrs["solution_key"])
        store = PartStore(self.file, key)
        for chunk in stored_chunks(self.whole, key):
            for begin in range(0, len(chunk), 5):
                store.add(chunk.only(range(begin, min(begin + 5, len(chunk)))))
        store.flush()
        self.parts = {path.name: path.read_bytes() for path in sorted(store.folder.iterdir())}
        self.part_folder = store.folder
        shutil.rmtree(store.folder)

    def fresh(self, content: bytes | None = None) -> None:
        """Begin again with these results."""
        shutil.rmtree(self.out, ignore_errors=True)
        shutil.rmtree(self.part_folder, ignore_errors=True)
        self.out.mkdir()
        self.file.unlink(missing_ok=True)
        if content is not None:
            self.file.write_bytes(content)

    def run(self) -> tuple[int, str]:
        """`pound run` on the spoiled file."""
        return called(["run", str(self.study), "-o", str(self.file), "--workers", "1"])


def tables_of(path: Path) -> bytes:
    """Every number of a results file that the motion decides, and its histories."""
    results = open_results(path)
    sha = hashlib.sha256()
    for frame in (results.storey(), results.floor(), results.link(), results.summary(), results.records()):
        sha.update(frame.to_csv(index=False).encode())
    sha.update(results.buildings.to_csv(index=False).encode())
    names = [*results.axes, "case", "analysis", "record"]
    for kept in results.histories().to_dict("records"):
        history = results.history(**{name: kept[name] for name in names})
        sha.update(history.shear.tobytes() + history.link_force.tobytes() + history.displacement.tobytes())
    return sha.digest()


def damaged_bytes(content: bytes, chance: random.Random) -> bytes:
    """The content with one thing wrong with it."""
    whole = bytearray(content)
    kind = chance.choices(("bit", "byte", "run", "cut", "zeros", "swap", "grown"), (12, 3, 3, 2, 2, 2, 1))[0]
    at = chance.randrange(len(whole))
    length = min(chance.choice((16, 512, 4096)), len(whole) - at)
    if kind == "bit":
        whole[at] ^= 1 << chance.randrange(8)
    elif kind == "byte":
        whole[at] = chance.randrange(256)
    elif kind == "run":
        whole[at : at + length] = chance.randbytes(length)
    elif kind == "cut":
        del whole[at:]
    elif kind == "zeros":
        whole[at : at + length] = bytes(length)
    elif kind == "swap":
        other = chance.randrange(len(whole) - length + 1)
        whole[at : at + length], whole[other : other + length] = (
            whole[other : other + length], whole[at : at + length],
        )  # fmt: skip
    else:
        whole += chance.randbytes(length)
    return bytes(whole[: len(content) + 4096])


def damage(bench: Bench, chance: random.Random) -> str:
    """One damaged results file: read, given to a command, run again."""
    content = damaged_bytes(bench.content, chance)
    bench.fresh(content)
    try:
        outcome = "the same" if tables_of(bench.file) == bench.tables else "SILENT: other numbers read"
    except InputError:
        outcome = "refused"
    code, said = called(chance.choice(COMMANDS)(str(bench.file), str(bench.out)))
    if code not in (0, 1, 2) or "Traceback" in said:
        return f"TRACEBACK: {said[-1500:]}"
    code, said = bench.run()
    if code == 0 and tables_of(bench.file) != bench.tables:
        return "SILENT: other numbers after `run`"
    if code not in (0, 2) or "Traceback" in said:
        return f"TRACEBACK: run {said[-1500:]}"
    again = "made whole by run" if code == 0 else "left alone by run"
    return f"{outcome}, {again}" if content != bench.content else "nothing changed"


def forge(bench: Bench, chance: random.Random) -> str:
    """One results file that someone changed on purpose: commands end with a sentence, and write into their output."""
    bench.fresh(bench.content)
    with edited(bench.file) as file:
        for _ in range(chance.choice((1, 1, 2))):
            with (
                contextlib.suppress(OSError, KeyError, ValueError, TypeError, RuntimeError, OverflowError),
                np.errstate(over="ignore"),
            ):
                change(file, chance)
    before = set(bench.folder.rglob("*")) | set(bench.folder.parent.glob("*"))
    codes = []
    again = lambda file, _: ["run", str(bench.study), "-o", file, "--workers", "1"]  # noqa: E731
    for command in (*chance.sample(COMMANDS, 2), again):
        code, said = called(command(str(bench.file), str(bench.out)))
        codes.append(code)
        if code not in (0, 1, 2) or "Traceback" in said:
            return f"TRACEBACK: {said[-1500:]}"
        if "\x1b[31m" in said:
            return f"SILENT: terminal escapes shown {said[-200:]!r}"
    new = (set(bench.folder.rglob("*")) | set(bench.folder.parent.glob("*"))) - before
    outside = [path for path in new if bench.out not in path.parents]
    if outside:
        return f"SILENT: wrote {outside[0]}"
    return "refused by all" if set(codes) == {2} else "refused by some" if 2 in codes else "read"


def change(file: h5py.File, chance: random.Random) -> None:
    """Make one thing in a file something else."""
    names: list[str] = []
    file.visit(names.append)
    name = chance.choice(names)
    item = file[name]
    kind = chance.choice(("attribute", "attribute", "delete", "values", "values", "type", "link", "size"))
    if kind == "attribute":
        holder = chance.choice((file, file, item if set(item.attrs) - DIMENSIONS else file))
        attribute = chance.choice([each for each in holder.attrs if each not in DIMENSIONS])
        if chance.random() < 0.15:
            del holder.attrs[attribute]
        else:
            value = chance.choice(
                (np.nan, -1, 10**9, np.arange(3), np.zeros(0), h5py.Empty("f"), 2.5, b"\xff\xfe",
                 chance.choice(ODD[:8]), chance.choice(ODD[9:]))
            )  # fmt: skip
            if isinstance(value, bytes):
                value = np.array(value, h5py.string_dtype())
            holder.attrs[attribute] = value
    elif kind == "delete":
        del file[name]
    elif kind == "values" and isinstance(item, h5py.Dataset) and item.size:
        at = tuple(chance.randrange(size) for size in item.shape)
        if h5py.check_string_dtype(item.dtype):
            item[at] = chance.choice((*ODD[:6], *ODD[7:8], *ODD[9:], b"\xff\xfe"))
        else:
            item[at] = chance.choice((0, -1, 1e300, np.nan, np.inf, 10**6))
    elif kind == "type":
        del file[name]
        value = chance.choice(
            (np.zeros(3), np.zeros((2, 2)), 1.0, "text", ["a", "b"], np.zeros(2, "i8,f8"), np.zeros(0))
        )
        file[name] = value
    elif kind == "link":
        del file[name]
        file[name] = chance.choice((h5py.SoftLink("/V"), h5py.ExternalLink("/etc/passwd", "/"), h5py.SoftLink("/no")))
    elif kind == "size" and isinstance(item, h5py.Dataset):
        del file[name]
        shape = chance.choice(((4 * 10**8,), (10**5, 10**4), (2, 2, 2, 2, 2, 2)))
        file.create_dataset(name, shape, chance.choice(("f8", "i4")), chunks=True)


def spoil_part(bench: Bench, chance: random.Random) -> str:
    """One damaged or forged part; the run comes to the same tables, or ends with a sentence."""
    bench.fresh()
    bench.part_folder.mkdir()
    for name, content in bench.parts.items():
        (bench.part_folder / name).write_bytes(content)
    name = chance.choice(list(bench.parts))
    forged = chance.random() < 0.4
    content = forged_part(bench.parts[name], chance) if forged else damaged_bytes(bench.parts[name], chance)
    (bench.part_folder / name).write_bytes(content)
    code, said = bench.run()
    if code not in (0, 1, 2) or "Traceback" in said:
        return f"TRACEBACK: {said[-1500:]}"
    if forged:
        return "forged, ended with a sentence" if code else "forged, run through"
    if code or tables_of(bench.file) != bench.tables:
        return f"SILENT: other numbers after `run`, or none ({code}, {said[-200:]})"
    return "damaged, solved again" if "is damaged" in said else "the same"


def forged_part(content: bytes, chance: random.Random) -> bytes:
    """A part whose head says something else, under a checksum that fits."""
    magic, _, head, numbers = content.split(b"\n", 3)
    facts = json.loads(head)
    odd = chance.choice((None, -1, 10**9, [], {}, "x", [[]], [1e400], ["\ud800"], "a" * 10000, 10**400))
    where = chance.choice(("digests", "lines", "words", "inside", "numbers"))
    if where == "inside":
        line = json.loads(facts["lines"][0])
        line[chance.choice(list(line))] = odd
        facts["lines"][0] = json.dumps(line)
    elif where == "numbers":
        numbers = numbers[: chance.randrange(len(numbers))]
    elif chance.random() < 0.5:
        facts[where] = odd
    else:
        facts[where][0] = odd
    body = json.dumps(facts).encode() + b"\n" + numbers
    return magic + b"\n" + hashlib.sha256(body).hexdigest().encode() + b"\n" + body


HUNTS: dict[str, Callable[[Bench, random.Random], str]] = {"damaged": damage, "forged": forge, "parts": spoil_part}


def hunt(bench: Bench, name: str, tries: int, start: int = 0, tell: Callable[[str], None] = print) -> Counter[str]:
    """What came of so many mutations, each from a seed of its own; `tell` hears of each that is a fault."""
    found: Counter[str] = Counter()
    for seed in range(start, start + tries):
        chance = random.Random(f"{name} {seed}")
        begin = time.perf_counter()
        try:
            with no_longer(LONGEST):
                outcome = HUNTS[name](bench, chance)
        except Hang:
            outcome = "HANG"
        except Exception:
            outcome = f"TRACEBACK: {traceback.format_exc()[-600:]}"
        if outcome.split(":")[0].isupper():
            tell(f"{name}, seed {seed}, {time.perf_counter() - begin:.1f} s: {outcome}")
        found[outcome.split(":")[0]] += 1
    return found


def fresh_hunt(name: str, tries: int, start: int, tell: Callable[[str], None]) -> Counter[str]:
    """The same with a bench of its own."""
    with tempfile.TemporaryDirectory() as folder:
        inner = Path(folder) / "a" / "b"
        inner.mkdir(parents=True)
        return hunt(Bench(inner), name, tries, start, tell)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tries", type=int, default=1000, help="mutations of every sort")
    parser.add_argument("--seed", type=int, default=0, help="the first seed")
    parser.add_argument("--only", choices=HUNTS, help="one sort of mutation; all unless given")
    parser.add_argument("--processes", type=int, default=2, help="processes at once")
    options = parser.parse_args()
    names = [options.only] if options.only else HUNTS
    found = (pooled(n, partial(fresh_hunt, n), options.tries, options.seed, options.processes) for n in names)
    return 1 if sum(map(faults, found)) else 0


if __name__ == "__main__":
    sys.exit(main())
