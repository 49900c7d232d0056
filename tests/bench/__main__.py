"""`python -m tests.bench`: measure what the program costs, and write it into the pages that say so."""

from __future__ import annotations

import argparse
import os
import time

import tests.bench
from tests.bench.accuracy import measure_accuracy
from tests.bench.opensees import measure_opensees, opensees_version
from tests.bench.pages import ROOT, format_machine, write_block
from tests.bench.performance import measure_performance


def main() -> None:
    argparse.ArgumentParser(prog="python -m tests.bench", description=tests.bench.__doc__).parse_args()
    begin = time.perf_counter()
    measured = f"Measured {format_machine(os.getloadavg()[0])}."
    comparison, promise = measure_opensees()
    with_opensees = f"{measured.removesuffix('.')}, OpenSees {opensees_version()}."
    write_block(ROOT / "docs" / "from-opensees.md", f"{comparison}\n\n{with_opensees}")
    write_block(ROOT / "README.md", f"{promise} {with_opensees}")
    write_block(ROOT / "docs" / "accuracy.md", f"{measure_accuracy()}\n\n{measured}")
    write_block(ROOT / "docs" / "performance.md", f"{measure_performance()}\n\n{measured}")
    print(f"{time.perf_counter() - begin:.0f} s")


if __name__ == "__main__":
    main()
