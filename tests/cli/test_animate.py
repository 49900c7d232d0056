"""`pound animate`: films from results that keep histories and from studies, and what is refused."""

from __future__ import annotations

import builtins
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image

from pounding_cli import open_results, run
from pounding_cli.cli.main import cli
from pounding_cli.errors import InputError

STUDY = """\
title: Film
records: {use: [elcentro], duration: 3 s}
buildings:
  stiff: {storeys: 2, period: 0.2 s}
  soft: {like: stiff, period: 0.4 s}
group: [stiff, soft]
cases:
  touching: {link: pounding, gap: 0 cm}
  connected: {link: connector, gap: 5 cm}
analyses: [elastic]
estimate: none
sweep: {impact.restitution: [0.4, 0.6]}
keep: {histories: {cases: [touching], every: 4 ms}}
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("films")
    (folder / "film.yaml").write_text(STUDY)
    run(folder / "film.yaml", folder / "film.h5", engine="serial")
    return folder


def animate(folder: Path, *arguments: str):
    return CliRunner().invoke(cli, ["animate", *(word.replace("DIR", str(folder)) for word in arguments)])


def test_a_gif_from_results(folder):
    shown = animate(
        folder, "DIR/film.h5", "--at", "impact.restitution=0.6", "--from", "1 s", "--to", "1.5", "--slow", "2",
        "--rate", "10", "-o", "DIR/film.gif",
    )  # fmt: skip
    assert shown.exit_code == 0, shown.output
    assert "11 frames, 1.1 s" in shown.output
    film = Image.open(folder / "film.gif")
    assert (film.n_frames, film.info["duration"]) == (11, 100)
    pictures = []
    for number in range(film.n_frames):
        film.seek(number)
        pictures.append(np.asarray(film.convert("RGB")))
    assert all((one != other).any() for one, other in pairwise(pictures))


def test_an_mp4_from_a_study_that_does_not_keep_the_scene(folder):
    imageio_ffmpeg = pytest.importorskip("imageio_ffmpeg")
    shown = animate(
        folder, "DIR/film.yaml", "--case", "connected", "--at", "impact.restitution=40 %", "--to", "0.4", "--scale",
        "10", "-o", "DIR/film.mp4",
    )  # fmt: skip
    assert shown.exit_code == 0, shown.output
    assert "41 frames" in shown.output
    assert "gaps × 10, 4 times slower" in shown.output
    reader = imageio_ffmpeg.read_frames(str(folder / "film.mp4"))
    facts = next(reader)
    assert facts["fps"] == 25
    assert len(list(reader)) == 41


def test_results_and_study_give_the_same_picture(folder):
    for source, target in (("film.h5", "one.png"), ("film.yaml", "other.png")):
        shown = animate(
            folder, f"DIR/{source}", "--case", "touching", "--at", "impact.restitution=0.4", "--from", "1.4", "-o",
            f"DIR/{target}",
        )  # fmt: skip
        assert shown.exit_code == 0, shown.output
    one, other = (np.asarray(Image.open(folder / name).convert("L"), float) for name in ("one.png", "other.png"))
    assert one.shape == other.shape
    assert (np.abs(one - other) > 32).mean() < 1e-4  # 32-bit numbers may move an edge by a hair
    assert (one < 128).mean() > 0.005


def test_the_default_name_says_the_scene(folder, monkeypatch):
    monkeypatch.chdir(folder)
    shown = animate(folder, "film.h5", "--at", "impact.restitution=0.4", "--to", "0.1", "-q")
    assert (shown.exit_code, shown.output) == (0, "")
    assert (folder / "film-touching-elastic-elcentro.gif").exists()


ONE = ("DIR/film.yaml", "--at", "impact.restitution=0.4", "--case", "touching")

REFUSED = {
    "two scenes": (["DIR/film.h5"], "keeps 2 histories", "impact.restitution = 0.6"),
    "not kept": (["DIR/film.h5", "--case", "connected"], "keeps no history of case connected", "pound animate STUDY"),
    "two scenes of a study": (["DIR/film.yaml", "--case", "touching"], "2 scenes are meant", "0.6, touching, elastic"),
    "no scene of a study": (["DIR/film.yaml", "--case", "far"], "no scene of the study is meant", "0.4, touching"),
    "no value": (["DIR/film.h5", "--at", "impact.restitution"], "no value", "--at 'cases.gap.gap=5 cm'"),
    "kind of file": (["DIR/film.h5", "-o", "DIR/film.avi"], "no kind of film", ".gif, .mp4, .png"),
    "folder": (["DIR/film.h5", "-o", "DIR/none/film.gif"], "there is no folder", "make it"),
    "slower than never": (["DIR/film.h5", "--slow", "0"], "must be above zero", "--slow 4"),
    "scale": ([*ONE, "--scale", "big"], "no scale", "auto"),
    "part": ([*ONE, "--from", "9 s"], "no such part", "3 s"),
    "time": ([*ONE, "--to", "9 kg"], "--to", "e.g. 2 s"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_refused(folder, name):
    arguments, message, hint = REFUSED[name]
    shown = animate(folder, *arguments)
    assert isinstance(shown.exception, InputError), shown.output
    problem = shown.exception.problems[0]
    assert message in problem.message
    assert hint in problem.hint


def test_mp4_without_its_package_names_it(folder, monkeypatch):
    real = builtins.__import__

    def absent(name, *rest, **more):
        if name == "imageio_ffmpeg":
            raise ImportError(name)
        return real(name, *rest, **more)

    monkeypatch.setattr(builtins, "__import__", absent)
    shown = animate(folder, "DIR/film.h5", "-o", "DIR/film.mp4")
    assert isinstance(shown.exception, InputError)
    assert "pounding-cli[video]" in shown.exception.problems[0].hint


def test_kept_scenes_are_listed(folder):
    frame = open_results(folder / "film.h5").histories()
    assert list(frame["impact.restitution"]) == [0.4, 0.6]
