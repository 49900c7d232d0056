"""Running a plan: resuming, reusing, failing scenes, dying workers, being stopped."""

from __future__ import annotations

import errno
import gc
import multiprocessing
import os
import signal
import sys
import time
from dataclasses import replace

import h5py
import pytest

from pounding_cli.batch import run_plan
from pounding_cli.batch.attempt import Task
from pounding_cli.batch.processes import apart
from pounding_cli.errors import InputError
from pounding_cli.model.placed import Placed
from pounding_cli.store import PartStore, locked, open_results, solution_key
from tests.helpers.plans import Axis, FakeStudy, known, small_plan

TIMES = {"seconds"}
"""Columns that are never the same twice."""


class Counting:
    """`known`, counting its calls; stops where told. Buildings alone may be run again to answer for linked scenes."""

    def __init__(self, stop_after: int | None = None) -> None:
        self.calls = self.linked = 0
        self.stop_after = stop_after

    def __call__(self, scene, accuracy, method, **_):
        if self.calls == self.stop_after:
            raise KeyboardInterrupt
        self.calls += 1
        self.linked += bool(scene.links)
        return known(scene, accuracy, method)


def dies(scene, accuracy, method, **_):
    """Takes its process with it on the strongest linked inelastic scene at gap 0.05."""
    if scene.links and scene.links[0].gap == 0.05 and scene.motion.pga == 9.0 and scene.analysis == "inelastic":
        os._exit(3)
    return known(scene, accuracy, method)


def fails(scene, accuracy, method, **_):
    if scene.links and scene.links[0].gap == 0.05 and scene.motion.pga == 3.0:
        raise ZeroDivisionError("division by zero")
    if len(scene.buildings) == 1 and scene.motion.pga == 1.0 and scene.analysis == "elastic":
        response = known(scene, accuracy, method)
        return replace(response, status="event bound reached", advice="check the links")
    return known(scene, accuracy, method)


def slow(scene, accuracy, method, **_):
    time.sleep(0.02)
    return known(scene, accuracy, method)


class Interrupting:
    """Solves, but Ctrl-C comes in the parent once `after` scenes are back."""

    def __init__(self, after: int) -> None:
        self.after = after
        self.said: list[str] = []

    def start(self, total, reused, ahead=0): ...

    def step(self, done, failed):
        self.after -= done
        if self.after <= 0:
            raise KeyboardInterrupt

    def say(self, sentence):
        self.said.append(sentence)

    def compiled(self): ...

    def stop(self): ...


@pytest.fixture(autouse=True)
def _workers_pay(monkeypatch):
    """These studies take no time, and are given to workers all the same."""
    monkeypatch.setattr("pounding_cli.batch.runner.WORTH_WORKERS", 0.0)


@pytest.fixture
def plan():
    return small_plan(records=(("weak", 1.0), ("strong", 3.0), ("other", 9.0)))


@pytest.fixture
def output(tmp_path):
    return tmp_path / "results" / "r.h5"


def in_process(*arguments, **options):
    """Run serially: a solver that counts does so in its own process only."""
    return run_plan(*arguments, engine_name="serial", **options)


def tables(path):
    results = open_results(path)
    return {
        name: getattr(results, name)().drop(columns=TIMES, errors="ignore")
        for name in ("storey", "floor", "link", "scene", "summary", "records")
    }


def test_every_scene_is_solved_once_and_a_second_run_solves_none(plan, output):
    solve = Counting()
    outcome = in_process(plan, output, solve=solve)
    assert solve.calls == len(plan.scenes) == 2 * 2 * 3 + 2 * 2 * 3  # linked; alone, shared by the cases
    assert (outcome.done, outcome.failed, outcome.reused) == (24, 0, 0)
    stamp = output.stat().st_mtime_ns
    again = in_process(plan, output, solve=solve)
    assert solve.calls == 24
    assert (again.done, again.failed, again.reused) == (0, 0, 24)
    assert output.stat().st_mtime_ns == stamp
    assert [path.name for path in output.parent.iterdir()] == ["r.h5"]


@pytest.fixture
def spawned(monkeypatch):
    """Workers are started as on macOS and Windows: by asking for it. Returns the methods they were started by."""
    found, context = [], multiprocessing.get_context
    monkeypatch.setattr(multiprocessing, "get_context", lambda method=None: (found.append(method), context(method))[1])
    before = multiprocessing.get_start_method(allow_none=True)
    multiprocessing.set_start_method("spawn", force=True)
    yield found
    multiprocessing.set_start_method(before, force=True)


