"""Untrusted texts as file names, on the screen, in cells and in Markdown."""

from __future__ import annotations

import pandas as pd
import pytest

from pounding_cli.texts import cells, file_name, plain, plain_all, plain_tree, write_markdown

NASTY = (
    "../../../PWNED", "/etc/passwd", "..", ".", "", "   ", "...", "a/b", "a\\b", "C:\\x", "a\0b", "\x1b[31mred",
    "~root", "a\nb", "-rf", "\u202etxt.exe", "x" * 5000, "$HOME", "`ls`", "a;b|c&d", "\ud800", "CON", "ü" * 5000,
    "建" * 5000,
)  # fmt: skip


@pytest.mark.parametrize("text", NASTY)
def test_a_file_name_stays_in_its_folder(tmp_path, text):
    name = file_name(text)
    path = tmp_path / f"{name}.png"
    assert path.parent == tmp_path
    assert path.resolve().parent == tmp_path.resolve()
    path.write_text("it can be written")
    assert not name.startswith((".", "-", " "))
    assert not set(name) & set("/\\\0\n\x1b~$`;|&:<>*?\"'")


def test_a_file_name_keeps_what_names_are_made_of():
    assert file_name("stiff-1 (5 cm), µ=0.3+") == "stiff-1 -5 cm- µ-0.3+"


CONTROLS = {
    "\x1b[31mred": "\\x1b[31mred", "a\0b": "a\\x00b", "a\rb": "a\\rb", "\u202eabc": "\\u202eabc",
    "\x9b": "\\x9b", "\ud800": "\\ud800", "\x07": "\\x07",
}  # fmt: skip


@pytest.mark.parametrize("text", CONTROLS)
def test_control_characters_are_written_out(text):
    assert plain(text) == CONTROLS[text]
    assert plain_all(["good", text]) == ["good", CONTROLS[text]]
    assert plain_tree({text: [{"a": text}, 3]}) == {CONTROLS[text]: [{"a": CONTROLS[text]}, 3]}
    plain(text).encode()


def test_lines_tabs_and_letters_stay():
    text = "first\nsecond\r\n\tµ ± ½ 建物 🏢"
    assert plain(text) == text


@pytest.mark.parametrize("start", "=+-@\t\r")
def test_a_cell_is_no_formula(start):
    frame = pd.DataFrame({f"{start}head": [f"{start}1+1", "a=b", ""], "number": [-1.0, 2.0, 3.0]})
    found = cells(frame)
    assert list(found.columns) == [f"'{start}head", "number"]
    assert found.iloc[:, 0].tolist() == [f"'{start}1+1", "a=b", ""]
    assert found["number"].tolist() == [-1.0, 2.0, 3.0]
    assert frame.iloc[0, 0] == f"{start}1+1"  # the frame given is left as it was


def test_a_column_of_texts_and_numbers_keeps_its_numbers():
    found = cells(pd.DataFrame({"value": pd.Series([-1.5, "=1", "-x"], dtype=object)}))
    assert found["value"].tolist() == [-1.5, "'=1", "'-x"]


def test_categories_are_texts_too():
    found = cells(pd.DataFrame({"case": pd.Categorical(["=1", "b", "=1"])}))
    assert found["case"].tolist() == ["'=1", "b", "'=1"]


def test_markdown_has_no_html(tmp_path):
    path = write_markdown(
        tmp_path / "s.md", ["# <script>alert(1)</script>", "| a<br>b | <img src=x onerror=y> |", "", ""]
    )
    text = path.read_text()
    assert text == "# &lt;script>alert(1)&lt;/script>\n| a<br>b | &lt;img src=x onerror=y> |\n"


def test_a_text_without_a_letter_still_names_a_file():
    assert file_name("/ ..") == file_name("") == "unnamed"
