"""Junk in, `InputError` out: no mutation of a study raises anything else, in loading or in expansion."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from pounding_cli.errors import InputError
from pounding_cli.study import expand, load_study

FIG6 = Path("configs/fig6.yaml").read_text(encoding="utf-8")
SWEPT = FIG6.replace("elcentro, taft, eureka, olympia, parkfield", "elcentro") + (
    "sweep:\n  impact.restitution: [0.4, 0.6]\n  buildings.soft.period: [0.5 s]\n"
)
WORDS = [
    "", "~", "null", "true", "no", "0", "-1", "1e10", "1e999", ".nan", ".inf", "-.inf", "0:36", "[]",
    "{}", "[[]]", "{a: 1}", "[1, 2]", "5 cm", "5 kg", "1/0", "1/3", "5 %", "none", "pounding", "infill",
    "connector", "all", "never", "table1", "whole", "{arias: taft}", "{pga: 0}", "stiff", "soft",
    "like", "fixed", "{link: infill}", "!!int x", "&a [*a]", "*b", "é", "\t", "'", "\"",
    "20 x stiffest storey of soft", "mean storey", "[3, 5]", "[soft, stiff, soft]", "[stiff]",
    "UBC-1985", "{K: 1}", "99",
]  # fmt: skip
TOKENS = [part for part in dict.fromkeys(SWEPT.replace(",", " ").replace("{", " ").replace("}", " ").split()) if part]


def attempt(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8", errors="surrogatepass")
    try:
        expand(load_study(path))
    except InputError as refused:
        problems = refused.problems
    else:
        return
    assert problems
    assert all(problem.message and problem.file for problem in problems)


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    return tmp_path_factory.mktemp("junk") / "study.yaml"


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(st.tuples(st.sampled_from(TOKENS), st.sampled_from(WORDS + TOKENS)), min_size=1, max_size=3))
def test_words_replaced(path, changes):
    text = SWEPT
    for old, new in changes:
        text = text.replace(old, new, 1)
    attempt(path, text)


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    st.integers(0, len(SWEPT)),
    st.integers(0, 12),
    st.text(st.characters(exclude_categories=("Cs",)), max_size=6) | st.sampled_from(WORDS),
)
def test_characters_replaced(path, start, length, new):
    attempt(path, SWEPT[:start] + new + SWEPT[start + length :])


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.data())
def test_lines_dropped_doubled_and_moved(path, data):
    lines = SWEPT.splitlines(keepends=True)
    for _ in range(data.draw(st.integers(1, 4))):
        place = data.draw(st.integers(0, len(lines) - 1))
        line = lines.pop(place)
        if data.draw(st.booleans()):
            lines.insert(data.draw(st.integers(0, len(lines))), line)
        if data.draw(st.booleans()):
            lines.insert(place, line.lstrip())
        if not lines:
            break
    attempt(path, "".join(lines))