def test_spawned_workers_give_the_same_rows(plan, tmp_path, spawned):
    """They inherit nothing: scenes and solver are sent. Fails if one of them cannot be."""
    run_plan(plan, tmp_path / "s.h5", solve=known, engine_name="serial")
    run_plan(plan, tmp_path / "p.h5", solve=known, workers=2, engine_name="processes")
    assert spawned == ["spawn"]
    one, other = tables(tmp_path / "s.h5"), tables(tmp_path / "p.h5")
    for name in one:
        assert one[name].equals(other[name]), name


def test_a_spawned_worker_that_dies_costs_one_scene(plan, output, spawned):
    outcome = run_plan(plan, output, solve=dies, workers=2)
    assert (outcome.done, outcome.failed) == (23, 1)
    assert [failure.status for failure in outcome.failures] == ["the worker died"]
    assert spawned == ["spawn"]


@pytest.mark.parametrize("name", ["processes", "threads"])
def test_every_engine_gives_the_same_rows_bit_for_bit(plan, tmp_path, name):
    serial = run_plan(plan, tmp_path / "s.h5", solve=known, engine_name="serial")
    side = run_plan(plan, tmp_path / "p.h5", solve=known, workers=2, engine_name=name)
    assert (serial.engine, side.engine, side.workers) == ("serial", name, 2)
    one, other = tables(tmp_path / "s.h5"), tables(tmp_path / "p.h5")
    for name in one:
        assert one[name].equals(other[name]), name
    with h5py.File(tmp_path / "s.h5") as a, h5py.File(tmp_path / "p.h5") as b:
        assert a["V"][()].tobytes() == b["V"][()].tobytes()
        assert (a["solutions/digest"][:] == b["solutions/digest"][:]).all()


class OfThisProcess(Placed):
    """Scenes whose digests only the process that made them may look up."""

    def __init__(self, scenes):
        self.scenes, self.process = list(scenes.items()), os.getpid()

    def place(self, digest):
        assert os.getpid() == self.process
        return [key for key, _ in self.scenes].index(digest)

    def at(self, place):
        return self.scenes[place][1]

    def __iter__(self):
        return (key for key, _ in self.scenes)

    def __len__(self):
        return len(self.scenes)


@pytest.mark.skipif(sys.platform != "linux", reason="workers are forked on Linux alone")
def test_forked_workers_look_up_no_digest(plan, output):
    """Fails if they do: each page of the parent's memory in which a digest stands would be copied."""
    plan = replace(plan, scenes=OfThisProcess(plan.scenes))
    outcome = run_plan(plan, output, solve=known, workers=2)
    assert (outcome.done, outcome.failed, outcome.engine) == (24, 0, "processes")


@pytest.mark.skipif(sys.platform != "linux", reason="forks")
@pytest.mark.parametrize(
    ("name", "is_long", "forks"), [("processes", True, True), ("processes", False, False), ("serial", True, False)]
)
def test_a_long_study_compiles_in_a_process_that_ends(plan, output, tmp_path, monkeypatch, name, is_long, forks):
    """Two scenes of each sort are solved before the others: the first ones there too. Fails if what the compiler leaves
    stays in this process, or if processes are forked where another engine was asked for."""
    seen = tmp_path / "seen"

    def sees(self, scene):
        with seen.open("a") as stream:
            print(os.getpid(), scene.digest, file=stream)
        return known(scene)

    monkeypatch.setattr("pounding_cli.batch.runner.is_long", lambda axes: is_long)
    monkeypatch.setattr(Task, "__call__", sees)
    monkeypatch.setattr(Task, "each", lambda self, scenes, begins, halted: list(map(known, scenes)))
    run_plan(plan, output, engine_name=name, workers=1)
    lines = [line.split() for line in seen.read_text().splitlines()]
    here = [digest for process, digest in lines if int(process) == os.getpid()]
    others = [digest for process, digest in lines if int(process) != os.getpid()]
    assert others == (here[:6] if forks else [])  # touching, gap, alone; elastic, inelastic


@pytest.mark.skipif(sys.platform != "linux", reason="forks")
def test_work_apart_that_fails_is_left_to_this_process(capfd):
    for work in (lambda: 1 / 0, lambda: os.kill(os.getpid(), signal.SIGKILL)):
        apart(work)
    assert capfd.readouterr() == ("", "")


