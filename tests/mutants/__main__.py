"""`python -m tests.mutants [--only TEXT] [--list]`, from the repository root."""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

from .catalogue import MUTANTS
from .markers import markers
from .runner import ROOT, try_all


def main() -> int:
    """Try the faults; 0 if every one was seen, 1 if not."""
    parser = argparse.ArgumentParser(prog="python -m tests.mutants", description=__doc__)
    parser.add_argument("--only", default="", help="faults whose words, marker, file or test contain this")
    parser.add_argument("--list", action="store_true", help="list the faults and try none")
    options = parser.parse_args()
    places = dict(markers(ROOT))
    file = {m: places[m.marker].file if m.marker in places else "nowhere" for m in MUTANTS}
    chosen = [m for m in MUTANTS if options.only in " ".join((m.fault, m.marker, file[m], m.test))]
    if options.list:
        print("\n".join(f"{m.fault}: {m.marker} in {file[m]}, {m.test}" for m in chosen))
        return 0
    if not chosen:
        print(f"no fault contains '{options.only}'; --list shows them all", file=sys.stderr)
        return 1
    unseen = 0
    with tempfile.TemporaryDirectory() as folder:
        try:
            for outcome in try_all(chosen, Path(folder)):
                unseen += bool(outcome.problem)
                word = f"NOT SEEN ({outcome.problem})" if outcome.problem else "seen"
                print(f"{outcome.seconds:5.1f} s  {outcome.mutant.fault}: {word}", flush=True)
        except RuntimeError as failure:
            print(failure, file=sys.stderr)
            return 1
    print(f"{len(chosen) - unseen} of {len(chosen)} faults seen")
    return int(unseen > 0)


if __name__ == "__main__":
    sys.exit(main())
