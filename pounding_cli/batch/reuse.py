"""What a run takes over from former ones, and what it says about that."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from pounding_cli.batch.families import order_of
from pounding_cli.batch.histories import refuse_loss
from pounding_cli.model.placed import among
from pounding_cli.numbers import counted
from pounding_cli.store import PartStore, former_run, stored_chunks
from pounding_cli.store.files import damage_of
from pounding_cli.workflows import WORKFLOWS

if TYPE_CHECKING:
    from pounding_cli.study import Plan

IN_MEMORY = 16 << 20
"""Numbers taken over from a results file that may stay in memory [bytes]; the rest goes to the parts."""


def reuse(plan: Plan, output: Path, parts: PartStore, say: Callable[[str], None], replace: bool = False) -> None:
    """Take over the scenes that the parts and the former results file have, and say what becomes of them.

    Those that the study does not have any more are taken over too, unless `replace`.

    Raises
    ------
    InputError : the former file keeps histories that this run would drop
    OSError : the parts cannot be written
    """
    for damaged in parts.load():
        say(f"{damaged} is damaged: its scenes are solved again")
    from_parts = int(parts.has(plan.scenes).sum())
    if from_parts:
        what = counted(from_parts, "scene of an unfinished run is", "scenes of an unfinished run are")
        say(f"{what} kept in {parts.folder}")
    former = former_run(output, parts.key)
    damage = damage_of(output) if output.exists() else ""
    if former is not None and former.differs:
        if not replace:
            refuse_loss(plan, output, former.differs)
    elif damage:
        say(f"{output} is damaged ({damage}): intact results are kept, the others are solved again")
    taken = held = 0
    for chunk in stored_chunks(output, parts.key):
        new = chunk.only(np.flatnonzero(~parts.has(chunk.digests)).tolist())
        parts.add(new)
        held += new.numbers.nbytes
        if held > IN_MEMORY:
            parts.flush()
        taken += int(among(plan.scenes, chunk.digests).sum())
    in_rounds = bool(WORKFLOWS[plan.workflow].refine)  # later rounds may ask for what this one does not
    if replace and not in_rounds:
        parts.only(plan.scenes)
    if former is None:
        return
    if former.differs:
        say(
            f"{output} was made with {former.differs}: all scenes are solved again, "
            "and the file stays until the new one is complete"
        )
    elif not in_rounds and (taken < len(plan.scenes) or taken < former.scenes):
        gone = sum(int((~among(plan.scenes, some)).sum()) for some in parts.pieces())
        stay = "stays in the file" if gone == 1 else "stay in the file"
        left = f"; {counted(gone, 'scene')} no longer in the study {stay}" if gone else ""
        again = f"; {counted(former.failed, 'that failed is', 'that failed are')} tried again" if former.failed else ""
        say(f"the study has changed since {output}: kept are {_by_case(plan, parts)}{left}{again}")


def _by_case(plan: Plan, parts: PartStore) -> str:
    """How many scenes of each case are at hand, in words."""
    wanted, missing = (
        order_of(plan, solved).counts for solved in (lambda digests: np.zeros(len(digests), bool), parts.has)
    )
    said = []
    for case in (plan.cases[0], "", *plan.cases[1:]):
        count, open_ = (sum(counts[case, analysis] for analysis in plan.analyses) for counts in (wanted, missing))
        if count:
            said.append(f"{case or 'buildings alone'} {count - open_} of {count}")
    return ", ".join(said)
