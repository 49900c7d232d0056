"""The histories a study keeps: taken from the former results file where they are there, else run."""

from __future__ import annotations

import contextlib
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5py

from pounding_cli.errors import InputError, Problem
from pounding_cli.numbers import counted
from pounding_cli.solver.histories import History, history
from pounding_cli.solver.response import Response
from pounding_cli.store.files import opened
from pounding_cli.store.histories import Kept, kept_places, place_of, read_history, same_value, stored_groups
from pounding_cli.store.structure import strings

if TYPE_CHECKING:
    from pounding_cli.study import Plan, Row

WORTH_TELLING = 20
"""So many scenes to run for their histories take some seconds, and the user is told."""


def kept_histories(
    plan: Plan,
    responses: Mapping[str, Response],
    output: Path,
    key: str,
    tell: Callable[[str], None],
    replace: bool = False,
) -> Iterator[Kept | h5py.Group]:
    """The histories of the kept rows, one by one in the order of the tables; rows whose scene failed are left out.

    Then what a former run kept and this study does not ask for: rows that are still the same scenes, and groups of
    the former file for scenes that the study does not have any more. Where the run between output times fails although
    the scene's own was done, `tell` hears of it.

    Parameters
    ----------
    responses : by scene digest; of every kept row
    output, key : a results file whose histories serve again where it has this `solution_key`
    replace : leave out what the study does not ask for
    """
    with _former(output, key) as file:
        former = [] if file is None else [_Former(group) for group in _readable(file, tell)]
        stored = {each.scene: each for each in former if each.every == plan.every and each.buildings == plan.buildings}
        ahead = Counter(row.scene for row in plan.kept)  # rows may share a scene
        made: dict[str, History] = {}
        missing = sum(scene not in stored for scene in ahead)
        if missing >= WORTH_TELLING:
            tell(f"running {missing} scenes for their histories")
        for row in plan.kept:
            if responses[row.scene].status != "done":
                continue
            ahead[row.scene] -= 1
            found = made.pop(row.scene, None)
            if found is None and row.scene in stored:
                found = stored[row.scene].read()
            if found is None:
                try:
                    found = history(plan.scenes[row.scene], plan.accuracy, plan.every)
                except InputError as error:
                    tell(f"{row.case}, {row.analysis}, {row.record}: {error}")
                    continue
            if ahead[row.scene]:
                made[row.scene] = found
            yield Kept(row, plan.every, found)
        if not replace:
            yield from _rest(plan, former, tell)


def refuse_loss(plan: Plan, output: Path, differs: str) -> None:
    """Refuse a run that would drop histories of a former one: made otherwise, and not asked for again.

    differs : in words, how the former run was made

    Raises
    ------
    InputError : how many there are
    """
    again = [place_of(plan, row) for row in plan.kept]
    lost = 0
    with contextlib.suppress(InputError, OSError), opened(output, any_version=True) as file:
        lost = sum(not any(_agrees(facts, place) for place in again) for facts in kept_places(file))
    if lost:
        what = f"the output keeps {counted(lost, 'history', 'histories')} that this run would drop"
        hint = "write `keep` in the study to make them again, name another file with -o, or use --replace"
        raise InputError(Problem(f"{what}: it was made with {differs}", hint, str(output)))


class _Former:
    """A scene over time in the former file."""

    def __init__(self, group: h5py.Group) -> None:
        self.group = group
        self.scene, self.every = str(group.attrs["scene"]), float(group.attrs["every"])
        self.buildings = tuple(strings(group["building"]))

    def read(self) -> History | None:
        """It, or None where it is damaged."""
        try:
            return read_history(self.group)
        except Exception:  # whatever is wrong with it, it can be run again
            return None


def _readable(file: h5py.File, tell: Callable[[str], None]) -> Iterator[h5py.Group]:
    """The scenes over time in a file that are what they should be."""
    damaged = 0
    try:
        groups = stored_groups(file)
    except Exception:
        groups, damaged = [], 1
    for group in groups:
        try:
            _Former(group)
        except Exception:
            damaged += 1
            continue
        yield group
    if damaged:
        tell(f"histories in {file.filename} are damaged; those the study keeps are run again")


def _rest(plan: Plan, former: list[_Former], tell: Callable[[str], None]) -> Iterator[Kept | h5py.Group]:
    """What a former run kept beyond `plan.kept`."""
    kept = {(row.scene, plan.every) for row in plan.kept}
    wanted = {each.scene for each in former} if former else set()
    rows: dict[str, list[Row]] = {}
    for row in plan.rows if wanted else ():
        if row.scene in wanted:
            rows.setdefault(row.scene, []).append(row)
    now = {(row.point, row.case, row.analysis, row.record) for row in plan.kept}
    strays = []
    for each in former:
        mine = [
            row for row in rows.get(each.scene, ()) if each.buildings == plan.buildings
            and _agrees(each.group.attrs, place_of(plan, row))
        ]  # fmt: skip
        if any((row.point, row.case, row.analysis, row.record) in now for row in mine):
            continue  # the study keeps this row, maybe at another step
        found = each.read()
        if found is None:
            tell(f"the history {each.group.name} of the former file is damaged, and is left out")
        elif mine:
            now.add((mine[0].point, mine[0].case, mine[0].analysis, mine[0].record))
            kept.add((each.scene, each.every))
            yield Kept(mine[0], each.every, found)
        else:
            strays.append(each)
    count = 0
    for each in strays:
        if (each.scene, each.every) not in kept:
            kept.add((each.scene, each.every))
            count += 1
            yield each.group
    if count:
        what = counted(count, "history of a scene", "histories of scenes")
        tell(f"{what} no longer in the study stay in the file; --replace leaves them out")


def _agrees(facts: Mapping[str, Any], place: Mapping[str, Any]) -> bool:
    """Whether a kept scene stands at a place of the study."""
    return all(name in facts and same_value(facts[name], value) for name, value in place.items())


@contextlib.contextmanager
def _former(output: Path, key: str) -> Iterator[h5py.File | None]:
    """The results file of a former run, open, if the same solver wrote it."""
    with contextlib.ExitStack() as stack:
        try:
            file = stack.enter_context(opened(output))
            same = file.attrs["solution_key"] == key
        except (InputError, OSError, KeyError):
            same = False
        yield file if same else None
        with contextlib.suppress(InputError):  # damage, which was told where it was met
            stack.close()
