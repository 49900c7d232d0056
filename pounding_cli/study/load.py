"""Load a study: from a file, or from its text and tree, with everything that is wrong or doubtful about it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from pounding_cli.reading import shorten_path
from pounding_cli.study.check.warnings import find_warnings
from pounding_cli.study.construct.motions import MotionReader
from pounding_cli.study.construct.resolve import tree_at
from pounding_cli.study.construct.validate import validate_tree
from pounding_cli.study.schema.study import StudySpec
from pounding_cli.study.study import Study
from pounding_cli.study.text.file import Map, Problems, read_study, refuse_other_kinds
from pounding_cli.study.vary.axes import read_axes, with_middles
from pounding_cli.study.vary.both_sides import with_both_sides
from pounding_cli.study.vary.changes import Change, apply_changes


def load_study_file(
    path: str | Path, model: type[StudySpec] = StudySpec, changes: Sequence[Change] = ()
) -> Study:  # fmt: skip
    """Read and validate a study file.

    model : of the study, with the sections of questions (`add_sections`)
    changes : values in place of those of the file

    Raises
    ------
    InputError : with every problem found in it, each with file, line, column, message and hint
    """
    path = Path(path)
    return build_study(path, *read_study(path), model, changes)


def build_study(
    path: Path,
    text: str,
    tree: Map,
    model: type[StudySpec],
    changes: Sequence[Change] = (),
    reader: MotionReader | None = None,
) -> Study:
    """Return a validated study.

    text : as written
    tree : what it holds
    changes : values in place of those there
    reader : of the motions, where several studies of one folder have the same ones

    Raises
    ------
    InputError : as `load_study_file`
    """
    file = shorten_path(path)
    refuse_other_kinds(tree, file)
    if changes:
        text, tree = apply_changes(text, tree, changes, file, model)
    reader = MotionReader(path.resolve().parent) if reader is None else reader
    problems = Problems(file)
    tree = with_middles(with_both_sides(tree, problems), problems)
    axes = read_axes(tree, problems)
    from_data = isinstance(tree.mark[0], str)
    spec, parts = validate_tree(tree, axes, reader, file, model, problems)
    first = tree_at(tree, axes, (0,) * len(axes))
    title = spec.title or shorten_path(path.stem)
    study = Study(
        path, text, title, tree, axes, spec, parts, first, (), from_data, reader, tuple(changes)
    )  # fmt: skip
    return replace(study, warnings=find_warnings(study))
