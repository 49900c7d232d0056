"""docs/contact.md: its numbers are those of the solver, and it names every law that strikes."""

from __future__ import annotations

import importlib.util
from pathlib import Path

from pounding_cli.laws import link_laws

PAGE = Path("docs/contact.md")


def _script():
    spec = importlib.util.spec_from_file_location("restitution", "docs/figures/restitution.py")
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
