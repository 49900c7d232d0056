"""The catalogue of faults keeps up with the code; whether each fault is seen, `python -m tests.mutants` tells."""

from __future__ import annotations

import subprocess

import pytest

from .catalogue import MUTANTS
from .page import BEGIN, END, PAGE, table, write
from .runner import ROOT, Mutant, verdict


@pytest.mark.parametrize("mutant", MUTANTS, ids=lambda m: m.fault)
def test_a_fault_can_be_made_and_its_test_is_there(mutant):
    """Fails when the code or the test moves on without the catalogue."""
    assert (ROOT / mutant.file).read_text().count(mutant.old) == 1
    assert mutant.new != mutant.old
    path, _, name = mutant.test.partition("::")
    assert f"def {name.partition('[')[0]}(" in (ROOT / path).read_text()


def test_no_fault_twice():
    assert len({m.fault for m in MUTANTS}) == len({(m.file, m.old, m.new) for m in MUTANTS}) == len(MUTANTS)


def test_the_page_lists_them_all():
    """Fails when `python -m tests.mutants --write` has not been run."""
    shown = PAGE.read_text().partition(BEGIN)[2].partition(END)[0].strip()
    assert shown == table(MUTANTS)


def test_the_table_replaces_what_stood_there(tmp_path):
    page = tmp_path / "page.md"
    page.write_text(f"above\n{BEGIN}\nold\n{END}\nbelow\n")
    write([Mutant("a fault", "pounding_cli/x.py", "a", "b", "tests/unit/test_x.py::test_that_it_holds")], page)
    assert page.read_text().splitlines()[4] == "| a fault | `x.py` | `unit/test_x.py` that it holds |"
    assert page.read_text().startswith("above\n")
    assert page.read_text().endswith(f"{END}\nbelow\n")
    page.write_text("no marks")
    with pytest.raises(ValueError, match="lacks the marks"):
        write([], page)


@pytest.mark.parametrize(
    ("code", "said", "problem"),
    [
        (1, "FAILED tests/a.py::test_b - assert 1 == 2", ""),
        (1, "FAILED tests/a.py::test_b - AssertionError: drift", ""),
        (1, "FAILED tests/a.py::test_b - numba.core.errors.TypingError: no", "broke"),
        (1, "FAILED tests/a.py::test_b - ZeroDivisionError: by zero", "broke"),
        (0, "1 passed", "passes"),
        (2, "ERROR tests/a.py - SyntaxError", "ended with 2"),
        (4, "ERROR: not found", "ended with 4"),
    ],
)
def test_only_an_assertion_counts_as_seen(code, said, problem):
    """Fails if a test that broke on the fault is taken for one that noticed it."""
    found = verdict(subprocess.CompletedProcess([], code, said, ""))
    assert problem in found
    assert bool(problem) == bool(found)
