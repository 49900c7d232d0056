"""A few hundred random scenes in every test run, and every study that once failed."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import HealthCheck, Phase, given, settings

from .fuzz import FOUND
from .generate import studies
from .verdict import Tally, faults_in


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    return tmp_path_factory.mktemp("fuzz")


@settings(
    max_examples=40, deadline=None, derandomize=True, database=None, phases=[Phase.generate, Phase.shrink],
    suppress_health_check=list(HealthCheck),
)  # fmt: skip
@given(studies())
def test_random_studies(folder, text):
    """About 200 scenes. Fails if one ends in a NaN, an open ledger, a traceback or an outcome without advice."""
    path = folder / "study.yaml"
    path.write_text(text, encoding="utf-8")
    assert faults_in(path, Tally()) == []


@pytest.mark.parametrize("path", sorted(FOUND.glob("*.yaml")), ids=lambda p: p.stem)
def test_found(path):
    """Fails if a study that once failed fails again."""
    assert faults_in(path, Tally()) == []
