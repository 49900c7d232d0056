"""Motions scaled to a target spectrum: what is said of the whole range holds between the periods of the fit."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from pounding_cli.records.motion import spectrum
from pounding_cli.study import load_study_file

STUDY = """\
records:
  use: [elcentro, taft]
  duration: 6 s
  scale: {spectrum: WAY, target: TARGET, from: 0.1 s, to: 1.5 s, damping: DAMPING, at_least: 90 %}
buildings: {A: {storeys: 1, period: 0.3 s}, B: {storeys: 1, period: 0.5 s}}
group: [A, B]
cases: {gap: {link: pounding, gap: 1 cm}}
"""
POINTS = "{0.1 s: 0.8 g, 0.5 s: 0.8 g, 0.61 s: 0.5 g, 2 s: 0.2 g}"


@pytest.mark.parametrize(
    ("way", "target", "damping"), [("mean", POINTS, "2 %"), ("each", POINTS, "5 %"), ("mean", "parkfield", "5 %")]
)
def test_the_mean_spectrum_is_nowhere_below_its_part_of_the_target(tmp_path: Path, way, target, damping) -> None:
    """At 1,200 periods, by the spectra alone. Fails if only the 50 periods of the fit are looked at: at 2 % damping it
    then falls to 0.89."""
    text = STUDY.replace("WAY", way).replace("TARGET", target).replace("DAMPING", damping)
    (tmp_path / "s.yaml").write_text(text)
    study = load_study_file(tmp_path / "s.yaml")
    match = study.spectrum_match()
    assert match is not None
    motions = list(study.motions(study.first_point).values())
    periods = np.geomspace(0.1, 1.5, 1200)
    mean = np.mean([spectrum(motion, periods, match.target.damping) for motion in motions], axis=0)
    wanted = np.interp(np.log(periods), np.log(match.target.periods), np.log(match.target.values))
    ratio = mean / np.exp(wanted)
    assert ratio.min() == pytest.approx(0.9, rel=1e-3)
    assert ratio.min() > 0.9 * (1 - 1e-5)
    period, lowest = map(float, re.search(r"lowest at ([\d.]+) s: ([\d.]+) of the target", match.words).groups())
    assert lowest == 0.9
    assert np.interp(period, periods, ratio) == pytest.approx(0.9, rel=1e-2)
