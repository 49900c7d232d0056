"""What a long study came to is kept beside its results, and used only where it is of that very study."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from pounding_cli.batch import finished, run_plan
from pounding_cli.errors import InputError
from pounding_cli.outputs import EXPANDED
from pounding_cli.solve import solve as real_solve
from pounding_cli.store import expanded, open_results
from pounding_cli.store.expanded import expanded_plan, keep_expanded
from pounding_cli.store.files import opened
from pounding_cli.store.seal import BLOCK
from pounding_cli.study import load_study

STUDY = """\
records: {use: [elcentro], duration: 2 s}
buildings:
  stiff: {storeys: 3, period: 0.36 s}
  soft:  {like: stiff, period: 0.60 s}
group: [stiff, soft]
cases:
  gap: {link: pounding, gap: 2 cm}
  both: {link: [pounding, connector], gap: 1 cm}
sweep:
  impact.restitution: [0.4, 0.5]
  cases.gap.gap: [1 cm, 2 cm, 3 cm]
"""


@pytest.fixture
def kept(tmp_path, monkeypatch):
    """A study, its plan, and the folder that keeps it."""
    monkeypatch.setattr(expanded, "MANY", 6)
    study, folder = tmp_path / "study.yaml", tmp_path / "out.h5.parts"
    study.write_text(STUDY)
    plan = expanded.expand(load_study(study))
    keep_expanded(plan, folder)
    assert [path.name for path in folder.iterdir()] == [EXPANDED]
    return study, plan, folder


@pytest.fixture
def told(monkeypatch):
    """What each expansion was told to be known."""
    told, real = [], expanded.expand

    def expand(study, **known):
        told.append(bool(known))
        return real(study, **known)

    monkeypatch.setattr(expanded, "expand", expand)
    return told


def test_the_plan_comes_back_whole(kept, told):
    study, plan, folder = kept
    again = expanded_plan(load_study(study), folder)
    assert told == [True]
    assert again.rows == plan.rows
    assert list(again.scenes) == list(plan.scenes)
    assert all(scene.digest == digest for digest, scene in again.scenes.items())


@pytest.mark.parametrize(
    ("old", "new"), [("0.4, 0.5", "0.4, 0.6"), ("0.36 s", "0.37 s"), ("duration: 2 s", "duration: 3 s")]
)
def test_another_study_is_expanded(kept, told, old, new):
    """Fails if what was kept is taken for that of a study that has changed since."""
    study, _, folder = kept
    study.write_text(STUDY.replace(old, new))
    again = expanded_plan(load_study(study), folder)
    assert told == [False]
    assert all(scene.digest == digest for digest, scene in again.scenes.items())


def test_a_motion_that_changed_is_seen(kept, told, tmp_path):
    """The file of a motion, under the same name. Fails if the key of a study leaves its motions out."""
    study, _, folder = kept
    motion = tmp_path / "mine.csv"
    study.write_text(STUDY.replace("elcentro", "{file: mine.csv, unit: m/s2, dt: 0.02 s}"))
    motion.write_text("\n".join(f"{np.sin(n):.6f}" for n in range(200)))
    keep_expanded(expanded.expand(load_study(study)), folder)
    motion.write_text("\n".join(f"{np.cos(n):.6f}" for n in range(200)))
    told.clear()
    expanded_plan(load_study(study), folder)
    assert told == [False]


@pytest.mark.parametrize("damage", ["cut", "flipped", "other digests"])
def test_what_is_damaged_is_expanded(kept, told, damage, monkeypatch):
    study, plan, folder = kept
    path = folder / EXPANDED
    content = bytearray(path.read_bytes())
    if damage == "cut":
        path.write_bytes(content[: len(content) // 2])
    elif damage == "flipped":
        content[content.index(plan.rows.table.digests.tobytes()[:32])] ^= 1
        path.write_bytes(content)
    else:
        with np.load(path) as found:
            arrays = dict(found)
        arrays["digests"] = arrays["digests"][::-1]
        np.savez(path, **arrays)
    again = expanded_plan(load_study(study), folder)
    assert told[-1] is False
    assert again.rows == plan.rows


def can_be_opened(output):
    """Whether a file can be opened."""
    try:
        with opened(output):
            return True
    except InputError:
        return False


@pytest.fixture
def done(kept):
    """A study, and the results file that holds all its scenes."""
    study, plan, folder = kept
    output = folder.parent / "out.h5"
    run_plan(plan, output, engine_name="serial")
    return study, output


def test_a_file_that_holds_all_is_known_without_expanding(done, told):
    study, output = done
    told.clear()
    outcome = finished(load_study(study), "run", output)
    assert (outcome.done, outcome.reused, outcome.engine) == (0, open_results(output).attrs["scenes"], "none")
    assert told == []
    assert finished(load_study(study), "run", output, all_effects=True) is None


@pytest.mark.parametrize(
    ("old", "new"),
    [("0.4, 0.5", "0.4, 0.6"), ("0.36 s", "0.37 s"), ("duration: 2 s", "duration: 3 s"), ("group:", "# more\ngroup:")],
)
def test_a_file_of_another_study_is_not_current(done, old, new):
    """Fails if a stale file is called current; a comment is part of what the file says too."""
    study, output = done
    study.write_text(STUDY.replace(old, new))
    assert finished(load_study(study), "run", output) is None


def test_a_file_of_other_motions_is_not_current(kept, tmp_path):
    """The same study, the same name of the motion, another content."""
    study, _, _ = kept
    motion, output = tmp_path / "mine.csv", tmp_path / "mine.h5"
    study.write_text(STUDY.replace("elcentro", "{file: mine.csv, unit: m/s2, dt: 0.02 s}"))
    motion.write_text("\n".join(f"{np.sin(n):.6f}" for n in range(200)))
    run_plan(expanded.expand(load_study(study)), output, engine_name="serial")
    assert finished(load_study(study), "run", output)
    motion.write_text("\n".join(f"{np.cos(n):.6f}" for n in range(200)))
    assert finished(load_study(study), "run", output) is None


@pytest.mark.parametrize("what", ["solver", "damage", "failed", "gone"])
def test_a_file_that_is_not_whole_is_not_current(done, what, monkeypatch):
    """Of another solver, with a flipped bit, with a scene that failed, or not there."""
    study, output = done
    if what == "solver":
        monkeypatch.setattr(expanded, "solver_version", lambda solve="": "another")
    elif what == "damage":
        whole = output.read_bytes()
        for place in range(BLOCK // 2, len(whole), BLOCK):  # until a block that nobody reads to open the file
            output.write_bytes(whole[:place] + bytes([whole[place] ^ 1]) + whole[place + 1 :])
            if can_be_opened(output):
                break
    elif what == "failed":
        plan = expanded.expand(load_study(study))
        bad = next(iter(plan.scenes))

        def solve(scene, **settings):
            found = real_solve(scene, **settings)
            return dataclasses.replace(found, status="diverged") if scene.digest == bad else found

        run_plan(plan, output.with_name("bad.h5"), solve=solve, engine_name="serial")
        output = output.with_name("bad.h5")
    else:
        output.unlink()
    assert finished(load_study(study), "run", output) is None


def test_it_is_written_once(kept):
    _, plan, folder = kept
    before = (folder / EXPANDED).stat().st_mtime_ns
    keep_expanded(plan, folder)
    assert (folder / EXPANDED).stat().st_mtime_ns == before
