"""The histories a study keeps: taken from the former results file where they are there, else run."""

from __future__ import annotations

import contextlib
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from pounding_cli.errors import InputError
from pounding_cli.solve.histories import History, history
from pounding_cli.solve.response import Response
from pounding_cli.store.files import opened
from pounding_cli.store.histories import read_history, stored_histories

if TYPE_CHECKING:
    import h5py

    from pounding_cli.study import Plan, Row

WORTH_TELLING = 20
"""So many scenes to run for their histories take some seconds, and the user is told."""


def kept_histories(
    plan: Plan, responses: Mapping[str, Response], output: Path, key: str, tell: Callable[[str], None]
) -> Iterator[tuple[Row, History]]:
    """The histories of the kept rows, one by one in the order of the tables; rows whose scene failed are left out.

    Where the run between output times fails although the scene's own was done, `tell` hears of it.

    Parameters
    ----------
    responses : by scene digest; of every kept row
    output, key : a results file whose histories serve again where it has this `solution_key`
    """
    if not plan.kept:
        return
    ahead = Counter(row.scene for row in plan.kept)  # rows may share a scene
    made: dict[str, History] = {}
    with _former(output, plan, key) as file:
        stored = {} if file is None else stored_histories(file, plan.every)
        missing = sum(scene not in stored for scene in ahead)
        if missing >= WORTH_TELLING:
            tell(f"running {missing} scenes for their histories")
        for row in plan.kept:
            if responses[row.scene].status != "done":
                continue
            ahead[row.scene] -= 1
            found = made.pop(row.scene, None)
            if found is None and row.scene in stored:
                found = read_history(stored[row.scene])
            if found is None:
                try:
                    found = history(plan.scenes[row.scene], plan.accuracy, plan.every)
                except InputError as error:
                    tell(f"{row.case}, {row.analysis}, {row.record}: {error}")
                    continue
            if ahead[row.scene]:
                made[row.scene] = found
            yield row, found


@contextlib.contextmanager
def _former(output: Path, plan: Plan, key: str) -> Iterator[h5py.File | None]:
    """The results file of a former run, open, if the same solver wrote it for buildings of the same names."""
    with contextlib.ExitStack() as stack:
        try:
            file = stack.enter_context(opened(output))
            same = file.attrs["solution_key"] == key and tuple(file["building"].asstr()[:]) == plan.buildings
        except (InputError, OSError, KeyError):
            same = False
        yield file if same else None
