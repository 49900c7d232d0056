"""Every study of the pages is sound: whole ones, and sections of the study file in a study of three buildings."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml
from pages import PAGES, ROOT, blocks

import pounding_cli

BASE = {
    "title": "x",
    "records": {"use": ["elcentro"], "duration": "5 s"},
    "buildings": {"stiff": {"storeys": 5, "period": "0.36 s"}, "soft": {"like": "stiff", "period": "0.60 s"}},
    "group": ["soft", "stiff", "soft"],
    "cases": {"touching": {"link": "pounding", "gap": "0 cm"}, "gap": {"link": "pounding", "gap": "2 cm"}},
}
WHOLE = {"records", "buildings", "group", "cases"}


def studies() -> list[tuple[str, str]]:
    found = []
    for page in PAGES:
        for block in blocks(page):
            if block.word != "yaml" or block.reason:
                continue
            keys = set(yaml.safe_load(block.text) or ())
            name = f"{page.relative_to(ROOT)}:{block.line}"
            if keys >= WHOLE and page.name != "extending.md":
                found.append((name, block.text))
            elif page.name == "study-file.md":
                found.append((name, yaml.safe_dump(within(yaml.safe_load(block.text)), sort_keys=False)))
    return found


def within(part: dict) -> dict:
    """The base with sections of a study in place of its own; buildings and cases are added to it."""
    merged = {key: {**BASE[key], **part[key]} for key in ("buildings", "cases") if key in part}
    swept = part["keep"]["histories"]["where"] if "keep" in part else {}
    sweep = {"sweep": {key: [value] for key, value in swept.items()}} if swept else {}
    return {**BASE, **part, **merged, **sweep}


@pytest.mark.parametrize(("name", "text"), studies(), ids=[name for name, _ in studies()])
def test_it_is_sound(tmp_path, name, text):
    path = tmp_path / "study.yaml"
    path.write_text(text, encoding="utf-8")
    missing = [each for each in problems_of(path) if "no file" in each or "does not exist" in each]
    assert problems_of(path) == missing  # motions of the reader's own are not here


def problems_of(path: Path) -> list[str]:
    try:
        pounding_cli.load_study(path)
    except pounding_cli.InputError as error:
        return [str(each) for each in error.issues]
    return []


def test_there_are_some():
    assert len(studies()) > 5
