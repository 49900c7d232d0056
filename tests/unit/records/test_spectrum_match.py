"""The match of a suite with its target spectrum: the factor that was added, the lowest place, words, a file's dict."""

from __future__ import annotations

import json

import numpy as np
import pytest

from pounding_cli.numbers import Unit
from pounding_cli.records import TargetSpectrum, find, spectrum, spectrum_factors, spectrum_match
from pounding_cli.records.suite import SpectrumMatch
from pounding_cli.report.spectra import draw_spectra

TARGET = TargetSpectrum((0.1, 0.4, 2.0), (8.0, 8.0, 1.6), 0.2, 1.5)


@pytest.fixture(scope="module")
def motions():
    return {name: find(name).windowed(6.0) for name in ("elcentro", "taft", "parkfield")}


def matched(motions, each, at_least):
    factors = spectrum_factors(motions, TARGET, each, at_least)
    used = {name: motion.scaled(factors[name]) for name, motion in motions.items()}
    return used, spectrum_match(used, TARGET, each, at_least)


@pytest.mark.parametrize("each", [False, True])
def test_the_factor_that_at_least_added_and_the_lowest_place(motions, each):
    plain = spectrum_factors(motions, TARGET, each)
    lifted = spectrum_factors(motions, TARGET, each, 0.9)
    used, match = matched(motions, each, 0.9)
    assert match.lift == pytest.approx(lifted["taft"] / plain["taft"], rel=1e-9)
    assert match.lift > 1
    assert match.lowest[0] == pytest.approx(0.9, rel=1e-9)  # the lift brings the lowest place just there
    mean = np.mean([spectrum(motion, (match.lowest[1],)) for motion in used.values()])
    wanted = np.exp(np.interp(np.log(match.lowest[1]), np.log(TARGET.periods), np.log(TARGET.values)))
    assert mean / wanted == pytest.approx(match.lowest[0], rel=1e-9)
    assert f"a factor of {match.lift:.3f} was added for all" in match.words


def test_words_without_a_floor_and_where_nothing_was_added(motions):
    assert matched(motions, True, None)[1].lift == 1.0
    assert "nowhere below" not in matched(motions, True, None)[1].words
    assert "no further factor was needed" in matched(motions, False, 0.01)[1].words


def test_it_comes_back_from_a_file(motions):
    _, match = matched(motions, False, 0.9)
    assert SpectrumMatch.of_dict(json.loads(json.dumps(match.as_dict()))) == match


def test_the_figure_shows_target_mean_and_every_motion(motions):
    used, match = matched(motions, False, 0.9)
    figure = draw_spectra(match, "A title", Unit("g", 9.80665, "m/s2"))
    (ax,) = figure.axes
    lines = {line.get_label(): line for line in ax.lines}
    assert set(lines) == {"elcentro", "taft", "parkfield", "mean of 3", "target", "0.9 of the target"}
    across, wanted = lines["target"].get_data()
    # Straight lines in ln T and ln Sa, as it is met, not between the points as drawn.
    at_one = np.interp(1.0, across, wanted) * 9.80665
    assert at_one == pytest.approx(8.0 * (1.0 / 0.4) ** (np.log(0.2) / np.log(5.0)), rel=1e-3)
    np.testing.assert_allclose(lines["taft"].get_ydata() * 9.80665, spectrum(used["taft"], match.periods), rtol=1e-12)
    span = ax.patches[0].get_extents().transformed(ax.transData.inverted())
    np.testing.assert_allclose([span.x0, span.x1], [0.2, 1.5])
    assert match.words[:40] in figure.get_supxlabel().replace("\n", " ")
