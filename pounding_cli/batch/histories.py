"""The histories a study keeps: taken from the former results file where they are there, else run."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from pounding_cli.errors import InputError
from pounding_cli.solve.histories import History, history
from pounding_cli.solve.response import Response
from pounding_cli.store.files import opened
from pounding_cli.store.histories import stored_history

if TYPE_CHECKING:
    import h5py

    from pounding_cli.study import Plan, Row


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
    with _former(output, plan, key) as file:
        for row in plan.kept:
            if responses[row.scene].status != "done":
                continue
            found = stored_history(file, row, plan.every) if file is not None else None
            try:
                yield row, found or history(plan.scenes[row.scene], plan.accuracy, plan.every)
            except InputError as error:
                tell(f"{row.case}, {row.analysis}, {row.record}: {error}")


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
