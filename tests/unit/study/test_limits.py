"""Limits in words and intensity measures: what they mean, and what is refused with which hint."""

from __future__ import annotations

import pytest
from pydantic_core import PydanticCustomError

from pounding_cli.study.fragility_keys import Measure, read_measure
from pounding_cli.study.limits import Limit, read_limit


@pytest.mark.parametrize(
    ("text", "meaning"),
    [
        ("mu > 4", ("mu", 4.0, False, "", 0)),
        ("mu>4", ("mu", 4.0, False, "", 0)),
        ("drift > 2 %", ("drift", 0.02, True, "", 0)),
        ("drift > 2%", ("drift", 0.02, True, "", 0)),
        ("drift_ratio > 2 %", ("drift", 0.02, True, "", 0)),
        ("drift_ratio > 0.02 in soft storey 1", ("drift", 0.02, True, "soft", 1)),
        ("drift > 6 cm", ("drift", 0.06, False, "", 0)),
        ("drift > 0.5 in in stiff storey 2", ("drift", 0.0127, False, "stiff", 2)),
        ("acceleration > 1 g in soft floor 5", ("acceleration", 9.80665, False, "soft", 5)),
        ("acceleration > 300 gal in the old mill", ("acceleration", 3.0, False, "the old mill", 0)),
        ("mu > 4 in storey 1", ("mu", 4.0, False, "", 1)),
        ("shear_demand > 1", ("shear_demand", 1.0, False, "", 0)),
        ("shear_demand > 0.8 in soft storey 2", ("shear_demand", 0.8, False, "soft", 2)),
        ("  contact ", ("contact", 0.0, False, "", 0)),
        ("collapse", ("collapse", 0.0, False, "", 0)),
        ("collapse in soft", ("collapse", 0.0, False, "soft", 0)),
    ],
)
def test_what_a_limit_means(text, meaning):
    quantity, value, of_height, building, level = meaning
    words = " ".join(text.split())
    assert read_limit(text) == Limit(words, quantity, pytest.approx(value, rel=1e-12), of_height, building, level)
    assert str(read_limit(text)) == words


@pytest.mark.parametrize(
    ("text", "said", "hint"),
    [
        ("ductility > 4", "no limit of 'ductility'", "did you mean 'mu'"),
        ("acceleraton > 1 g", "no limit of 'acceleraton'", "did you mean 'acceleration'"),
        ("collapse > 10 %", "takes no value", "collapse in BUILDING"),
        ("collapse in soft storey 2", "concerns a building", "collapse in BUILDING"),
        ("shear > 1", "no limit of 'shear'", "did you mean 'shear_demand'"),
        ("shear_demand > 1 kN", "expected a plain number", "shear_demand > 1"),
        ("shear_demand > 1 in A floor 1", "belongs to a storey", "storey 1"),
        ("collapsed", "no limit of 'collapsed'", "did you mean 'collapse'"),
        ("drift > 0.02", "has no unit", "drift > 2 %"),
        ("acceleration > 1", "has no unit", "acceleration > 1 g"),
        ("drift > 2 g", "is no drift", "drift > 6 cm"),
        ("drift > 0.5 in stiff", "has no unit", "drift > 2 %"),
        ("mu > 4 cm", "expected a plain number", "mu > 4"),
        ("mu > 0", "must be above 0", "mu > 4"),
        ("drift > 100 %", "below 1", "drift"),
        ("drift_ratio > 6 cm", "expected a plain number", "drift_ratio > 2 %"),
        ("mu", "lacks its value", "mu > 4"),
        ("mu >", "not a number", "mu > 4"),
        ("mu < 4", "has < where > belongs", "mu > 4"),
        ("mu >= 4", "has >= where > belongs", "mu > 4"),
        ("mu > 1 > 2", "not a number", "mu > 4"),
        ("contact > 1", "takes no value", "contact"),
        ("contact in stiff", "not one of them", "contact"),
        ("mu > 4 in floor 2", "belongs to a storey", "storey 2"),
        ("mu > 4 in stiff storey 0", "no storey 0", "storey 1"),
        ("", "is not a limit", "drift > 2 %"),
        ("> 4", "is not a limit", "drift > 2 %"),
        ("mu > " + "4" * 300, "characters are not a limit", "mu > 4"),
        (4, "4 is not a limit", "mu > 4"),
        (["mu > 4"], "a list is not a limit", "mu > 4"),
    ],
)
def test_what_is_refused(text, said, hint):
    with pytest.raises(PydanticCustomError) as refused:
        read_limit(text)
    assert said in refused.value.context["message"]
    assert hint in refused.value.context["hint"]


def test_intensity_measures():
    assert read_measure("sa( 500 ms )") == Measure("sa", 0.5)
    assert (str(read_measure("sa(0.5 s)")), str(read_measure("pga"))) == ("sa(0.5 s)", "pga")
    for text, said in (
        ("sa(0.5)", "no unit"), ("pga(1 s)", "only sa"), ("pgx", "no intensity measure"), ("sa(1 m)", "no period"),
        ("sa()", "no unit"), ("sa(0.5 s", "is not an intensity"), (3, "is not an intensity"), ("sa(100 s)", "at most"),
    ):  # fmt: skip
        with pytest.raises(PydanticCustomError) as refused:
            read_measure(text)
        assert said in refused.value.context["message"]
