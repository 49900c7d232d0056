"""What `import pounding_cli` offers: its names, without loading anything before it is used."""

from __future__ import annotations

import inspect
import subprocess
import sys
import textwrap

import pytest

import pounding_cli

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
