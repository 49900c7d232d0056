"""Every study of the gallery runs as its page says, and its figure and numbers follow from the tables."""

from __future__ import annotations

import os
import re

import pytest
from pages import hook

GALLERY = hook("gallery")
SOON = ("first-pair",)
"""Studies that every run of the tests looks at; `make reference` and `make docs` run the others too."""


def test_every_study_is_on_the_page():
    assert {path.stem for path in GALLERY.FOLDER.glob("*.yaml")} == set(GALLERY.ENTRIES)


@pytest.mark.parametrize("name", GALLERY.ENTRIES)
def test_it_runs(name, tmp_path, monkeypatch):
    if name not in SOON and "POUND_NIGHTLY" not in os.environ:
        pytest.skip("make reference runs it every night")
    monkeypatch.delenv("POUND_RECORDS", raising=False)
    solved = GALLERY.Solved(GALLERY.FOLDER / f"{name}.yaml", GALLERY.ENTRIES[name].command, tmp_path)
    text, figure = GALLERY.section(name, solved)
    assert len(figure) > 5_000
    assert f"{name}.yaml" in text
    if GALLERY.ENTRIES[name].numbers is not None:
        assert NUMBERS[name] in re.sub(r"\s+", " ", text)


NUMBERS = {
    "end-of-row": (
        "| mu/mu0 of the core (-8 m) | 1.37 with a shift of -6 m; 1.09 with 6 m | "
        "| mu/mu0 of the frame (0 m) | 1.25 with a shift of -6 m; 1.10 with 6 m | "
        "| mu/mu0 of the light frame (8 m) | 0.97 with a shift of -6 m; 0.99 with 6 m | "
        "| mu/mu0 of its storeys without `plan:` | 0.99 |"
    ),
    "paper-pair": '| 85 %, mean over the floors | | "approximately 7cm" separation by the UBC | 6.9 cm |',
    "paper-three": "largest mu/mu0 1.00 where storeys yield",
    "paper-oscillators": "0.709 and 1.121 times that of the first",
    "paper-wall": "| 33.5 N/mm2 |",
}
"""What stands in the tables of numbers."""
