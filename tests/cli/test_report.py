"""`pound report`: what it writes and prints, and what it refuses."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pandas as pd
import pytest

from pounding_cli.batch import run_plan
from pounding_cli.solve.response import BuildingResponse, LinkResponse, Response
from pounding_cli.study import expand, load_study
from tests.helpers.pages import words
from tests.helpers.two_buildings import FOUR_CASES as STUDY
from tests.helpers.two_buildings import write_motions

FACTOR = {"pounding": 1.5, "infill": 1.4, "connector": 1.3}


def known(scene, accuracy=1e-6, **_):
    """V/V0 and mu/mu0 are FACTOR of the first link's law everywhere; accelerations are its tenth power."""
    factor = FACTOR[scene.links[0].kind] if scene.links else 1.0
    found = []
    for building in scene.buildings:
        one = np.full(building.storeys, scene.motion.pga)
        found.append(
            BuildingResponse(
                1e6 * factor * one, 0.01 * factor * one, factor * one, factor**10 * one, one, -one, 0 * one
            )
        )
    n = np.ones(len(scene.links))
    flags = ("connector closed beyond its gap",) if factor == 1.3 else ()
    links = LinkResponse(n, 1e6 * n, 0.005 * n, n, n)
    return Response(tuple(found), links, "done", "", "taylor", accuracy, 1, 1, 1e-4, flags=flags)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder to stand in, with the results `two.h5` and `swept.h5`."""
    monkeypatch.chdir(tmp_path)
    write_motions(tmp_path)
    (tmp_path / "two.yaml").write_text(STUDY)
    (tmp_path / "swept.yaml").write_text(STUDY + "sweep: {impact.restitution: [0.4, 0.5, 0.65]}\n")
    for name in ("two", "swept"):
        run_plan(expand(load_study(tmp_path / f"{name}.yaml")), tmp_path / f"{name}.h5", solve=known, workers=1)
    return tmp_path


def test_report_stands_beside_the_results_unless_said_otherwise(folder, pound):
    code, out, err = pound("report", "two.h5", "--format", "svg")
    assert (code, err) == (0, "")
    assert out.splitlines()[0].startswith("two/report.html: ")
    assert "  connection-stiffer     holds partly" in out.splitlines()
    assert {path.name for path in (folder / "two").glob("*.*")} == {
        "report.html", "stiff-response.svg", "stiff-accelerations.svg", "soft-response.svg",
        "soft-accelerations.svg", "link-forces.svg",
    }  # fmt: skip
    read = pd.read_csv(folder / "two" / "tables" / "storey.csv")
    assert set(read.loc[read["case"] == "infill", "V_ratio"].round(12)) == {1.4}


def test_page_carries_the_numbers_of_the_file(folder, pound):
    pound("report", "two.h5", "-o", "here", "--no-figures", "-q")
    page = words(folder / "here" / "report.html")
    row = page.split(" connected 1.30 storey 1 ")[1]
    assert row.count(", 13.8×") >= 4  # both buildings, both analyses
    assert "Flags connected, elastic, 2 of 2 scenes (all): connector closed beyond its gap" in page
    assert "Motions: user, unit g assumed: weak, strong." in page
    # 1 - (1.4 / 1.5)^10 = 49.8 %, short of 80 %.
    assert "misses its threshold: reduction of accelerations, infill against touching, elastic, mean over the" in page
    assert "over the floors 50 %" in page


def test_sweep_adds_the_claims_at_every_point(folder, pound):
    code, out, _ = pound("report", "swept.h5", "--no-figures")
    assert code == 0
    page = (folder / "swept" / "claims-sensitivity.md").read_text(encoding="utf-8")
    heads = "impact.restitution = 0.4 | impact.restitution = 0.5 | impact.restitution = 0.65"
    assert f"| claim | {heads} |" in page
    # The swept key is written with its value 0.5 outside the sweep: that point is the one shown.
    assert "At impact.restitution = 0.5." in words(folder / "swept" / "report.html")
    assert "holds" not in out


def test_several_files_are_compared_on_one_page(folder, pound):
    code, out, _ = pound("report", "two.h5", "swept.h5", "-o", "both", "--no-figures")
    assert code == 0
    assert out.splitlines()[-1] == "both/comparison.md"
    page = (folder / "both" / "comparison.md").read_text(encoding="utf-8")
    assert "| claim | two | swept: impact.restitution = 0.4 |" in page
    assert (folder / "both" / "two" / "report.html").is_file()
    assert (folder / "both" / "swept" / "report.html").is_file()


def test_files_of_one_name_keep_their_reports_apart(folder, pound):
    (folder / "other").mkdir()
    (folder / "other" / "two.h5").write_bytes((folder / "two.h5").read_bytes())
    assert pound("report", "two.h5", "other/two.h5", "-o", "both", "--no-figures", "-q") == (0, "", "")
    assert (folder / "both" / "two" / "report.html").is_file()
    assert (folder / "both" / "two-2" / "report.html").is_file()


def test_same_report_again_is_the_same_to_the_byte(folder, pound):
    for name in ("one", "again"):
        pound("report", "two.h5", "-o", name, "-q", "--format", "svg")
    for path in (folder / "one").rglob("*.*"):
        assert path.read_bytes() == (folder / "again" / path.relative_to(folder / "one")).read_bytes(), path.name


@pytest.mark.parametrize(("name", "content"), [("missing.h5", None), ("text.h5", b"not a results file"), (".", None)])
def test_what_is_no_results_file_is_refused(folder, pound, name, content):
    if content is not None:
        (folder / name).write_bytes(content)
    code, out, err = pound("report", name)
    assert code == 2
    assert out == ""
    assert err.startswith("error: ")
    assert "Traceback" not in err


def test_one_bad_file_stops_all_before_anything_is_written(folder, pound):
    code, _, _ = pound("report", "two.h5", "missing.h5", "-o", "both")
    assert code == 2
    assert not (folder / "both").exists()


def test_a_file_in_place_of_the_folder_is_refused(folder, pound):
    (folder / "taken").write_text("")
    code, _, err = pound("report", "two.h5", "-o", "taken", "--no-figures")
    assert code == 2
    assert "the output folder taken cannot be written" in err
    assert "with -o" in err


def test_help_has_an_example_and_loads_nothing_heavy():
    script = (
        "import sys; from click.testing import CliRunner; from pounding_cli.cli.main import cli\n"
        "out = CliRunner().invoke(cli, ['report', '--help']).output\n"
        "print(out); print([m for m in ('numba', 'scipy', 'pandas', 'matplotlib') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert "pound report results/fig6.h5" in done.stdout
    assert done.stdout.splitlines()[-1] == "[]"


def test_a_sweep_is_drawn_as_asked(folder, pound):
    (folder / "map.yaml").write_text(
        STUDY + "sweep: {impact.restitution: [0.4, 0.5], cases.gap.gap: [1 cm, 2 cm, 4 cm]}\n"
    )
    run_plan(expand(load_study(folder / "map.yaml")), folder / "map.h5", solve=known, workers=1)
    assert pound("report", "map.h5", "-q", "--format", "svg", "--no-page")[0] == 0
    names = {path.stem for path in (folder / "map").glob("*.svg")}
    assert {"stiff-map", "soft-map"} <= names
    asked = (
        "--quantity",
        "mu_ratio",
        "--case",
        "touching",
        "--building",
        "soft",
        "--storey",
        "2",
        "--at",
        "restitution=0.5",
    )
    assert pound("report", "map.h5", "-q", "--format", "svg", "--no-page", "-o", "asked", *asked)[0] == 0
    names = {path.stem for path in (folder / "asked").glob("*.svg")}
    assert "soft-mu_ratio-sweep" in names
    assert "soft-map" not in names


@pytest.mark.parametrize(
    ("arguments", "message", "hint"),
    [
        (["two.h5", "--quantity", "mu_ratio"], "nothing is swept", ""),
        (["swept.h5", "--quantity", "mu"], "", ""),
        (["swept.h5", "--quantity", "mue"], "there is no quantity 'mue'", "mu_ratio"),
        (["swept.h5", "--case", "gip"], "there is no case 'gip'", "touching, gap"),
        (["swept.h5", "--storey", "8"], "there is no storey 8", "1, 2, 3"),
        (["swept.h5", "--at", "restitution=0.7"], "does not take this value", "0.4, 0.5, 0.65"),
    ],
)
def test_what_cannot_be_drawn_over_a_sweep_is_refused(folder, pound, arguments, message, hint):
    code, _, err = pound("report", *arguments, "-q", "--no-page", "--format", "svg")
    assert code == (2 if message else 0)
    assert message in err
    assert hint in err
    if message:
        assert not (folder / arguments[0].removesuffix(".h5")).exists()


def test_a_target_spectrum_is_drawn_and_told(folder, pound):
    target = "scale: {spectrum: mean, target: {0.1 s: 0.8 g, 2 s: 0.2 g}, from: 0.2 s, to: 1 s, at_least: 0.9}"
    (folder / "spec.yaml").write_text(STUDY.replace("scale: 1.0", target))
    run_plan(expand(load_study(folder / "spec.yaml")), folder / "spec.h5", solve=known, workers=1)
    code, out, _ = pound("plan", "spec.yaml", "--no-prove")
    assert code == 0
    assert "a factor of" in out.splitlines()[-1]
    assert pound("report", "spec.h5", "-q", "--format", "png")[0] == 0
    assert (folder / "spec" / "target-spectrum.png").stat().st_size > 10_000
    assert out.splitlines()[-1].strip() in (folder / "spec" / "report.html").read_text(encoding="utf-8")
    assert pound("report", "two.h5", "-q", "--format", "png", "--no-page")[0] == 0
    assert not (folder / "two" / "target-spectrum.png").exists()
