"""What a run takes over from former ones, and what it says about that."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from pounding_cli.store import PartStore, former_run, stored_chunks
from pounding_cli.words import counted

if TYPE_CHECKING:
    from pounding_cli.study import Plan

IN_MEMORY = 16 << 20
"""Numbers taken over from a results file that may stay in memory [bytes]; the rest goes to the parts."""


def reuse(plan: Plan, output: Path, parts: PartStore, say: Callable[[str], None]) -> None:
    """Find the scenes of the plan that the parts and the former results file have, and say what becomes of them.

    Raises
    ------
    OSError : the parts cannot be written
    """
    from_parts = parts.load(plan.scenes)
    if from_parts:
        what = counted(from_parts, "scene of an unfinished run is", "scenes of an unfinished run are")
        say(f"{what} kept in {parts.folder}")
    former = former_run(output, parts.key)
    if former is None:
        return
    taken = held = 0
    for chunk in stored_chunks(output, parts.key, plan.scenes):
        new = chunk.only([place for place, digest in enumerate(chunk.digests) if digest not in parts])
        parts.add(new)
        held += new.numbers.nbytes
        if held > IN_MEMORY:
            parts.flush()
        taken += len(chunk)
    if former.differs:
        say(
            f"{output} was made with {former.differs}: all scenes are run anew, "
            "and the file stays as it is until the new one is whole"
        )
    elif taken < len(plan.scenes) or taken < former.scenes:
        gone = former.scenes - former.failed - taken
        left = f"; {counted(gone, 'scene in it is', 'scenes in it are')} no longer in the study" if gone else ""
        again = f"; {counted(former.failed, 'that failed is', 'that failed are')} tried again" if former.failed else ""
        say(f"the study has changed since {output}: kept are {_by_case(plan, parts)}{left}{again}")


def _by_case(plan: Plan, parts: PartStore) -> str:
    """How many scenes of each case are at hand, in words."""
    at_hand: Counter[str] = Counter()
    wanted: Counter[str] = Counter()
    seen: set[str] = set()
    for row in plan.rows:
        for digest, case in ((row.scene, row.case), *((digest, "buildings alone") for digest in row.baselines)):
            if digest not in seen:
                seen.add(digest)
                wanted[case] += 1
                at_hand[case] += digest in parts
    return ", ".join(f"{case} {at_hand[case]} of {count}" for case, count in wanted.items())
