"""Bad questions to `pound optimise` are refused at their line and column, with what to write instead."""

from __future__ import annotations

import pytest

from pounding_cli.errors import InputError
from pounding_cli.study import load_study
from pounding_cli.study.optimise import expand_optimise
from tests.helpers.answers import is_refused
from tests.helpers.optimise_studies import STUDY, write_study

MASS = "buildings.A.mass: {from: 100 t, to: 200 t}"
GAP = "cases.near.gap: {from: 10 mm, to: 20 mm}"
OVER = f"  over:\n    {MASS}\n    {GAP}\n"
LEAST = "least: residual_drift in A"
CASES = "cases: {near: {link: pounding, gap: 12 mm}}"


@pytest.mark.parametrize(
    ("old", "new", "line", "column", "said", "hint"),
    [
        (MASS, "buildings.A.maas: {from: 1 t, to: 2 t}", 13, 5, "no key 'maas'", "did you mean 'mass'"),
        (MASS, "buildings.A.mass: {from: 100, to: 200 t}", 13, 30, "100 has no unit", "200 t"),
        (MASS, "buildings.A.mass: {from: 0 t, to: 200 t}", 13, 30, "must be above 0", "e.g."),
        (GAP, "cases.near.gap: {from: 10 mm, to: 20 m}", 14, 39, "the gap is 20 m", "at most 10 m"),
        (MASS, "buildings.A.mass: {from: 200 t, to: 100 t}", 13, 41, "ends where it begins", "above"),
        (MASS, "buildings.A.mass: {from: 200 t}", 13, 23, "the range lacks 'to'", "{from: 0.3, to: 0.6}"),
        (MASS, "buildings.A.mass: {from: 1 t, high: 2 t}", 13, 35, "unknown key 'high' in a range", "known: from"),
        (MASS, "buildings.A.mass: 150 t", 13, 23, "the range is not a mapping", "{from: 0.3, to: 0.6}"),
        (MASS, "buildings.A.hardening: {from: 0, to: 0.1, spacing: log}", 13, 35, "cannot reach zero", "above zero"),
        (MASS, "buildings.A.storeys: {from: 1, to: 3}", 13, 26, "takes no number", "choice"),
        (MASS, "buildings.A.mass: {choice: [100 t]}", 13, 32, "a list of two values", "choice"),
        (MASS, "buildings.A.mass: {choice: [100 t, 1e5 kg]}", 13, 40, "are one value", "remove"),
        (MASS, "buildings.A.mass: {choice: [1 t, 2 t], from: 1 t}", 13, 23, "more than its choice", "or"),
        (MASS, "motion: any", 13, 5, "no key 'motion'", "known"),
        (MASS, "accuracy: {from: 1e-6, to: 1e-4}", 13, 5, "cannot vary", "for each value"),
        (OVER, "", 10, 1, "no key is given to vary", "over: {impact.restitution"),
        (OVER, "  over: mass\n", 12, 9, "'over' is not a mapping of keys", "from: 0.3"),
        (LEAST, "least: residual_drift in C", 11, 10, "no building 'C'", "known: A, B"),
        (LEAST, "least: ductility", 11, 10, "no quantity 'ductility'", "mu"),
        (LEAST, "least: mu in A storey 2", 11, 10, "the highest is 1", "from 1 to 1"),
        (LEAST, "least: max(mu", 11, 10, "a bracket is not closed", ")"),
        (f"  {LEAST}\n", "", 10, 1, "lacks 'least'", "least"),
        (LEAST, f"{LEAST}\n  most: mu", 12, 3, "both stand here", "remove one"),
        ("  slice_points: 5", "  case: far", 15, 9, "no case 'far'", "known: near"),
        ("  slice_points: 5", "  analysis: elastic", 15, 13, "no analysis 'elastic'", "known: inelastic"),
        ("analyses: [inelastic]", "analyses: [elastic, inelastic]", 10, 1, "has 2 analyses", "analysis: elastic"),
        (CASES, CASES[:-1] + ", far: {link: none}}", 10, 1, "has 2 cases", "case: near"),
        ("estimate: none", "keep: histories", 9, 1, "histories cannot be kept", "pound run"),
        (
            "  slice_points: 5", "  generations: 10000\n  population: 10000", 15, 16, "make 100000000 points",
            "200000",
        ),
        ("estimate: none", "sweep: {buildings.A.mass: [100 t, 150 t]}", 13, 5, "is also in line 9", "one of the two"),
    ],
)  # fmt: skip
def test_a_bad_question(tmp_path, old, new, line, column, said, hint):
    assert old in STUDY
    is_refused(write_study(tmp_path, STUDY.replace(old, new)), expand_optimise, line, column, said, hint)


def test_a_corner_at_which_the_study_is_not_sound(tmp_path):
    """Floors at one height are what pounds; a storey of another height has none. Said before anything is solved."""
    text = STUDY.replace(GAP, "buildings.A.height: {from: 2 m, to: 3 m}")
    with pytest.raises(InputError) as error:
        expand_optimise(load_study(write_study(tmp_path, text)))
    assert all("no floor at one elevation" in problem.message for problem in error.value.problems[:-1])
    assert error.value.problems[0].line == 6
