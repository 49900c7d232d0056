"""Studies as dicts: the same as their files, and refused at their keys."""

from __future__ import annotations

import copy

import numpy as np
import pytest

import pounding_cli
from pounding_cli.errors import InputError
from pounding_cli.study import expand, load_study, study_of

DATA = {
    "title": "From a dict",
    "records": {"use": ["elcentro"], "duration": 3},
    "buildings": {"stiff": {"storeys": 2, "period": "0.2 s"}, "soft": {"like": "stiff", "period": 0.4}},
    "group": ("stiff", "soft"),
    "cases": {"gap": {"link": "pounding", "gap": np.float64(0.02)}, "none": {"link": "none"}},
    "analyses": ["inelastic"],
    "sweep": {"cases.gap.gap": np.array([0.01, 0.03]), "impact.restitution": [0.5, "40 %"]},
    "keep": {"histories": {"where": {"cases.gap.gap": "3 cm"}}},
}
YAML = """\
title: From a dict
records: {use: [elcentro], duration: 3 s}
buildings: {stiff: {storeys: 2, period: 0.2 s}, soft: {like: stiff, period: 0.4 s}}
group: [stiff, soft]
cases: {gap: {link: pounding, gap: 2 cm}, none: {link: none}}
analyses: [inelastic]
sweep: {cases.gap.gap: [1 cm, 3 cm], impact.restitution: [0.5, 0.4]}
keep: {histories: {where: {cases.gap.gap: 3 cm}}}
"""


def test_a_dict_is_the_same_study_as_its_file(tmp_path):
    (tmp_path / "study.yaml").write_text(YAML)
    ours, theirs = expand(study_of(DATA)), expand(load_study(tmp_path / "study.yaml"))
    assert [(r.point, r.case, r.scene, r.baselines) for r in ours.rows] == [
        (r.point, r.case, r.scene, r.baselines) for r in theirs.rows
    ]
    assert [row.point for row in ours.kept] == [row.point for row in theirs.kept]
    assert [(axis.names, axis.values) for axis in ours.axes] == [(axis.names, axis.values) for axis in theirs.axes]
    assert (ours.axes[0].shown(0), theirs.axes[0].shown(0)) == (("0.01 m",), ("1 cm",))


def test_its_text_is_a_study_file(tmp_path):
    study = study_of(DATA)
    assert str(study.path) == "from-a-dict.yaml"
    (tmp_path / "again.yaml").write_text(study.text)
    assert load_study(tmp_path / "again.yaml").resolved() == study.resolved()


def test_the_dict_is_left_alone():
    before = copy.deepcopy(DATA)
    study_of(DATA)
    assert repr(before) == repr(DATA)


@pytest.mark.parametrize(
    ("path", "value", "place", "message"),
    [
        (("cases", "gap", "gap"), -0.01, "cases.gap.gap", "the gap is -0.01 m"),
        (("cases", "gap", "gaap"), 0.01, "cases.gap.gaap", "unknown key 'gaap'"),
        (("buildings", "soft", "period"), "5 cm", "buildings.soft.period", "'5 cm' is no period"),
        (("records", "use"), ["elcentro", "tuft"], "records.use.1", "no motion 'tuft'"),
        (("group",), ["stiff", "sofft"], "group.1", "no building 'sofft'"),
        (("sweep", "cases.gap.gap"), [0.01, -0.02], "sweep.cases.gap.gap.1", "the gap is -0.02 m"),
        (("records", "use"), [object()], "records.use.0", "object is not a value of a study"),
    ],
)
def test_what_is_wrong_is_told_at_its_key(path, value, place, message):
    data = copy.deepcopy(DATA)
    data.pop("keep")
    inner = data
    for key in path[:-1]:
        inner = inner[key]
    inner[path[-1]] = value
    with pytest.raises(InputError) as refused:
        study_of(data)
    (problem,) = refused.value.problems
    assert problem.file == place
    assert message in problem.message
    assert problem.hint
    assert str(problem).startswith(f"{place}: ")


def test_run_and_load_take_it(tmp_path):
    data = {name: value for name, value in DATA.items() if name not in ("sweep", "keep")}
    assert pounding_cli.load_study(data).title == "From a dict"
    results = pounding_cli.run(data, tmp_path / "r.h5", engine="serial")
    assert (results.scene().status == "done").all()
    assert results.title == "From a dict"
