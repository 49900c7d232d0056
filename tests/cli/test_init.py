"""`pound init`: every template is a sound study, its comments tell the truth, and what it says to do next works."""

from __future__ import annotations

import re
import sys

import click
import pytest
import yaml

from pounding_cli.cli.init import command
from pounding_cli.cli.main import main
from pounding_cli.study import load_study
from pounding_cli.study.kinds import load_for
from pounding_cli.study.template import TEMPLATES, start_study


@pytest.fixture
def pound(tmp_path, monkeypatch, capsys):
    """`pound ARGUMENTS` in an empty folder: exit code, stdout, stderr."""
    monkeypatch.chdir(tmp_path)

    def call(*arguments: str) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["pound", *arguments])
        with pytest.raises(SystemExit) as end:
            main()
        captured = capsys.readouterr()
        return int(end.value.code or 0), captured.out, captured.err

    return call


def test_help_lists_the_templates():
    (option,) = [p for p in command.params if isinstance(p.type, click.Choice)]
    assert tuple(option.type.choices) == tuple(TEMPLATES)
    for name, template in TEMPLATES.items():
        assert re.search(rf"{name} +{re.escape(template.text)}", command.help)


@pytest.mark.parametrize("name", TEMPLATES)
def test_templates_are_sound_and_carry_the_name(pound, tmp_path, name):
    code, out, _ = pound("init", "deep/er/two_towers", "--template", name)
    assert code == 0
    path = tmp_path / "deep" / "er" / "two_towers.yaml"
    study = load_for(path, TEMPLATES[name].command)
    assert study.title == "Two towers"
    assert f"pound {TEMPLATES[name].command} deep/er/two_towers.yaml" in out
    assert pound("check", "deep/er/two_towers.yaml")[0] == 0
    named = "$schema=pound.schema.json" in path.read_text()
    assert named == (path.parent / "pound.schema.json").is_file() == (TEMPLATES[name].command == "run")


def test_what_it_says_to_do_next_works(pound):
    _, out, _ = pound("init", "my-study")
    told = re.findall(r"^  (pound .*?)   ", out, flags=re.MULTILINE)
    assert [line.split()[1] for line in told] == ["check", "run", "show", "report"]
    code, out, err = pound(*told[0].split()[1:])
    assert (code, err) == (0, "")
    assert "2 cases x 2 analyses x 3 records" in out
    assert all("my-study" in line for line in told)


@pytest.mark.parametrize("name", ["pair", "measures"])
def test_commented_keys_show_their_defaults(tmp_path, name):
    """With the # taken away from every key that shows its default, the study stays what it was."""
    path, _ = start_study(str(tmp_path / "a"), name)
    text = path.read_text()
    sweep = text.find("\n# sweep:")
    plain, swept = (text[:sweep], text[sweep:]) if sweep >= 0 else (text, "")
    opened, count = re.subn(r"^( *)# (\w+: .*?)$", r"\1\2", plain.split("\n", 4)[-1], flags=re.MULTILINE)
    assert count == (10 if name == "pair" else 0)
    (tmp_path / "b.yaml").write_text(opened)
    first, second = load_study(path).resolved(), load_study(tmp_path / "b.yaml").resolved()
    for building in (*first["buildings"].values(), *second["buildings"].values()):
        building["yield"] = {**building["yield"], "Rw": building["yield"]["Rw"] or 12.0}  # None stands for 12
    assert first == second
    if swept:
        (tmp_path / "c.yaml").write_text(text[:sweep] + swept.replace("\n# ", "\n"))
        (axis,) = load_study(tmp_path / "c.yaml").axes
        assert axis.values == ((0.01,), (0.03,), (0.05,))


@pytest.mark.parametrize("name", ["null", "3", 'a "quoted" one', "ναός", "1.5"])
def test_any_name_gives_a_text_as_title(tmp_path, name):
    path, _ = start_study(str(tmp_path / name))
    assert yaml.safe_load(path.read_text())["title"] == path.stem[0].upper() + path.stem[1:]


def test_nothing_is_overwritten(pound, tmp_path):
    (tmp_path / "mine.yaml").write_text("precious")
    code, out, err = pound("init", "mine")
    assert (code, out) == (2, "")
    assert "mine.yaml: is there already\n    choose another name" in err
    assert (tmp_path / "mine.yaml").read_text() == "precious"
    assert not (tmp_path / "pound.schema.json").exists()


@pytest.mark.parametrize(("name", "said"), [("mine.yaml/a", "cannot be written"), ("-", "names no file")])
def test_a_place_that_takes_no_file_is_refused(pound, tmp_path, name, said):
    (tmp_path / "mine.yaml").write_text("precious")
    code, _, err = pound("init", "--", name)
    assert code == 2
    assert said in err
