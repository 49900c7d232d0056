"""docs/contact.md: its numbers are those of the solver, and it names every law that strikes."""

from __future__ import annotations

import dataclasses
import importlib.util
from pathlib import Path

import pytest

from pounding_cli.laws import link_laws

PAGE = Path("docs/contact.md")


def _script(name: str = "restitution"):
    spec = importlib.util.spec_from_file_location(name, f"docs/figures/{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_numbers_are_those_of_runs():
    """Fails if `python docs/figures/restitution.py` has not been run since a law changed."""
    script = _script()
    shown = PAGE.read_text(encoding="utf-8").partition(script.BEGIN)[2].partition(script.END)[0].strip()
    assert shown == script.table(script.curves())


def test_every_law_that_strikes_is_named():
    page = PAGE.read_text(encoding="utf-8")
    for name, law in link_laws().items():
        if law.subtracts_gap and law.__module__.startswith("pounding_cli."):
            assert f"| `{name}` |" in page, name


@pytest.fixture(scope="module")
def comparison():
    return _script("contact_laws")


def test_the_springs_of_the_study_are_matched(comparison):
    """configs/contact-laws.yaml. Fails if k_h or d_m is that of another stiffness, speed or restitution."""
    laws = comparison.laws()
    hertz, depth = comparison.matched(laws["kelvin-voigt"].stiffness)
    assert laws["hertz"].hertz_stiffness == pytest.approx(hertz, rel=2e-4)
    assert laws["bilinear"].penetration == pytest.approx(depth, rel=5e-4)
    undamped = dataclasses.replace(laws["kelvin-voigt"], damping_ratio=0.0)
    assert comparison.blow(undamped)[0] == pytest.approx(1.0, rel=1e-9)
    assert comparison.blow(laws["hertz"])[0] == pytest.approx(1.0, rel=2e-4)
    for law in ("kelvin-voigt", "hertz-damp", "jankowski", "bilinear"):
        assert comparison.blow(laws[law])[2] == pytest.approx(0.5, abs=5e-4), law


def test_the_comparison_is_that_of_runs(comparison):
    """Fails if `python docs/figures/contact_laws.py` has not been run since a law changed."""
    begin, end = comparison.marks("laws")
    shown = PAGE.read_text(encoding="utf-8").partition(begin)[2].partition(end)[0].strip()
    assert shown == comparison.compared(comparison.run(comparison.STUDY))


def test_what_converges_as_the_contact_stiffens(comparison):
    """One motion, s of 1280 and 5120 times the stiffest storey. Fails if a shear goes on changing, or if a force or the
    duration of a blow does not change as the root of s."""
    study = comparison.stiffening()
    study["records"] = {"use": ["elcentro"], "duration": "5 s"}
    study["sweep"][1] = {key: values[-2:] for key, values in study["sweep"][1].items()}
    tables = comparison.run(study)

    def factors(what, case, analysis="elastic"):
        values = comparison.over_stiffness(tables, what, case, analysis, comparison.MULTIPLES[-2:])
        return (values[5120] / values[1280]).reindex(comparison.LOOKS).to_numpy()

    for case in ("touching", "gap"):
        for what in ("V/V0", "displacement [mm]", "impulse [kN s]"):
            assert factors(what, case) == pytest.approx(1.0, abs=0.04), (what, case)
        for what in ("impact force [MN]", "acceleration / alone"):
            assert factors(what, case) == pytest.approx(2.0, rel=0.04), (what, case)
    assert factors("mu/mu0", "touching", "inelastic") == pytest.approx(1.0, abs=0.04)
    assert factors("impacts", "gap") == pytest.approx(1.0, abs=1e-12)
    assert factors("time in contact [s]", "gap") == pytest.approx(0.5, rel=0.01)
