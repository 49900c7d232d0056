"""What `import pounding_cli` offers: its names, without loading anything before it is used."""

from __future__ import annotations

import inspect
import re
import subprocess
import sys
import textwrap

import pytest

import pounding_cli
from pounding_cli.solver.histories import FIELDS
from pounding_cli.solver.response import (
    BASES,
    COLLAPSES,
    COLUMNS,
    LINKS,
    STOREYS,
    BuildingPeaks,
    ColumnPeaks,
    LinkPeaks,
)
from pounding_cli.variables import VARIABLES

HEAVY = ("h5py", "matplotlib", "numba", "numpy", "pandas", "pydantic", "scipy", "xarray")


def said(program: str) -> str:
    command = [sys.executable, "-c", textwrap.dedent(program)]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, check=True).stdout


def test_every_name_is_there_told_and_completed():
    wanted = {"Scene", "Building", "Link", "Motion", "solve", "History", "InputError", "Results", "run", "open_results"}
    assert wanted <= set(pounding_cli.__all__)
    assert set(pounding_cli.__all__) <= set(dir(pounding_cli))
    for name in pounding_cli.__all__:
        assert inspect.getdoc(getattr(pounding_cli, name)), name
    assert {"dataset", "plot", "storey", "history", "link"} <= set(dir(pounding_cli.Results))


@pytest.mark.parametrize(
    ("found", "names"),
    [
        (pounding_cli.Response.buildings, (*STOREYS, *BASES, *COLLAPSES)),
        (pounding_cli.Response.links, LINKS),
        (pounding_cli.Response.columns, ("link", *COLUMNS)),
    ],
)
def test_what_a_response_holds_are_documented_classes(found, names):
    """Every attribute with its unit in the docstring, and completed before anything is solved. Fails if one is left
    out."""
    annotation = inspect.signature(found.fget).return_annotation
    (kind,) = (each for each in (BuildingPeaks, LinkPeaks, ColumnPeaks) if each.__name__ in annotation)
    assert set(names) == {name for name in dir(kind) if not name.startswith("_")}
    for name in names:
        assert re.search(rf"^{name} : .*?\[.+?\]$", inspect.getdoc(kind), re.MULTILINE | re.DOTALL), name


def test_quantities_of_a_history_are_documented_attributes():
    """Fails if one of the file has no property with unit and shape."""
    for name, (dims, unit, _) in FIELDS.items():
        text = inspect.getdoc(inspect.getattr_static(pounding_cli.History, name))
        assert f"[{unit}], shape ({', '.join(f'{dim}s' for dim in dims)}" in text, name


@pytest.mark.parametrize("table", ["storey", "floor", "link", "base", "scene", "accuracy"])
def test_tables_say_the_unit_of_every_column(table):
    text = inspect.getdoc(getattr(pounding_cli.Results, table))
    named = re.findall(r"^(\w+) : (.+)$", text.split("Columns\n-------\n")[1], re.MULTILINE)
    assert len(named) >= 3
    assert all(VARIABLES[name].text in words for name, words in named)


def test_the_import_is_light():
    """Completion too. Fails if a name is imported before it is used."""
    program = f"""
        import sys, pounding_cli
        dir(pounding_cli)
        print([name for name in {HEAVY!r} if name in sys.modules])
        pounding_cli.InputError
        print([name for name in {HEAVY!r} if name in sys.modules])
    """
    assert said(program).split("\n")[:2] == ["[]", "[]"]


def test_a_subpackage_of_the_same_name_does_not_hide_solve():
    program = """
        import inspect, pounding_cli
        from pounding_cli import solve
        print(solve is pounding_cli.solve, list(inspect.signature(pounding_cli.solve).parameters)[:2])
    """
    assert said(program).splitlines() == ["True ['scene', 'accuracy']"]


def test_a_name_that_is_not_there():
    with pytest.raises(AttributeError, match="no attribute 'sovle'"):
        pounding_cli.sovle  # noqa: B018
