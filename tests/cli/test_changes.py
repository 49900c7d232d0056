"""Values changed by arguments of a command, KEY=VALUE: as if they stood in the file, whatever command takes them."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import yaml
from click.testing import CliRunner

from pounding_cli import InputError, load_study, open_results, run
from pounding_cli.cli.main import cli
from pounding_cli.study import make_plan
from pounding_cli.study.vary.changes import name_changes, parse_changes

ROOT = Path(__file__).parents[2]

STUDY = """\
title: Two small buildings   # of a test
records: {use: [elcentro, taft], duration: 1 s, scale: 0.5}
buildings:
  stiff: {storeys: 2, period: 0.3 s, mass: 200 t}
  soft: {like: stiff, period: 0.5 s}   # the softer one
group: [stiff, soft]
impact: {restitution: 0.5}
cases:
  gap: {link: pounding, gap: 5 mm}
  tied: {gap: 5 cm, links: [{link: pounding}, {link: connector, floors: 2}]}
analyses: [elastic]
estimate: none
"""
SWEPT = f"""{STUDY}\
sweep:
  - {{cases.gap.gap: [5 mm, 6 mm], buildings.soft.period: [0.5 s, 0.6 s]}}
  - {{impact.restitution: [0.4, 0.6]}}
"""
DRAWN = f"""{STUDY}\
uncertain:
  cases.gap.gap: {{uniform: {{from: 1 mm, to: 5 mm}}}}
  buildings.soft.mass: {{uniform: {{from: 100 t, to: 200 t}}}}
sensitivity: {{outputs: [largest V], samples: 4}}
"""


def test_a_changed_study_is_the_study_with_the_value_in_its_file(folder, pound):
    """Fails if an argument gives other time histories than the same value in the file, or the study that is kept
    does not run as it is, or loses its comments."""
    arguments = ["cases.gap.gap=4 mm", "buildings.soft.yield.overstrength=2", "cases.tied.links.1.stiffness=3 kN/mm"]
    assert pound("run", "two.yaml", *arguments, "accuracy=1e-5", "-q", "-o", "changed.h5")[0] == 0
    written = STUDY.replace("gap: 5 mm", "gap: 4 mm").replace(
        "period: 0.5 s", "period: 0.5 s, yield: {overstrength: 2}"
    )
    written = written.replace("floors: 2", "floors: 2, stiffness: 3 kN/mm") + "accuracy: 1e-5\n"
    Path("written.yaml").write_text(written)
    again = pound("show", "changed.h5", "--study")[1]
    Path("again.yaml").write_text(again)
    digests = [make_plan(load_study(name)).digests.tobytes() for name in ("written.yaml", "again.yaml")]
    changed = load_study("two.yaml", dict(argument.split("=", 1) for argument in [*arguments, "accuracy=1e-5"][:3]))
    assert digests[0] == digests[1] == make_plan(changed).digests.tobytes()
    assert "# of a test" in again
    assert "# the softer one" in again
    assert "gap: {link: pounding, gap: 4 mm}" in again
    assert yaml.safe_load(again)["buildings"]["soft"]["yield"] == {"overstrength": 2}
    assert re.search("^accuracy: 1e-5$", again, re.MULTILINE)
    assert open_results("changed.h5").study_text == again
    assert Path("two.yaml").read_text() == STUDY


def test_runs_with_other_values_stand_beside_each_other(folder, pound):
    """Fails if a run replaces the results of another value, or solves what the run of the study itself has solved."""
    assert "8 solved, 0 reused" in pound("run", "two.yaml")[1]
    assert "2 solved, 6 reused" in pound("run", "two.yaml", "cases.gap.gap=4 mm")[1]
    assert "2 solved, 6 reused" in pound("run", "two.yaml", "cases.gap.gap=3 mm")[1]
    names = {path.name for path in Path("results").glob("*.h5")}
    assert names == {"two.h5", "two-cases.gap.gap=4-mm.h5", "two-cases.gap.gap=3-mm.h5"}
    Path("results/two.h5.cache").unlink()  # what was taken from there stays
    assert "0 solved, 8 reused" in pound("run", "two.yaml", "cases.gap.gap=4 mm", "--replace")[1]
    checked = pound("check", "two.yaml", "cases.gap.gap=4 mm")[1]
    assert "all solved: results/two-cases.gap.gap=4-mm.h5 is current" in checked
    assert "gap 4 mm," in checked
    assert pound("report", "results/two-cases.gap.gap=4-mm.h5", "--no-figures", "-q")[0] == 0
    assert Path("results/two-cases.gap.gap=4-mm/report.html").is_file()


def test_the_name_of_results_tells_values_apart():
    """Fails if two values have one name, the order of arguments matters, or a name is no file's."""
    alike = [["a.b=1", "c=4 cm"], ["c=4  cm", "a.b=1"]]
    assert {name_changes(parse_changes(each)) for each in alike} == {"a.b=1,c=4-cm"}
    values = [
        "4 cm",
        "4-cm",
        "-4 cm",
        "4 cm2",
        "4cm",
        "1/3",
        "1-3",
        "[1, 2]",
        "[1 2]",
        "a b",
        "a-b",
        "'4 cm'",
        "../x",
        "é",
    ]
    values += ["x" * 300, "x" * 301]
    names = [name_changes(parse_changes([f"cases.gap.gap={value}"])) for value in values]
    assert len(set(names)) == len(values)
    assert all(re.fullmatch(r"[A-Za-z0-9._+=,-]{1,80}", name) for name in names)


