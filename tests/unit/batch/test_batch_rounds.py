"""A workflow that asks in rounds: what a round proposes follows from the responses of those before."""

from __future__ import annotations

import sys
from dataclasses import replace

import h5py
import numpy as np
import pytest

from pounding_cli.batch import run_plan
from pounding_cli.errors import InputError
from pounding_cli.store import open_results, write_results
from pounding_cli.store.answers import Column, Table
from pounding_cli.workflows import WORKFLOWS, Workflow
from tests.helpers.plans import known, small_plan

asked: list[int] = []


def refine(plan, responses):
    """Motions by name, one more a round, as long as the last one's floors move less than 1 cm."""
    peak = max(responses[row.scene].buildings[0].drift.max() for row in plan.rows if row.record == plan.records[-1])
    asked.append(len(plan.records))
    return three_motions(len(plan.records) + 1) if len(plan.records) < 3 and peak < 0.06 else None


def tables(plan, read, responses):
    number = np.arange(len(plan.records), dtype=float)
    largest = np.nanmax(read("drift"), axis=(0, 1, 3, 4))
    columns = [Column("number", number, "of the motion", "1"), Column("drift", largest, "largest", "m")]
    return [Table("test", [columns])]


def three_motions(count):
    return replace(small_plan(records=(("a", 1.0), ("b", 2.0), ("c", 3.0))[:count]), workflow="test")


@pytest.fixture
def workflow(monkeypatch):
    here = f"{__name__}:"
    own = Workflow(
        "test", "", shows=("test",), expand=f"{here}three_motions", refine=f"{here}refine", tables=f"{here}tables"
    )
    monkeypatch.setitem(WORKFLOWS, "test", own)
    asked.clear()


def test_rounds_go_on_until_nothing_is_left_to_ask(workflow, tmp_path):
    outcome = run_plan(three_motions(1), tmp_path / "r.h5", solve=known)
    assert asked == [1, 2, 3]
    assert outcome.done == len(three_motions(3).scenes)
    results = open_results(tmp_path / "r.h5")
    assert results.workflow == "test"
    assert results.records()["record"].tolist() == ["a", "b", "c"]
    assert results.table("test")["drift"].tolist() == results.storey().groupby("record")["drift"].max().tolist()


def test_a_second_run_solves_nothing_again(workflow, tmp_path):
    run_plan(three_motions(1), tmp_path / "r.h5", solve=known)
    before = h5py.File(tmp_path / "r.h5").attrs["content"]
    outcome = run_plan(three_motions(1), tmp_path / "r.h5", solve=known, replace=True)
    assert (outcome.done, outcome.reused) == (0, len(three_motions(3).scenes))
    assert h5py.File(tmp_path / "r.h5").attrs["content"] == before


def test_results_of_another_workflow_are_not_overwritten(workflow, tmp_path):
    path = tmp_path / "r.h5"
    plan = small_plan()
    write_results(path, plan, {digest: known(scene) for digest, scene in plan.scenes.items()})
    with pytest.raises(InputError, match="results of `pound run`"):
        run_plan(three_motions(1), path, solve=known)
    assert open_results(path).workflow == "run"


def test_a_table_that_a_file_lacks_is_asked_of_its_command(workflow, tmp_path):
    path = tmp_path / "r.h5"
    plan = small_plan()
    write_results(path, plan, {digest: known(scene) for digest, scene in plan.scenes.items()})
    with pytest.raises(InputError, match="has no table test"):
        open_results(path).table("test")


def test_columns_of_two_lengths_are_refused(workflow, tmp_path, monkeypatch):
    def uneven(plan, read, responses):
        return [Table("test", [[Column("a", np.zeros(2), "", "1"), Column("b", np.zeros(3), "", "1")]])]

    monkeypatch.setattr(sys.modules[__name__], "tables", uneven)
    run_plan(three_motions(1), tmp_path / "r.h5", solve=known)
    with pytest.raises(InputError, match="is not a column of its table"):
        open_results(tmp_path / "r.h5").table("test")


def test_codes_of_texts_that_are_not_there_are_refused(workflow, tmp_path, monkeypatch):
    """A file made to mislead: a code beyond the texts. Fails if it reaches numpy."""
    from pounding_cli.store import answers

    def named(*names):
        return [Column("name", np.array(names, object), "")]

    with h5py.File(tmp_path / "forged.h5", "w") as file:
        answers.write_tables(file, [Table("test", [named("a", "b"), named("a")])])
        assert answers.read_table(file, "test").frame["name"].tolist() == ["a", "b", "a"]
        file["answer/test/0"][1] = 7
        with pytest.raises(InputError, match="is not a column of texts"):
            answers.read_table(file, "test")
