"""The YAML reader: scalars by YAML 1.2, marks, and what is no YAML at all."""

from __future__ import annotations

import pytest

from pounding_cli.errors import InputError
from pounding_cli.study import load_study
from pounding_cli.study.yaml_file import read_source


@pytest.fixture
def read(tmp_path):
    def reads(text: str | bytes):
        path = tmp_path / "a.yaml"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return read_source(path)[1]

    return reads


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1e10", 1e10),
        ("1E-6", 1e-6),
        (".5", 0.5),
        ("5.", 5.0),
        ("-3", -3),
        ("007", 7),
        ("no", "no"),
        ("on", "on"),
        ("true", True),
        ("False", False),
        ("null", None),
        ("~", None),
        ("", None),
        ("0:36", "0:36"),
        ("1_000", "1_000"),
        ("0x10", "0x10"),
        ("2021-01-01", "2021-01-01"),
        ('"1"', "1"),
        ("'true'", "true"),
    ],
)
def test_scalars(read, text, value):
    found = read(f"a: {text}\n").plain()["a"]
    assert found == value
    assert type(found) is type(value)


def test_marks(read):
    root = read("a: 1\nb:\n  c: [x,\n      y]\n")
    assert root.locate(("a",)) == (1, 4)
    assert root.locate(("a",), key=True) == (1, 1)
    assert root.locate(("b", "c")) == (3, 6)
    assert root.locate(("b", "c", 1)) == (4, 7)
    assert root.locate(("b", "tag of a union", "c"), key=True) == (3, 3)
    assert root.locate(("b", "missing")) == (3, 3)


def test_replaced_leaves_the_original_alone(read):
    root = read("a: {b: [1, 2]}\n")
    new = read("x: 9\n").get("x")
    assert root.replaced(("a", "b", "1"), new).plain() == {"a": {"b": [1, 9]}}
    assert root.replaced(("a", "c", "d"), new).plain() == {"a": {"b": [1, 2], "c": {"d": 9}}}
    assert root.plain() == {"a": {"b": [1, 2]}}


def test_aliases_stand_for_their_anchor(read):
    assert read("a: &x [1]\nb: *x\n").plain() == {"a": [1], "b": [1]}


@pytest.mark.parametrize(
    ("text", "line", "column", "message", "hint"),
    [
        ("a: [1, 2\nb: 3\n", 2, 2, "not YAML", "brackets"),
        ("a: 1\n\tb: 2\n", 2, 1, "not YAML", "tabs"),
        ("a: b: c\n", 1, 5, "mapping values are not allowed", "quotes"),
        ("a: 1\n---\nb: 2\n", 2, 1, "single document", "---"),
        ("a: *nobody\n", 1, 4, "undefined alias", "* or &"),
        ("- 1\n- 2\n", 1, 1, "a study is a mapping", "title"),
        ("just words\n", 1, 1, "a study is a mapping", "title"),
        ("", 1, 1, "the file is empty", "quickstart"),
        ("# only a comment\n", 1, 1, "the file is empty", "quickstart"),
        ("a: 1\nb: 2\na: 3\n", 3, 1, "'a' occurs twice; first in line 1", "remove"),
        ("? [1]\n: 2\n", 1, 3, "a key must be a word", "key: value"),
        ("a: 1e999\n", 1, 4, "too large", "1e308"),
        ("a: &a [*a]\n", 1, 8, "undefined alias", "quotes"),
    ],
)
def test_what_is_no_study(read, text, line, column, message, hint):
    with pytest.raises(InputError) as caught:
        read(text)
    problem = caught.value.problems[0]
    assert (problem.line, problem.column) == (line, column)
    assert message in problem.message
    assert hint in problem.hint


@pytest.mark.parametrize(
    "text",
    [b"\xff\xfe\x00\x01", b"a: \x00\n", b"a: \x07\n", b"[" * 5000, b"{a: " * 200, "é: ü\n".encode("latin-1")],
)
def test_bytes_that_are_no_text(read, text):
    with pytest.raises(InputError):
        read(text)


def test_billion_laughs(read):
    bomb = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n"
    bomb += "".join(f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 10)}]\n" for i in range(1, 9))
    with pytest.raises(InputError, match="values"):
        read(bomb)


def test_missing_file_names_the_nearest(tmp_path):
    (tmp_path / "fig6.yaml").write_text("a: 1\n")
    with pytest.raises(InputError, match=r"did you mean .*fig6\.yaml"):
        load_study(tmp_path / "fig66.yaml")
    with pytest.raises(InputError, match="is a folder"):
        load_study(tmp_path)
