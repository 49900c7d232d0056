"""The page of one step: its names are in the kernels, its numbers are those of the run, and they say what it says."""

from __future__ import annotations

import importlib
import importlib.util
import re

import numpy as np
import pytest
from pages import ROOT

PAGE = ROOT / "docs" / "a-step.md"


@pytest.fixture(scope="module")
def script():
    spec = importlib.util.spec_from_file_location("step_of_the_docs", ROOT / "docs" / "figures" / "step.py")
    module = importlib.util.module_from_spec(spec)
    import sys

    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    yield module
    del sys.modules[spec.name]


@pytest.fixture(scope="module")
def found(script):
    return script.four_steps()


def test_names_are_in_the_kernels():
    """Fails if a function of the page has another name by now."""
    names = re.findall(r"`(\w+)\.(\w+)`", PAGE.read_text().replace("step.svg", ""))
    assert len(names) > 20
    for module, name in names:
        assert hasattr(importlib.import_module(f"pounding_cli.kernels.{module}"), name), f"{module}.{name}"


def test_numbers_are_those_of_the_run(script, found):
    """Fails if `python docs/figures/step.py` has not been run since the solver changed."""
    shown = PAGE.read_text().partition(script.BEGIN)[2].partition(script.END)[0].strip()
    assert shown == script.table(*found)


def test_the_band_holds_the_series_and_excludes_the_first_step_only(script, found):
    """Fails if the chord deviation is no bound, or if the step before the contact needed more than it."""
    away, event = found[1][:2]
    s = np.linspace(0, 1, 1001)
    for step in found[1]:
        v = script.at(step.closing, s)
        assert np.all(abs(v - (v[0] + (v[-1] - v[0]) * s)) <= step.deviation * (1 + 1e-9) + 1e-15)
    assert max(script.at(away.closing, np.array([0.0, 1.0]))) + away.deviation < 0
    assert script.at(event.closing, 1.0) + event.deviation > 0


def test_the_event_is_the_root_and_the_next_step_begins_there(script, found):
    """Fails if a step ends beside the root of the polynomial, or begins anew with the last digits of the closing."""
    _, event, contact, release = found[1]
    roots = np.roots(event.closing[::-1])
    inside = [r.real for r in roots if abs(r.imag) < 1e-12 and 0 <= r.real <= 1]
    assert inside == [pytest.approx(event.end, rel=1e-12)]
    assert abs(contact.closing[0]) < 1e-15
    assert abs(script.at(release.closing, release.end)) < 1e-15


def test_force_is_the_law_and_its_work_is_in_the_ledger(script, found):
    """Fails if the series of the force or the points of the ledger are not those of the step."""
    law = script.scene().links[1].law
    masses = [building.mass[1] for building in script.scene().buildings]
    contact = next(branch for branch in law.branches(*masses) if branch.name == "contact")
    for step in found[1][2:]:
        rate = script.at(script.rate(step), step.points)
        force = contact.linear * script.at(step.closing, step.points) + contact.dashpot * rate
        assert script.at(step.force, step.points) == pytest.approx(force, rel=1e-9, abs=1e-6 * step.peak)
        assert np.sum(step.weights * force * rate) == pytest.approx(step.work, rel=1e-7)
    s = np.linspace(0, 1, 100_001)
    assert script.at(found[1][2].force, s).max() == pytest.approx(found[1][2].peak, rel=1e-9)


def test_terms_end_below_what_may_be_left_out(found):
    """Fails if a series is cut off early, or goes on although two terms in a row were small."""
    for step in found[1][:3]:
        small = step.terms < 1
        assert small[-2:].all()
        assert not (small[:-2] & small[1:-1])[4:].any()


def test_the_drawing_is_made(script, found, tmp_path):
    script.draw(*found, tmp_path / "step.svg")
    text = (tmp_path / "step.svg").read_text()
    assert f"step {found[0] - 1}: the bound excludes an event" in text
    assert (ROOT / "docs" / "figures" / "step.svg").stat().st_size > 10_000