NAMED = "argument {}: "
REFUSED = [
    ("cases.gap.gap='4 cmm'", "gap: 'cmm' is not a unit", "write a gap [m] at least 0 m"),
    ("cases.gap.gpa='4 cm'", "unknown key 'gpa'", "did you mean 'gap'?"),
    ("cases.gpa.gap='4 cm'", "no key 'gpa' under 'cases'", "did you mean 'gap'?"),
    ("acuracy=1e-8", "unknown key 'acuracy'", "did you mean 'accuracy'?"),
    ("soft.period='0.4 s'", "no key 'soft'", "write the whole key, `buildings.soft.period`"),
    ("period='0.4 s'", "no key 'period'", "write the whole key, `buildings.stiff.period`"),
    (
        "records.scale.pga='0.3 g'",
        "'records.scale' is '0.5', which has no keys",
        "write it whole: `records.scale='{pga: ...}'`",
    ),
    ("cases.tied.links.2.gap='1 cm'", "no entry '2' in the list 'cases.tied.links'", "known: 0, 1"),
    (
        "cases.gap.links.0.gap='1 cm'",
        "no key '0' under 'cases.gap.links'",
        "a list is written whole where the file has none: `cases.gap.links='[...]'`",
    ),
    ("group.1=sotf", "no building 'sotf' is defined", "did you mean 'soft'?"),
    ("cases.gap.gap='[4 cm, 5 cm'", "the value is not YAML", "brackets"),
    ("cases.gap.gap=", "has no value", "`null` stands for no value"),
    ("cases.gap.gap", "is not KEY=VALUE", "write the key, =, and the value"),
    ("other.yaml", "is a second study", "give one study"),
    ("sweep.cases.gap.gpa='[1 cm]'", "no key 'gpa' under 'cases.gap'", "did you mean 'gap'?"),
    ("cases.new='{link: pounding, gap: 4 cm, gpa: 3}'", "unknown key 'gpa'", "did you mean 'gap'?"),
    ("buildings.soft.like=sitff", "no building 'sitff' is defined", "did you mean 'stiff'?"),
    ("method=newmark", "newmark needs 'time_step'", "write e.g. `time_step:"),
]


def unquoted(argument: str) -> str:
    """Return an argument as a shell hands it to a program."""
    return argument.replace("'", "")


@pytest.mark.parametrize(("argument", "message", "hint"), REFUSED, ids=[row[0] for row in REFUSED])
def test_a_wrong_argument_is_refused_by_its_name(folder, pound, argument, message, hint):
    """Fails if a message names a line of the file, which is sound, or no argument."""
    code, out, err = pound("check", "two.yaml", unquoted(argument))
    assert (code, out) == (2, "")
    first, second = err.splitlines()
    assert first.startswith(f"error: argument {argument}: {message}") or (
        first.startswith(f"error: argument {argument}: ") and message in first
    )
    assert hint in second


def test_arguments_beside_each_other_are_refused(folder, pound):
    """Fails if one of two values of a key has no effect, or a value is cut at a blank that a shell takes."""
    for pair in (["accuracy=1e-8", "accuracy=1e-9"], ["cases.gap.gap=1 cm", "cases.gap={link: none}"]):
        code, _, err = pound("run", "two.yaml", *pair)
        assert code == 2
        assert re.match(r"error: argument (\S+).*: changes what argument .* changes too\n    write one of the two", err)
    code, _, err = pound("run", "two.yaml", "cases.gap.gap=4", "cm")
    assert (code, err.splitlines()[1].strip()) == (2, "put quotes around a value with blanks: `cases.gap.gap='4 cm'`")
    code, _, err = pound("run", "two.yaml", "cases.gap.gpa=4 cm", "buildings.soft.perod=1")
    assert (code, err.count("error: argument ")) == (2, 2)


