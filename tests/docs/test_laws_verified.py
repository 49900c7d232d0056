"""The table of docs/verification.md that says which test holds which law to what."""

from __future__ import annotations

import re

from pages import ROOT

from pounding_cli.laws import link_laws, storey_laws

SECTION = (ROOT / "docs" / "verification.md").read_text().partition("## Law by law")[2].partition("\n## ")[0]
ROWS = [line.strip("|").split("|") for line in SECTION.splitlines() if line.startswith("| ")][1:]


def test_every_law_has_a_row():
    """Fails when a law is added and nothing is said of what it was held to."""
    named = [name for row in ROWS for name in re.findall(r"`([a-z-]+)`", row[0])]
    assert set(link_laws()) | set(storey_laws()) <= set(named)
    assert named.count("bilinear") == 2  # a contact and a storey
    assert all(cell.strip() for row in ROWS for cell in (*row[1:5], row[6]))


def test_the_tests_are_there():
    """Fails when a test is renamed, and the table is not."""
    found = re.findall(r"`([a-z_]+)::(\w+)`", SECTION)
    assert len(found) > 50
    for module, name in found:
        text = (ROOT / "tests" / "verification" / f"test_{module}.py").read_text()
        assert f"def test_{name}(" in text, (module, name)
