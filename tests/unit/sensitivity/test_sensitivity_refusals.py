"""Bad questions to `pound sensitivity` are refused at their line and column, with what to write instead."""

from __future__ import annotations

import pytest

from pounding_cli.errors import InputError
from pounding_cli.study import load_study
from pounding_cli.study.sensitivity import expand_sensitivity
from tests.helpers.answers import is_refused
from tests.helpers.sensitivity_studies import STUDY, write_study

MASS = "buildings.A.mass: {uniform: {from: 100 t, to: 200 t}}"
GAP = "cases.near.gap: {uniform: {from: 10 mm, to: 20 mm}}"
HARDENING = "buildings.A.hardening: {uniform: {from: 0, to: 0.5}}"
OUTPUTS = "outputs: [residual_drift in A]"
UNCERTAIN = STUDY[STUDY.index("uncertain:") : STUDY.index("sensitivity:")]


@pytest.mark.parametrize(
    ("old", "new", "line", "column", "said", "hint"),
    [
        (MASS, "buildings.A.maas: {uniform: {from: 1 t, to: 2 t}}", 11, 3, "no key 'maas'", "did you mean 'mass'"),
        (MASS, "buildings.A.mass: {uniform: {from: 100, to: 200 t}}", 11, 38, "100 has no unit", "200 t"),
        (MASS, "buildings.A.mass: {normal: {mean: 100 t, sd: 90 t}}", 11, 30, "reaches -5.33e+05 kg", "`from:`"),
        (HARDENING, "buildings.A.hardening: {uniform: {from: 0.5, to: 1.5}}", 13, 52, "must be at least 0 and", "e.g."),
        (HARDENING, "buildings.A.hardening: {lognormal: {median: 0.9, spread: 1}}", 13, 38, "reaches", "`to:`"),
        (
            HARDENING, "buildings.A.hardening: {triangular: {from: 0, mode: 0.6, to: 0.5}}", 13, 55, "mode lies",
            "between",
        ),
        (HARDENING, "buildings.A.hardening: {uniform: {from: 0.5, to: 0.1}}", 13, 52, "ends where it begins", "above"),
        (
            HARDENING, "buildings.A.hardening: {gauss: {mean: 0.1, sd: 0.01}}", 13, 27, "no distribution 'gauss'",
            "uniform",
        ),
        (
            HARDENING, "buildings.A.hardening: {uniform: {low: 0.1, to: 0.2}}", 13, 37, "unknown key 'low'",
            "known: from",
        ),
        (HARDENING, "buildings.A.hardening: 0.1", 13, 26, "has no distribution", "write one of uniform"),
        (HARDENING, "buildings.A.hardening: {choice: [0.5, 50 %]}", 13, 41, "50 % and 0.5 are one value", "remove"),
        (HARDENING, "buildings.A.height: {choice: [3 m, 4]}", 13, 38, "4 has no unit", "3 m"),
        (HARDENING, "buildings.A.storeys: {uniform: {from: 1, to: 3}}", 13, 34, "takes no number", "choice"),
        (HARDENING, "motion: any", 13, 3, "the study has one motion", "records"),
        (HARDENING, "motion: all", 13, 11, "'all' is not known", "motion: any"),
        (HARDENING, "accuracy: {uniform: {from: 1e-6, to: 1e-4}}", 13, 3, "cannot vary", "for each value"),
        (UNCERTAIN, "", 1, 1, "nothing is uncertain", "uncertain: {impact.restitution"),
        (f"  {GAP}\n  {HARDENING}\n", "", 10, 1, "alone is uncertain", "two keys"),
        (OUTPUTS, "outputs: [residual_drift in C]", 15, 13, "no building 'C'", "known: A, B"),
        (OUTPUTS, "outputs: [ductility]", 15, 13, "no quantity 'ductility'", "mu"),
        (OUTPUTS, "outputs: [mu in A storey 2]", 15, 13, "the highest is 1", "from 1 to 1"),
        (OUTPUTS, "outputs: [mu, mu]", 15, 17, "occurs twice", "remove one"),
        (OUTPUTS, "outputs: [max(mu]", 15, 13, "a bracket is not closed", ")"),
        (OUTPUTS, "outputs: []", 14, 1, "lacks 'outputs'", "largest mu"),
        (OUTPUTS, "outputs: [impacts in A]", 15, 13, "impacts belongs to links", "impacts"),
        ("samples: 64", "samples: 100", 16, 12, "only at powers of 2", "write 64 or 128"),
        ("samples: 64", "samples: 65536", 16, 12, "make 327680 points", "keep it to 200000"),
        ("samples: 64", "confidence: 95", 16, 15, "lacks its %", "90 %"),
        ("estimate: none", "keep: histories", 9, 1, "histories cannot be kept", "pound run"),
        (
            "estimate: none", "sweep: {buildings.A.mass: [100 t, 150 t]}", 11, 3, "is also in line 9", "one of the two",
        ),
    ],
)  # fmt: skip
def test_a_bad_question(tmp_path, old, new, line, column, said, hint):
    assert old in STUDY
    is_refused(write_study(tmp_path, STUDY.replace(old, new)), expand_sensitivity, line, column, said, hint)


def test_a_sample_at_which_the_study_is_not_sound(tmp_path):
    """Floors at one height are what pounds; a storey of another height has none. A few of the samples are named."""
    text = STUDY.replace(GAP, "buildings.A.height: {uniform: {from: 1 m, to: 2 m}}")
    with pytest.raises(InputError) as error:
        expand_sensitivity(load_study(write_study(tmp_path, text)))
    *told, last = error.value.problems
    assert len(told) == 3
    assert all(problem.line == 6 and "no floor at one elevation" in problem.message for problem in told)
    assert all("where buildings.A.mass = " in problem.message for problem in told)
    assert last.message == "and more problems like these at 320 samples"
