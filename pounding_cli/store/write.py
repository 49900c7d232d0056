"""Writing the results file: to a temporary file beside it, then in its place in one step."""

from __future__ import annotations

import functools
import hashlib
import json
import os
import platform
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING

import h5py
import numpy as np

from pounding_cli.errors import InputError
from pounding_cli.model.links import link_label
from pounding_cli.solver.response import Response
from pounding_cli.store import answers
from pounding_cli.store.blocks import Block, blocks
from pounding_cli.store.datasets import Datasets
from pounding_cli.store.dense import Shape, facts, shape_of
from pounding_cli.store.files import damage_of, opened
from pounding_cli.store.former import written_place
from pounding_cli.store.histories import Kept, write_histories
from pounding_cli.store.keys import FORMAT, FORMAT_VERSION, key_of, package_version, solver_version
from pounding_cli.store.parts import PartStore
from pounding_cli.store.sink import writing
from pounding_cli.store.solutions import write_solutions
from pounding_cli.store.swept import describe_unit
from pounding_cli.variables import COORDINATES, RECORDS, VARIABLES, WRITTEN, Variable
from pounding_cli.workflows import WORKFLOWS

if TYPE_CHECKING:
    from pounding_cli.study import Plan, Study

_SOFTWARE = ("numpy", "scipy", "numba", "h5py")


@dataclass(frozen=True)
class Run:
    """How the results came about: wall time [s], scenes solved now, scenes reused, how many side by side."""

    wall_seconds: float = 0.0
    solved: int = 0
    reused: int = 0
    engine: str = "serial"
    workers: int = 1


def write_results(
    path: Path,
    plan: Plan,
    responses: Mapping[str, Response],
    run: Run | None = None,
    histories: Iterable[Kept | h5py.Group] = (),
) -> None:
    """Write one results file, whole or not at all.

    Parameters
    ----------
    path : the file; one that exists is replaced in one step
    plan : the study expanded
    responses : by scene digest; every scene of the plan, and others, which are only kept for reuse
    run : how they came about
    histories : see `write_histories`; taken one by one while the file is written

    Raises
    ------
    OSError : the disk is full, or the folder went away; `path` is as it was
    """
    store = responses if isinstance(responses, PartStore) else PartStore.of(responses)
    with writing(path) as (file, sink):
        _write(file, plan, store, run or Run(), sink.check, path)
        write_histories(file, plan, histories)


def is_current(path: Path, plan: Plan) -> bool:
    """Whether the file already holds exactly this plan, every scene done and no byte damaged."""
    try:
        with opened(path) as file:
            same = file.attrs["content"] == content_digest(plan) and int(file.attrs["scenes_failed"]) == 0
        return same and not damage_of(path)
    except (InputError, KeyError, OSError):
        return False


def is_finished(path: Path, study: Study, all_effects: bool) -> bool:
    """Whether the file holds just what `pound run` makes of a long study, as far as that can be told without expanding
    it: every scene done and no byte damaged."""
    from pounding_cli.store.expanded import is_long, study_key  # here: whoever only reads results expands nothing

    if not is_long(study.axes):
        return False
    try:
        with opened(path) as file:
            facts = file.attrs
            same = facts["study_key"] == study_key(study, all_effects) and int(facts["scenes_failed"]) == 0
        return same and not damage_of(path)
    except (InputError, KeyError, OSError):
        return False


def content_digest(plan: Plan) -> str:
    """SHA-256 of all that a results file says, solver included, cost and machine left out."""
    plan = plan.first or plan
    sha = hashlib.sha256()
    for part in (
        key_of(plan),
        plan.study.title,
        plan.study.text,
        _json(plan.study.resolved()),
        repr((plan.axes, plan.cases, plan.analyses, plan.records, plan.buildings, plan.motions)),
        repr(([(row.point, row.case, row.analysis, row.record) for row in plan.kept], plan.every)),
    ):
        sha.update(part.encode() + b"\0")
    if plan.workflow != "run":
        sha.update("\0".join((plan.workflow, str(answers.MEANING), *WORKFLOWS[plan.workflow].shows, "")).encode())
    sha.update(plan.rows.table.digests.ravel().data)
    sha.update(plan.rows.scenes.ravel().data)
    return sha.hexdigest()


def _write(file: h5py.File, plan: Plan, responses: PartStore, run: Run, check: Callable[[], None], path: Path) -> None:
    datasets = Datasets(file)
    _write_axes(file, datasets, plan)
    shape = shape_of(plan, responses)
    _write_coordinates(file, datasets, plan, shape)
    found = facts(plan, shape)
    for name, (dims, array) in found.items():
        if array.size:  # no case has a link
            datasets.write(name, dims, array, VARIABLES[name].unit, VARIABLES[name].text)
    check()
    _write_blocks(datasets, blocks(plan, responses, shape, found["height"]), VARIABLES, shape, check)
    datasets.tie()
    tables = WORKFLOWS[plan.workflow].part("tables")
    if tables is not None:
        answers.write_tables(file, tables(plan, lambda name: file[name][()], responses))
        check()
    for name, quantity in WRITTEN.items():
        if name in file:  # where no case has a link, no gap is
            describe_unit(file[name], plan.study.unit(quantity))
    study = file.create_group("study")
    study.attrs["title"] = plan.study.title
    study.attrs["assumed_heights"] = json.dumps(plan.study.assumed_heights())
    study["text"] = plan.study.text
    study["resolved"] = _json(plan.study.resolved())
    study["warnings"] = json.dumps([vars(warning) for warning in plan.study.warnings])
    if plan.motions and (match := plan.study.spectrum_match()) is not None:
        study["spectrum"] = json.dumps(match.as_dict())
    write_solutions(file, plan.scenes, responses)
    _write_attributes(file, plan, responses, run)
    file.attrs["study_file"] = written_place(plan.study, path)


