"""The catalogue of faults keeps up with the code; whether each fault is seen, `python -m tests.mutants` tells."""

from __future__ import annotations

import ast
import builtins
import re
import subprocess
from collections import Counter

import pytest

from .catalogue import MUTANTS
from .markers import Place, markers, mutated
from .page import tables
from .runner import ROOT, Mutant, verdict

PLACES = dict(markers(ROOT))


@pytest.mark.parametrize("mutant", MUTANTS, ids=lambda m: m.fault)
def test_a_fault_can_be_made_and_its_test_is_there(mutant):
    """Fails when the code or the test moves on without the catalogue."""
    place = PLACES[mutant.marker]
    text = (ROOT / place.file).read_text()
    changed = mutated(text, place.line, mutant.becomes)
    before, after = ast.parse(text), ast.parse(changed)
    assert ast.dump(before) != ast.dump(after)
    assert _names(after) <= _names(before) | set(dir(builtins)), "the fault uses names that its file has not"
    path, _, name = mutant.test.partition("::")
    assert f"def {name.partition('[')[0]}(" in (ROOT / path).read_text()


def _names(tree):
    return {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}


def test_every_marker_stands_once_and_has_a_fault():
    found = Counter(name for name, _ in markers(ROOT))
    assert not [name for name, count in found.items() if count > 1]
    assert set(found) == {m.marker for m in MUTANTS}


def test_no_fault_twice():
    assert len({m.fault for m in MUTANTS}) == len({(m.marker, m.becomes) for m in MUTANTS}) == len(MUTANTS)


@pytest.mark.parametrize(
    ("becomes", "line"),
    [
        ("pass", "    pass"),
        ("{line}; y = 2", "    x = a + b; y = 2"),
        (("+ b", "- b"), "    x = a - b"),
        ("", "    "),
    ],
)
@pytest.mark.parametrize("marked", ["    x = a + b  # fault: sum\n", "    # fault: sum\n    x = a + b\n"])
def test_the_marked_line_and_no_other_is_changed(tmp_path, becomes, line, marked):
    text = f"def f():\n{marked}    x = a + b\n"
    (tmp_path / "pounding_cli").mkdir()
    (tmp_path / "pounding_cli" / "f.py").write_text(text)
    [(name, place)] = markers(tmp_path)
    assert (name, place.file) == ("sum", "pounding_cli/f.py")
    above = ["def f():", "    # fault: sum"][: place.line]
    assert mutated(text, place.line, becomes).splitlines() == [*above, line, "    x = a + b"]


@pytest.mark.parametrize("piece", ["c", "a"])
def test_a_piece_stands_once_in_the_line(piece):
    with pytest.raises(ValueError, match="times in 'x = a \\* a'"):
        mutated("x = a * a  # fault: square\n", 0, (piece, "b"))


def test_the_tables_name_every_fault_once():
    shown = tables(MUTANTS, PLACES)
    assert Counter(re.findall(r"^\| `[^`]+` \| (.+) \| `", shown, flags=re.MULTILINE)) == Counter(
        m.fault for m in MUTANTS
    )
    mutant = Mutant("sum", "a fault", "pass", "tests/unit/test_x.py::test_that_it_holds")
    lines = tables([mutant], {"sum": Place("pounding_cli/x.py", 3)}).splitlines()
    assert lines[0] == "### `x.py`"
    assert lines[-1] == "| `sum` | a fault | `unit/test_x.py` that it holds |"


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