def test_small_studies_stay_in_this_process_and_off_the_disk(plan, output, monkeypatch):
    monkeypatch.setattr("pounding_cli.batch.runner.WORTH_WORKERS", 1.0)
    monkeypatch.setattr(PartStore, "_write", lambda *_: 1 / 0)
    assert run_plan(plan, output, solve=known, workers=4).engine == "serial"


def test_a_changed_study_reuses_the_scenes_it_shares(plan, output):
    run_plan(plan, output, solve=known)
    wider = small_plan(
        records=(("weak", 1.0), ("strong", 3.0), ("other", 9.0)),
        cases=(("touching", 0.0), ("gap", 0.05), ("wide", 0.10)),
        study=FakeStudy(text="with a wider gap"),
    )
    solve = Counting()
    told = Interrupting(after=1000)
    outcome = in_process(wider, output, solve=solve, progress=told)
    assert "kept are touching 6 of 6, buildings alone 12 of 12, gap 6 of 6, wide 0 of 6" in told.said[0]
    assert (outcome.done, outcome.reused, solve.linked) == (6, 24, 6)
    assert open_results(output).study_text == "with a wider gap"
    fresh = output.with_name("fresh.h5")
    run_plan(wider, fresh, solve=known)
    one, other = tables(output), tables(fresh)
    for name in one:
        assert one[name].equals(other[name]), name


def test_only_the_words_changed_nothing_is_solved_but_the_file_says_so(plan, output):
    run_plan(plan, output, solve=known)
    solve = Counting()
    renamed = replace(plan, study=replace(plan.study, title="renamed"))
    assert in_process(renamed, output, solve=solve).reused == 24
    assert solve.calls == 0
    assert open_results(output).title == "renamed"


@pytest.mark.parametrize("change", [{"accuracy": 1e-9}, {"method": "central-difference", "time_step": 1e-3}])
def test_another_accuracy_or_method_solves_everything_anew(plan, output, change):
    run_plan(plan, output, solve=known)
    solve = Counting()
    outcome = in_process(replace(plan, **change), output, solve=solve)
    assert (outcome.done, outcome.reused, solve.calls) == (24, 0, 24)


def test_another_solver_solves_everything_anew(plan, output, monkeypatch):
    run_plan(plan, output, solve=known)
    monkeypatch.setattr("pounding_cli.store.keys.solver_version", lambda: "0.2.0+something")
    told = Interrupting(after=1000)
    assert run_plan(plan, output, solve=known, progress=told).reused == 0
    assert "was made with solver" in told.said[0]
    assert "0.2.0+something" in told.said[0]


def test_a_failed_scene_is_reported_and_the_others_go_on(plan, output):
    outcome = run_plan(plan, output, solve=fails)
    # linked at a gap with the strong motion, elastic and inelastic; both buildings alone under the weak one
    assert (outcome.done, outcome.failed) == (20, 4)
    places = {failure.place: failure.status for failure in outcome.failures}
    assert places["gap, elastic, strong"] == "error: ZeroDivisionError: division by zero"
    assert places["stiff alone, elastic, weak"] == "event bound reached"
    assert len(places) == 4
    results = open_results(output)
    scene = results.scene().set_index(["case", "analysis", "record"])
    assert scene.loc[("gap", "inelastic", "strong"), "status"].startswith("error: ZeroDivisionError")
    flags = scene.loc[("touching", "elastic", "weak"), "flags"]
    assert "stiff alone: event bound reached, ratios refused" in flags
    storey = results.storey().set_index(["case", "analysis", "record"])
    assert storey.loc[("gap", "inelastic", "strong"), "V"].isna().all()
    assert storey.loc[("gap", "inelastic", "strong"), "V0"].notna().all()
    assert storey.loc[("touching", "elastic", "strong"), "V_ratio"].eq(1.5).all()


def test_failed_scenes_and_only_they_are_tried_again(plan, output):
    run_plan(plan, output, solve=fails)
    solve = Counting()
    outcome = in_process(plan, output, solve=solve)
    assert (outcome.done, outcome.failed, outcome.reused, solve.linked) == (4, 0, 20, 2)


