"""The registry of workflows: every part it names is there, and every workflow has its command."""

from __future__ import annotations

from dataclasses import fields

import pytest

from pounding_cli.cli.main import COMMANDS
from pounding_cli.variables import POINTS
from pounding_cli.workflows import WORKFLOWS

PARTS = tuple(f.name for f in fields(WORKFLOWS["run"]) if f.name not in ("name", "title", "marks", "shows", "sampled"))


@pytest.mark.parametrize("workflow", WORKFLOWS.values(), ids=str)
def test_every_part_is_there(workflow):
    for name in PARTS:
        found = workflow.part(name)
        assert found if getattr(workflow, name) else found is None


@pytest.mark.parametrize("workflow", WORKFLOWS.values(), ids=str)
def test_a_model_of_its_own_says_what_its_points_have(workflow):
    assert bool(workflow.solve) == bool(workflow.variables)
    names = [variable.name for variable in workflow.part("variables") or ()]
    assert len(set(names)) == len(names)
    assert not {variable.name for variable in POINTS} & set(names)


@pytest.mark.parametrize("workflow", WORKFLOWS.values(), ids=str)
def test_a_workflow_is_a_command_with_its_title(workflow):
    assert COMMANDS[workflow.name][1] == workflow.title


def test_marks_tell_workflows_apart():
    marks = [mark for workflow in WORKFLOWS.values() for mark in workflow.marks]
    assert len(set(marks)) == len(marks)
