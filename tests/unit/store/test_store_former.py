"""Whose results a file holds, and what may replace them."""

from __future__ import annotations

import shutil
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from pounding_cli.errors import InputError
from pounding_cli.store import check_results, write_results
from tests.helpers.plans import FakeStudy, known, small_plan
from tests.helpers.sealing import edited


@pytest.fixture
def project(tmp_path):
    """A folder with a study and its results."""
    return made(tmp_path / "project")


def made(folder: Path) -> Path:
    folder.mkdir()
    (folder / "my-study.yaml").write_text("title: two buildings\n")
    plan = small_plan(study=FakeStudy(path=folder / "my-study.yaml"))
    (folder / "results").mkdir()
    write_results(folder / "results" / "my-study.h5", plan, {d: known(s) for d, s in plan.scenes.items()})
    return folder


def check(folder: Path, study: str = "my-study.yaml", output: str = "results/my-study.h5", **options) -> None:
    facts = {name: options.pop(name) for name in ("title", "from_data") if name in options}
    check_results(folder / output, FakeStudy(path=folder / study, **facts), **options)


def test_the_same_file_is_the_same_study_whatever_it_says_by_now(project):
    check(project, title="another title")


def test_results_of_another_file_are_refused(project):
    (project / "other").mkdir()
    (project / "other" / "my-study.yaml").write_text("title: two buildings\n")
    with pytest.raises(InputError) as refused:
        check(project, "other/my-study.yaml")
    problem = refused.value.problems[0]
    assert problem.message == "the output holds another study: 'two buildings' (../my-study.yaml) with 16 scenes"
    assert "results/my-study-2.h5" in problem.hint
    assert "--replace" in problem.hint
    check(project, "other/my-study.yaml", replace=True)


def test_a_refusal_counts_the_histories_that_would_be_lost(project):
    with edited(project / "results" / "my-study.h5") as file:
        for number in range(3):
            file.create_group(f"histories/{number}")
    (project / "other.yaml").write_text("title: two buildings\n")
    with pytest.raises(InputError, match="with 16 scenes and 3 histories"):
        check(project, "other.yaml")


def test_a_project_that_moved_or_was_copied_keeps_its_results(project):
    shutil.copytree(project, project.with_name("copy"))
    check(project.with_name("copy"), title="changed since")
    project.rename(project.with_name("moved"))
    check(project.with_name("moved"), title="changed since")


def test_a_study_that_was_renamed_is_known_by_its_title(project):
    (project / "my-study.yaml").rename(project / "pair.yaml")
    check(project, "pair.yaml")
    with pytest.raises(InputError, match="another study"):
        check(project, "pair.yaml", title="no longer this")


def test_studies_that_are_python_data_are_known_by_their_titles(project):
    with pytest.raises(InputError, match="another study"):  # though the title is the same
        check(project, from_data=True)
    plan = small_plan(study=FakeStudy(path=project / "two-buildings.yaml", from_data=True))
    write_results(project / "data.h5", plan, {d: known(s) for d, s in plan.scenes.items()})
    check(project, output="data.h5", from_data=True)
    for options in ({"from_data": True, "title": "three"}, {}):
        with pytest.raises(InputError, match="another study"):
            check(project, output="data.h5", **options)


@pytest.mark.parametrize("kind", ["connector", "wall"])
def test_results_of_another_command_are_kept(project, kind):
    study = SimpleNamespace(path=project / "my-study.yaml", title="two buildings", text="")
    shutil.copy(project / "results" / "my-study.h5", project / "results" / "system.h5")
    with edited(project / "results" / "system.h5") as file:
        file.attrs["workflow"] = kind
    check_results(project / "results" / "system.h5", study, kind)
    with pytest.raises(InputError, match=f"the output holds results of `pound {kind}`"):
        check(project, output="results/system.h5")
    with pytest.raises(InputError, match="the output holds results of `pound run`"):
        check_results(project / "results" / "my-study.h5", study, kind)


def test_what_no_longer_tells_its_study_is_refused(project):
    path = project / "results" / "my-study.h5"
    whole = path.read_bytes()
    content = bytearray(whole)
    content[100] ^= 1
    path.write_bytes(content)
    with pytest.raises(InputError, match="damaged results whose study cannot be read"):
        check(project)
    check(project, replace=True)
    path.write_bytes(whole)
    with edited(path) as file:
        del file.attrs["study_file"]  # as former versions of the program wrote it
    check(project, "elsewhere.yaml")
    with pytest.raises(InputError, match="another study"):
        check(project, title="another title")


@pytest.mark.parametrize("name", ["x" * 10_000, "a\0b"])
def test_a_study_of_an_impossible_name_is_another_study(project, name):
    """What someone wrote into the file. Fails with an error of the operating system."""
    with edited(project / "results" / "my-study.h5") as file:
        file.attrs["study_file"] = np.bytes_(name)
    check(project)  # no such file, and the title is the study's: it was moved
    with pytest.raises(InputError, match="another study"):
        check(project, title="another title")