def test_a_baseline_that_failed_has_no_ratio(plan, output):
    """The numbers of a scene that did not end are not to be trusted, whatever they are."""
    run_plan(plan, output, solve=fails)
    storey = open_results(output).storey()
    hit = (storey.record == "weak") & (storey.analysis == "elastic")
    assert storey[hit].V_ratio.isna().all()
    assert storey[hit].V0.isna().all()


@pytest.mark.parametrize("seconds", [1e-9, 60.0])  # one scene a bundle; as many as there are
def test_a_worker_that_dies_costs_one_scene(plan, output, monkeypatch, seconds):
    monkeypatch.setattr("pounding_cli.batch.bundles.CHUNK_SECONDS", seconds)
    outcome = run_plan(plan, output, solve=dies, workers=2)
    assert (outcome.done, outcome.failed) == (23, 1)
    assert outcome.failures[0].place == "gap, inelastic, other"
    assert outcome.failures[0].status == "the worker died"
    assert "fewer workers" in outcome.failures[0].advice


@pytest.mark.skipif(not hasattr(os, "waitid"), reason="a stopped process cannot be told here")
def test_a_worker_that_is_stopped_is_replaced(plan, output, tmp_path, monkeypatch):
    """Fails, by waiting for ever, where nobody looks at workers that say nothing."""
    monkeypatch.setattr("pounding_cli.batch.processes._STOPPED", 0.3)
    monkeypatch.setattr("pounding_cli.batch.processes._LOOK", 0.05)
    monkeypatch.setattr("pounding_cli.batch.runner.WORTH_WORKERS", 0.0)
    parent, mark = os.getpid(), tmp_path / "stopped"

    def stopped(scene, accuracy, method, **_):
        if os.getpid() != parent and not mark.exists():
            mark.touch()
            os.kill(os.getpid(), signal.SIGSTOP)
        return known(scene, accuracy, method)

    outcome = run_plan(plan, output, solve=stopped, workers=2)
    assert mark.exists()
    assert outcome.failed == 0
    assert (open_results(output).scene().status == "done").all()


def test_a_worker_killed_once_from_outside_costs_nothing(plan, output, tmp_path):
    """What else is on the machine may take a worker's memory, or its life."""
    once = tmp_path / "once"

    def killed(scene, accuracy, method, **_):
        if scene.links and scene.links[0].gap == 0.05 and scene.motion.pga == 9.0 and not once.exists():
            once.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return known(scene, accuracy, method)

    outcome = run_plan(plan, output, solve=killed, workers=2)
    assert once.exists()
    assert (outcome.done, outcome.failed) == (24, 0)


def in_parts(plan, output) -> int:
    """How many scenes the parts hold."""
    parts = PartStore(output, solution_key(plan.accuracy, plan.method))
    assert parts.load() == []
    return len(parts)


def test_stopped_then_run_again_goes_on_where_it_was(plan, output):
    with pytest.raises(KeyboardInterrupt):
        in_process(plan, output, solve=Counting(stop_after=10))
    assert not output.exists()
    assert in_parts(plan, output) == 10
    solve = Counting()
    outcome = in_process(plan, output, solve=solve)
    assert (outcome.done, outcome.reused, solve.calls) == (14, 10, 14)
    assert not output.with_name("r.h5.parts").exists()


def test_stopped_with_workers_at_work_ends_them_and_keeps_the_scenes(plan, output):
    progress = Interrupting(after=12)
    begin = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        run_plan(plan, output, solve=slow, workers=2, progress=progress)
    assert time.monotonic() - begin < 5
    kept = in_parts(plan, output)
    assert 12 <= kept < 24
    assert progress.said == [f"{kept} of 24 scenes kept in {output}.parts"]
    assert run_plan(plan, output, solve=known).reused == kept


def test_refused_outputs_are_refused_before_anything_is_solved(plan, tmp_path):
    solve = Counting()
    (tmp_path / "notes.txt").write_text("mine")
    h5py.File(tmp_path / "other.h5", "w").close()
    for output, message in (
        (tmp_path, "the output is a folder"),
        (tmp_path / "notes.txt", "was not written by this command"),
        (tmp_path / "other.h5", "was not written by this command"),
        (tmp_path / "notes.txt" / "r.h5", "cannot be written"),
    ):
        with pytest.raises(InputError, match=message) as refused:
            in_process(plan, output, solve=solve)
        assert refused.value.problems[0].hint
    assert solve.calls == 0
    assert (tmp_path / "notes.txt").read_text() == "mine"


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"engine_name": "gpu"}, "there is no engine 'gpu'"),
        ({"workers": -1}, "-1 is not a number of workers"),
        ({"scheduler": "tcp://node:8786"}, "no scheduler for the engine 'processes'"),
    ],
)
def test_unknown_engine_and_workers_are_refused(plan, output, options, message):
    with pytest.raises(InputError, match=message):
        run_plan(plan, output, solve=known, **options)


