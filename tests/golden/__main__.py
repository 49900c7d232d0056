"""Compares the tables of all golden studies with the stored ones; `--renew` stores those of today's program."""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from pathlib import Path

from tests.golden.tables import STUDIES, differences, renew, solved


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.golden", description=__doc__)
    parser.add_argument("--only", action="append", choices=list(STUDIES), help="a study; all unless given")
    parser.add_argument("--renew", action="store_true", help="store the tables instead of comparing them")
    options = parser.parse_args()
    told = []
    for name in options.only or STUDIES:
        begin = time.perf_counter()
        with tempfile.TemporaryDirectory() as folder:
            found = solved(name, Path(folder))
        told += (differs := differences(name, found))
        if options.renew:
            renew(name, found)
        print(f"{name:18} {len(found):2} tables {time.perf_counter() - begin:5.1f} s", *differs, sep="\n    ")
    print(f"{len(told)} differences" + (", stored" if options.renew else ""))
    return int(bool(told) and not options.renew)


if __name__ == "__main__":
    sys.exit(main())