def test_a_key_of_the_sweep_is_changed_there(folder, pound):
    """Fails if a value has no effect since the sweep sets its key, or what to write instead is refused."""
    Path("two.yaml").write_text(SWEPT)
    code, _, err = pound("run", "two.yaml", "impact.restitution=0.7")
    assert code == 2
    assert "argument impact.restitution=0.7: the sweep gives 'impact.restitution' its values" in err
    (instead,) = re.findall("`(.*)`", err)
    assert instead == "sweep.impact.restitution='[0.7]'"
    assert "sweep      impact.restitution: 0.7\n" in pound("check", "two.yaml", unquoted(instead))[1]
    code, _, err = pound("check", "two.yaml", "sweep.cases.gap.gap=[1 mm, 2 mm, 3 mm]")
    assert (code, "need as many values each: cases.gap.gap has 3" in err) == (2, True)
    assert "sweep point" not in pound("check", "two.yaml", "sweep=null", "impact.restitution=0.7")[1]


def test_warnings_and_refusals_of_swept_values_name_the_argument(folder, pound):
    """Fails if a warning of a changed value names a line of the file, or a sweep in an argument is placed there."""
    err = pound("check", "two.yaml", "cases.gap.gap=2 m")[2]
    assert err.startswith("warning: argument cases.gap.gap='2 m': [value] gap is 2 m")
    code, _, err = pound("check", "two.yaml", "sweep.buildings.soft.period=[0.5 s, 50 h]")
    assert code == 2
    assert err.startswith("error: argument sweep.buildings.soft.period='[0.5 s, 50 h]': ")
    Path("two.yaml").write_text(STUDY.replace("period: 0.5 s", "perod: 0.5 s"))
    code, _, err = pound("check", "two.yaml", "cases.gap.gap=2 mm")
    assert err.startswith("error: two.yaml:5:23: unknown key 'perod'")


COMMANDS = ("run", "check", "gap", "fragility", "sensitivity", "optimise", "accuracy", "connector", "wall", "cite")


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_that_takes_a_study_takes_its_values(folder, pound, name):
    """Fails if a command takes no values, or its help does not say so."""
    code, _, err = pound(name, "two.yaml" if name not in ("connector", "wall") else points(name), "titel=x")
    assert code == 2
    assert err.startswith("error: argument titel=x: ")
    assert "did you mean 'title'?" in err
    help_text = CliRunner().invoke(cli, [name, "--help"]).output
    assert "[KEY=VALUE]..." in help_text
    assert "KEY=VALUE puts a value in place of that of STUDY" in " ".join(help_text.split())


def points(name: str) -> Path:
    """Return a study that ships of a command that solves points."""
    return ROOT / "configs" / {"connector": "fig5.yaml", "wall": "fig8.yaml"}[name]


def test_points_of_the_paper_take_values(folder, pound):
    """Fails if the value of a point command is not used, its results have the name of another, or a study is lost."""
    pound("init", "pair", "-t", "connector")
    text = Path("pair.yaml").read_text()
    root = yaml.safe_load(text)
    key = "first.damping" if "damping" in root["first"] else f"first.{next(iter(root['first']))}"
    section, inner = key.split(".")
    value = root[section][inner]
    code, out, _ = pound("connector", "pair.yaml", f"{key}={value}", "title=Changed")
    assert code == 0
    assert out.startswith("Changed")
    (file,) = Path("results").glob("*.h5")
    assert file.name.startswith(f"pair-{key}=")
    code, _, err = pound("connector", "pair.yaml", "firts.damping=1")
    assert (code, "did you mean 'first'?" in err) == (2, True)


def test_a_drawn_key_is_not_changed_in_vain(folder, pound):
    Path("two.yaml").write_text(DRAWN)
    code, _, err = pound("sensitivity", "two.yaml", "cases.gap.gap=4 mm")
    assert code == 2
    assert "argument cases.gap.gap='4 mm': has no effect: under `uncertain:`" in err
    assert pound("check", "two.yaml", "cases.gap.gap=4 mm", "uncertain.cases.gap.gap.uniform.to=9 mm")[0] == 0


def test_values_change_in_python(folder):
    """Fails if a value is not checked at its key, is not used, or the results have the name of the study."""
    with pytest.raises(InputError) as refused:
        load_study("two.yaml", {"cases.gap.gap": "4 cmm"})
    assert str(refused.value).startswith("cases.gap.gap: 'cmm' is not a unit")
    study = load_study("two.yaml", {"cases.gap.gap": 0.004, "group": ["soft", "stiff"]})
    (link, _) = study.links((), "gap")
    assert (link.gap, study.spec.group) == (0.004, ("soft", "stiff"))
    run(load_study("two.yaml", {"cases.gap.gap": "4 mm"}), workers=1)
    assert Path("results/two-cases.gap.gap=4-mm.h5").is_file()
    data = yaml.safe_load(STUDY)
    assert load_study(data, {"cases.gap.gap": "4 mm"}).links((), "gap")[0].gap == 0.004
