"""Bad questions to `pound fragility` are refused at their line and column, with what to write instead."""

from __future__ import annotations

import pytest

from pounding_cli.errors import InputError
from pounding_cli.study import load_study
from pounding_cli.study.fragility import expand_fragility
from tests.helpers.fragility_studies import STUDY, write_study

LIMITS = "  limits: [mu > 4, contact]\n"
SWEEP = "sweep:\n  records.scale.pga: {from: 0.02 g, to: 1 g, step: 0.02 g}\n"


def refused(folder, text):
    path = write_study(folder, text)
    with pytest.raises(InputError) as error:
        expand_fragility(load_study(path))
    assert all(problem.file.endswith("known.yaml") for problem in error.value.problems)
    return [(problem.line, problem.column, problem.message, problem.hint) for problem in error.value.problems]


@pytest.mark.parametrize(
    ("old", "new", "line", "column", "said", "hint"),
    [
        (LIMITS, "  limits: [mu > 4, drift > 0.02]\n", 13, 20, "has no unit", "drift > 2 %"),
        (LIMITS, "  limits: ductility > 4\n", 13, 11, "no limit of 'ductility'", "did you mean 'mu'"),
        (LIMITS, "  limits: [mu > 4, collapse]\n", 13, 20, "no storey of A and B can collapse", "p_delta: true"),
        (LIMITS, "  limits: []\n", 12, 1, "no limit", "limits: [mu > 4]"),
        ("fragility:\n" + LIMITS, "", 1, 1, "no limit", "fragility: {limits: [mu > 4]}"),
        (LIMITS, "  limits: [mu > 4 in C]\n", 13, 12, "no building 'C'", "known: A, B"),
        (LIMITS, "  limits: [mu > 4 in storey 4]\n", 13, 12, "the highest is 3", "from 1 to 3"),
        (LIMITS, "  limits: [mu > 4, mu > 4]\n", 13, 20, "occurs twice", "remove one"),
        (LIMITS, LIMITS + "  method: pushover\n", 14, 11, "'pushover' is not known", "'ida'"),
        (LIMITS, LIMITS + "  intensity: pgx\n", 14, 14, "no intensity measure 'pgx'", "did you mean 'pgv'"),
        (LIMITS, LIMITS + "  intensity: sa\n", 14, 14, "sa is not swept and has no period", "sa(0.5 s)"),
        (LIMITS, LIMITS + "  confidence: 90\n", 14, 15, "lacks its %", "90 %"),
        (LIMITS, LIMITS + "  limit: mu > 4\n", 14, 3, "unknown key 'limit'", "did you mean 'limits'"),
        (SWEEP, "", 10, 1, "the intensity is not swept", "records.scale.pga: {from: 0.05 g"),
        (SWEEP, "sweep: {cases.near.gap: [1 cm, 2 cm]}\n", 11, 1, "the intensity is not swept", "method: cloud"),
        (SWEEP, "sweep: {records.scale.pga: [0.1 g]}\n", 10, 28, "two intensities at least", "step: 0.05 g"),
        (
            SWEEP, "sweep: [{records.scale.pga: [1 m/s2, 2 m/s2], cases.near.gap: [1 cm, 2 cm]}]\n", 10, 1,
            "move together", "sweep:",
        ),
        ("estimate: none", "keep: histories", 9, 1, "histories cannot be kept", "method: stripes"),
    ],
)  # fmt: skip
def test_a_bad_question(tmp_path, old, new, line, column, said, hint):
    assert old in STUDY
    ((at, place, message, advice),) = refused(tmp_path, STUDY.replace(old, new))
    assert said in message
    assert hint in advice
    assert (at, place) == (line, column)


def test_an_intensity_that_is_named_but_not_swept(tmp_path):
    text = STUDY.replace(SWEEP, "").replace(LIMITS, LIMITS + "  intensity: pga\n")
    ((line, column, message, _),) = refused(tmp_path, text)
    assert (line, column) == (12, 14)
    assert message == "the intensity pga is not swept"


def test_every_problem_is_told_in_one_go(tmp_path):
    text = STUDY.replace(SWEEP, "").replace(LIMITS, "  limits: [mu > 4 in C, mu > 4 in storey 9]\n")
    assert [message for _, _, message, _ in refused(tmp_path, text)] == [
        "the intensity is not swept",
        "'mu > 4 in C': no building 'C' in the group",
        "'mu > 4 in storey 9': the highest is 3",
    ]