@pytest.fixture
def small_files():
    """No file may grow beyond so many bytes: a disk that is full at a moment of one's choice."""
    resource = pytest.importorskip("resource")
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    yield lambda size: resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_no_room_for_the_results_keeps_the_scenes_and_the_former_file(plan, output, small_files):
    run_plan(small_plan(), output, solve=known)
    before = output.read_bytes()
    small_files(30_000)
    with pytest.raises(InputError, match="there is no space left") as refused:
        in_process(plan, output, solve=known)
    assert "what was solved is kept" in refused.value.problems[0].hint
    assert output.read_bytes() == before
    assert sorted(path.name for path in output.parent.iterdir()) == ["r.h5", "r.h5.parts"]
    small_files(1 << 30)
    again = in_process(plan, output, solve=known)
    assert (again.done, again.reused) == (0, 24)
    assert [path.name for path in output.parent.iterdir()] == ["r.h5"]


def test_no_room_for_a_part_stops_the_run_and_leaves_no_half_of_it(plan, output, small_files):
    small_files(500)
    with pytest.raises(InputError, match="there is no space left"):
        run_plan(plan, output, solve=known, workers=2)
    assert [path.name for path in output.parent.iterdir()] == ["r.h5.parts"]
    assert list(output.with_name("r.h5.parts").iterdir()) == []
    small_files(1 << 30)
    assert run_plan(plan, output, solve=known).done == 24


def test_a_read_only_folder_is_refused_before_anything_is_solved(plan, output, monkeypatch):
    """Whatever user the tests run as."""

    def refuse(dir):
        raise OSError(errno.EROFS, "Read-only file system", str(dir))

    monkeypatch.setattr("tempfile.TemporaryFile", refuse)
    solve = Counting()
    with pytest.raises(InputError, match="Read-only file system"):
        in_process(plan, output, solve=solve)
    assert solve.calls == 0


def test_what_a_run_left_that_was_killed_at_its_very_end_goes_with_the_next(plan, output):
    run_plan(plan, output, solve=known)
    output.with_name("r.h5.parts").mkdir()
    output.with_name(".r.h5.lock").touch()
    assert run_plan(plan, output, solve=known).reused == 24
    assert [path.name for path in output.parent.iterdir()] == ["r.h5"]


def test_two_runs_on_one_file(plan, output):
    output.parent.mkdir()
    with locked(output), pytest.raises(InputError, match="another run is using this file"):
        run_plan(plan, output, solve=known)
    assert run_plan(plan, output, solve=known).done == 24


def test_bundles_that_come_after_a_death_are_solved_too(output):
    """More scenes than are handed out at once: the rest goes to new workers."""
    plan = small_plan(records=tuple((f"r{number}", float(number)) for number in range(1, 16)))
    outcome = run_plan(plan, output, solve=dies, workers=2)
    assert (outcome.done, outcome.failed) == (len(plan.scenes) - 1, 1)


def test_a_place_of_a_swept_study_names_its_point(output):
    axis = Axis(("impact.damping_ratio",), ((0.1,), (0.2,)))
    plan = small_plan(axes=(axis,))
    outcome = run_plan(plan, output, solve=fails)
    assert "impact.damping_ratio = 0.2, gap, elastic, strong" in {f.place for f in outcome.failures}


@pytest.mark.parametrize("before", [False, True])
def test_garbage_of_before_is_looked_for_again_after_a_run(before, tmp_path):
    """During a run it is not; what the caller had set aside stays aside."""
    seen = []

    def solve(*asked, **settings):
        seen.append(gc.get_freeze_count())
        return known(*asked, **settings)

    gc.unfreeze()  # commands that ran in this process have set aside what they loaded
    try:
        if before:
            gc.freeze()
        run_plan(small_plan(), tmp_path / "r.h5", solve=solve, workers=1)
        assert (gc.get_freeze_count() > 0) is before
    finally:
        gc.unfreeze()
    assert seen[-1] > 10_000
