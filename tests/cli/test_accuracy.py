"""`pound accuracy`: what it prints and writes, and what it refuses."""

from __future__ import annotations

import sys

import numpy as np
import pandas as pd
import pytest

from pounding_cli.cli.main import main

STUDY = """\
title: Two small buildings
records:
  use: [{file: shake.txt}]
  duration: whole
  scale: 1.0
buildings:
  stiff: {storeys: 2, period: 0.3 s, mass: 200 t, height: 3 m,
          yield: {code: UBC-1991, zone: 0.4, soil: 1.2, Rw: 12}}
  soft: {like: stiff, period: 0.5 s}
group: [stiff, soft]
impact: {stiffness: 20 x stiffest storey, restitution: 0.5}
cases:
  touching: {link: pounding, gap: 0 cm}
  connected: {link: connector, gap: 1 cm, floors: [2], stiffness: 1/5 mean storey of stiff}
analyses: [elastic]
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    t = np.arange(0, 2, 0.02)
    np.savetxt("shake.txt", np.column_stack((t, 0.4 * np.sin(2 * np.pi * 2.5 * t) * np.sin(np.pi * t / 2))))
    (tmp_path / "study.yaml").write_text(STUDY)
    return tmp_path


def pound(monkeypatch, *words: str) -> int:
    monkeypatch.setattr(sys, "argv", ["pound", *words])
    with pytest.raises(SystemExit) as ended:
        main()
    return int(ended.value.code or 0)


def test_table_answer_and_files(folder, monkeypatch, capsys):
    """Fails if a method that does not run a scene ends the command, or aborted runs are drawn as numbers."""
    words = ("accuracy", "study.yaml", "--methods", "taylor,exponential,central-difference", "--budget", "5s")
    assert pound(monkeypatch, *words) == 0
    said = capsys.readouterr().out
    assert "For 0.1 % use" in said
    assert "differs from it by at most V" in said
    out = folder / "results" / "study-accuracy"
    assert {path.name for path in out.iterdir()} == {
        "accuracy.md", "accuracy.csv", "accuracy-elastic.png", "accuracy-elastic.svg"
    }  # fmt: skip
    runs = pd.read_csv(out / "accuracy.csv")
    assert set(runs.method) == {"taylor", "exponential", "central-difference"}
    assert set(runs[runs.method == "exponential"].case) == {"connected"}
    done = runs[runs.status == "done"]
    assert (done[(done.method == "taylor") & (done.setting <= 1e-4)].error_V < 1e-5).all()
    assert runs[runs.status != "done"].error_V.isna().all()
    page = (out / "accuracy.md").read_text()
    assert page.rstrip().endswith("--budget 5s`")
    assert "Machine: " in page
    assert "numba" in page


def test_steps_that_are_too_long_are_listed(folder, monkeypatch, capsys):
    """A stiff contact makes 2 ms unstable. Fails if such runs vanish without a word."""
    study = (folder / "study.yaml").read_text().replace("20 x stiffest storey", "1e12 N/m")
    (folder / "study.yaml").write_text(study)
    assert pound(monkeypatch, "accuracy", "study.yaml", "--methods", "central-difference", "--cases", "touching") == 0
    said = capsys.readouterr().out
    assert "Did not end, central-difference at 0.002 s: unstable step on 1 scene (" in said


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--methods", "euler"), "there is no method euler"),
        (("--cases", "floating"), "the study has no case floating"),
        (("--budget", "ten"), "--budget: 'ten' is not a number with a unit"),
        (("--budget", "0 s"), "--budget: the budget is 0 s; it must be above 0 s"),
    ],
)
def test_refusals(folder, monkeypatch, capsys, words, message):
    assert pound(monkeypatch, "accuracy", "study.yaml", *words) == 2
    assert message in capsys.readouterr().err
