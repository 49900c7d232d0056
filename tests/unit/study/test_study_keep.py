"""`keep: histories`: which rows it means, and what of it is refused."""

from __future__ import annotations

import pytest

from pounding_cli.errors import InputError
from pounding_cli.study import expand

TWO = ("  gap: {link: pounding, gap: 5 cm}", "  gap: {link: pounding, gap: 5 cm}\n  near: {link: pounding, gap: 0 cm}")
SWEEP = ("[elastic]", "[elastic, inelastic]\nsweep: {cases.gap.gap: [1 cm, 2 cm], records.scale: [1, 1.5]}")


def keeping(said: str) -> tuple[str, str]:
    return "title: Test\n", f"title: Test\nkeep: {said}\n"


def kept(study, said: str) -> list[tuple]:
    plan = expand(study(TWO, SWEEP, keeping(said)))
    return [(row.point, row.case, row.analysis, row.record) for row in plan.kept]


def test_nothing_is_kept_unless_asked_for(study):
    assert expand(study()).kept == ()


@pytest.mark.parametrize("said", ["histories", "{histories: all}", "{histories: {}}", "{histories: {every: 4 ms}}"])
def test_all_rows(study, said):
    plan = expand(study(TWO, SWEEP, keeping(said)))
    assert len(plan.kept) == 4 * 2 * 2 * 2
    assert list(plan.kept) == list(plan.rows)
    assert plan.every == (0.004 if "4 ms" in said else 0.002)


def test_chosen_rows(study):
    found = kept(study, "{histories: {cases: [near], analyses: [inelastic], records: [taft]}}")
    assert found == [((i, j), "near", "inelastic", "taft") for i in (0, 1) for j in (0, 1)]


@pytest.mark.parametrize("value", ["0.02", "2 cm", "20 mm", "[2 cm]"])
def test_chosen_points_of_the_sweep(study, value):
    """In the words of the sweep or in any other unit."""
    found = kept(study, f"{{histories: {{cases: [gap], records: [taft], where: {{cases.gap.gap: {value}}}}}}}")
    assert [point for point, *_ in found] == [(1, 0), (1, 0), (1, 1), (1, 1)]


def test_several_swept_keys_and_values(study):
    found = kept(study, "{histories: {where: {cases.gap.gap: [1 cm, 2 cm], records.scale: 1.5}}}")
    assert {point for point, *_ in found} == {(0, 1), (1, 1)}


def test_keys_that_move_together_are_chosen_by_each(study):
    sweep = ("[elastic]", "[elastic]\nsweep: [{cases.gap.gap: [1 cm, 1 cm, 2 cm], records.scale: [1, 2, 2]}]")
    plan = expand(study(sweep, keeping("{histories: {where: {cases.gap.gap: 1 cm, records.scale: 2}}}")))
    assert {row.point for row in plan.kept} == {(1,)}


REFUSED = {
    "unknown word": ("§history", "'history' is not known", "'histories'"),
    "unknown key": ("{histories: {§case: [gap]}}", "unknown key 'case'", "'cases'"),
    "unknown case": ("{histories: {cases: [gap, §far]}}", "no case 'far'", "gap, near"),
    "unknown record": ("{histories: {records: [§tuft]}}", "no record 'tuft'", "did you mean 'taft'"),
    "analysis of no use": ("{histories: {analyses: [§plastic]}}", "'plastic' is not known", "elastic"),
    "no axis": ("{histories: {where: {§impact.restitution: 0.5}}}", "is not an axis of the sweep", "cases.gap.gap"),
    "no such value": ("{histories: {where: {cases.gap.gap: [1 cm, §3 cm]}}}", "has no value 3 cm", "1 cm, 2 cm"),
    "no step": ("{histories: {every: §0}}", "output step is 0 s", "e.g. 2 ms"),
    "step of another kind": ("{histories: {every: §2 mm}}", "is no output step: expected s", "an output step [s]"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refused_keep(name, refused):
    said, message, hint = REFUSED[name]
    refused(TWO, SWEEP, keeping(said), message=message, hint=hint, alone="analysis" not in name)


def test_methods_without_histories_are_refused(refused):
    step = ("[elastic]", "[elastic]\nmethod: newmark\ntime_step: 1 ms")
    old, new = keeping("histories")
    refused(step, (old, new.replace("keep", "§keep")), message="newmark keeps no histories", hint="method: auto")


def test_more_than_two_gigabytes_are_refused_before_anything_runs(study):
    """32 scenes of 5 s at 1e5 times a second: 39 series of 4 bytes, the time of 8."""
    with pytest.raises(InputError) as caught:
        expand(study(TWO, SWEEP, keeping("{histories: {every: 1e-5}}")))
    (problem,) = caught.value.problems
    size = 32 * 5 / 1e-5 * (4 * (8 + 2 * (4 * 3 + 2) + 3) + 8) / 1e9
    assert f"32 scenes every 0.01 ms take about {size:.3g} GB; the most is 2 GB" in problem.message
    assert "where" in problem.hint
    assert "every: 0.014 ms" in problem.hint
    assert (problem.line, problem.column) == (2, 1)
    assert len(expand(study(TWO, SWEEP, keeping("{histories: {every: 0.014 ms}}"))).kept) == 32