def _write_blocks(
    datasets: Datasets,
    found: Iterable[Block],
    variables: Mapping[str, Variable],
    shape: Shape,
    check: Callable[[], None],
) -> None:
    """Write what the scenes did, a block of rows at a time; a block is one compressed piece of each variable."""
    made: dict[str, h5py.Dataset] = {}
    for block in found:
        _write_block(datasets, block, made, variables, shape)
        del block  # before the next one is made
        check()


def _write_block(
    datasets: Datasets, block: Block, made: dict[str, h5py.Dataset], variables: Mapping[str, Variable], shape: Shape
) -> None:
    """Write one of them; `made`: the datasets that are filled piece by piece."""
    alone = tuple(1 for place in block.at if not isinstance(place, slice))
    begin = tuple(place.start if isinstance(place, slice) else place for place in block.at)
    for name, array in block.data.items():
        if array.size == 0:  # no case has a link
            continue
        variable = variables[name]
        dims = (*shape.axes, *variable.dims)
        whole = shape.of(dims)
        piece = array.reshape((*alone, *array.shape))
        if piece.shape == whole:
            datasets.write(name, dims, piece, variable.unit, variable.text)
            continue
        if name not in made:
            made[name] = datasets.empty(name, dims, whole, piece.dtype, piece.shape, variable.unit, variable.text)
        datasets.put(made[name], (*begin, *(0 for _ in whole[len(begin) :])), piece)


def _write_axes(file: h5py.File, datasets: Datasets, plan: Plan) -> None:
    """Write the swept keys."""
    beside: list[str] = []
    for axis in plan.axes:
        for number, name in enumerate(axis.names):
            values = _axis_values([value[number] for value in axis.values])
            if number:
                dataset = datasets.write(name, (axis.names[0],), values, "", f"swept with {axis.names[0]}")
                beside.append(name)
            else:
                dataset = datasets.scale(name, values, "", f"swept: {name}")
            describe_unit(dataset, axis.unit(number))
    file.attrs["coordinates"] = " ".join(beside)  # xarray then takes them for coordinates


def _write_coordinates(file: h5py.File, datasets: Datasets, plan: Plan, shape: Shape) -> None:
    """Write the other coordinate variables."""
    numbers = {dim: np.arange(1, shape.sizes[dim] + 1) for dim in ("storey", "floor")}
    texts = {
        "case": plan.cases,
        "analysis": plan.analyses,
        "record": plan.records,
        "building": plan.buildings,
    }
    for dim, names in texts.items():
        datasets.scale(dim, _text(names), *COORDINATES[dim])
    for dim, values in numbers.items():
        datasets.scale(dim, values, *COORDINATES[dim])
    beside = file.attrs["coordinates"].split()
    if shape.links:
        labels = [link_label(plan.buildings, place) for place in shape.links]
        datasets.scale("link", _text(labels), *COORDINATES["link"])
        left, left_floor, right_floor, _ = (np.array(column) for column in zip(*shape.links, strict=True))
        beside_links = {
            "link_left": _text([plan.buildings[place] for place in left]),
            "link_right": _text([plan.buildings[place + 1] for place in left]),
            "link_floor": left_floor,
            "link_right_floor": right_floor,
        }
        for name, array in beside_links.items():
            datasets.write(name, ("link",), array, *COORDINATES[name])
        beside += beside_links
    beside += [variable.name for variable in RECORDS]
    file.attrs["coordinates"] = " ".join(beside)


def _write_attributes(file: h5py.File, plan: Plan, responses: PartStore, run: Run) -> None:
    from pounding_cli.store.expanded import is_long, study_key  # here: see `is_finished`

    kept = plan.workflow == "run" and is_long(plan.axes)
    file.attrs.update(
        {
            "format": FORMAT,
            "format_version": FORMAT_VERSION,
            **({} if plan.workflow == "run" else {"workflow": plan.workflow}),
            "title": plan.study.title,
            "swept": json.dumps([list(axis.names) for axis in plan.axes]),
            "content": content_digest(plan),
            **({"study_key": study_key(plan.study, plan.all_effects)} if kept else {}),
            "solution_key": key_of(plan),
            **({"accuracy": plan.accuracy, "method": plan.method} if plan.method else {}),
            **({} if plan.time_step is None else {"time_step": plan.time_step}),
            "scenes": len(plan.scenes),
            "scenes_failed": int((~responses.is_done(plan.scenes)).sum()),
            "scenes_solved_last": run.solved,
            "scenes_reused_last": run.reused,
            "solver_seconds": responses.seconds(plan.scenes),
            "wall_seconds_last": run.wall_seconds,
            "engine": run.engine,
            "workers": run.workers,
            "created": datetime.now(UTC).isoformat(timespec="seconds"),
        }
    )
    software = file.create_group("software")
    software.attrs.update(
        {
            "pounding_cli": package_version(),
            "solver": solver_version(),
            "python": platform.python_version(),
            "platform": platform.platform(),
            "machine": platform.machine(),
            "cores": os.cpu_count() or 0,
            **_versions(),
        }
    )


@functools.cache
def _versions() -> dict[str, str]:
    """Of the packages that results rest on."""
    return {name: metadata.version(name) for name in _SOFTWARE}


def _text(values) -> np.ndarray:
    return np.array([str(value) for value in values], dtype=object)


def _axis_values(values: list) -> np.ndarray:
    """Numbers stay numbers; an axis with any text is text."""
    numeric = all(isinstance(value, int | float) and not isinstance(value, bool) for value in values)
    return np.array(values, float) if numeric else _text(values)


def _json(value: object) -> str:
    return json.dumps(value, default=str, sort_keys=True)
