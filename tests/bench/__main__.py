"""`python -m tests.bench`: measure what the program costs, and write it into the pages that say so.

`python -m tests.bench pictures` draws the pictures of the documentation that show reports, and
`python -m tests.bench twist` prints what floors that twist cost.
"""

from __future__ import annotations

import argparse
import os
import time

import tests.bench
from tests.bench.accuracy import measure_accuracy
from tests.bench.opensees import measure_opensees, opensees_version
from tests.bench.pages import ROOT, format_machine, write_block
from tests.bench.performance import measure_performance
from tests.bench.pictures import draw_pictures
from tests.bench.twist import measure_twist


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m tests.bench", description=tests.bench.__doc__)
    parser.add_argument("part", nargs="?", choices=("costs", "pictures", "twist"), default="costs")
    part = parser.parse_args().part
    begin = time.perf_counter()
    if part == "pictures":
        draw_pictures()
    elif part == "twist":
        print(measure_twist())
    else:
        measure_costs()
    print(f"{time.perf_counter() - begin:.0f} s")


def measure_costs() -> None:
    """Measure times and errors, and write them into the pages."""
    measured = f"Measured {format_machine(os.getloadavg()[0])}."
    comparison, promise = measure_opensees()
    with_opensees = f"{measured.removesuffix('.')}, OpenSees {opensees_version()}."
    write_block(ROOT / "docs" / "from-opensees.md", f"{comparison}\n\n{with_opensees}")
    write_block(ROOT / "README.md", f"{promise} {with_opensees}")
    write_block(ROOT / "docs" / "accuracy.md", f"{measure_accuracy()}\n\n{measured}")
    write_block(ROOT / "docs" / "performance.md", f"{measure_performance()}\n\n{measured}")


if __name__ == "__main__":
    main()
