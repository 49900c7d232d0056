"""A real browser over the report's page of studies that are run here."""

from __future__ import annotations

import contextlib
import shutil
from pathlib import Path

import pytest
from click.testing import CliRunner

import pounding_cli
from pounding_cli.cli.main import cli

STUDY = """\
title: Two buildings <known> & small
statements: [{says: the infill lowers the response, holds: mean V_ratio in case infill < mean V_ratio in touching}]
records: {use: [elcentro, taft], duration: 3 s}
buildings:
  stiff: {storeys: 3, period: 0.3 s, mass: 200 t}
  soft: {like: stiff, storeys: 2, period: 0.5 s}
group: [stiff, soft]
cases:
  touching: {link: pounding, gap: 0 cm}
  gap: {link: pounding, gap: 5 mm}
  infill: {link: infill, gap: 5 mm, stiffness: 1/5 mean storey of stiff}
  connected: {link: connector, gap: 1 mm, floors: [2], stiffness: 1 kN/mm}
analyses: [elastic, inelastic]
"""
SWEEP = "estimate: none\nsweep: {cases.gap.gap: [5 mm, 6 mm, 7 mm], impact.restitution: [0.4, 0.6]}\n"
ONE = STUDY[: STUDY.index("  infill:")] + "analyses: [inelastic]\nestimate: none\n"
UNCERTAIN = (
    "uncertain: {impact.restitution: {uniform: {from: 0.4, to: 0.7}}, "
    "buildings.soft.period: {normal: {mean: 0.5 s, sd: 0.03 s}}}\n"
)
TWISTED = """\
title: A corner that twists
records: {use: [elcentro], duration: 3 s}
buildings:
  corner:
    storeys: 3
    period: 0.4 s
    plan: {width: 20 m, depth: 10 m, lines: [{y: -8 m, stiffness: 70 %}, {y: 8 m, stiffness: 30 %}]}
  soft:
    storeys: 2
    period: 0.6 s
    plan: {width: 16 m, depth: 12 m, shift: 3 m, eccentricity: 10 %, frequency_ratio: 1.1}
group: [corner, soft]
cases:
  touching: {link: pounding, gap: 5 mm}
  joined: {link: connector, gap: 20 cm, stiffness: 1 kN/mm}
analyses: [inelastic]
estimate: none
keep: {histories: {}}
"""
STUDIES = {
    "twisted": ("run", TWISTED),
    "kept": ("run", STUDY + "keep: {histories: {cases: [touching], records: [elcentro]}}\n"),
    "swept": ("run", STUDY + SWEEP),
    "failed": ("run", STUDY + "method: central-difference\ntime_step: 20 ms\n"),
    "gap": ("gap", STUDY + SWEEP),
    "fragility": (
        "fragility",
        ONE + "sweep: {records.scale.pga: [0.1 g, 0.2 g, 0.4 g]}\nfragility: {limits: [mu > 2]}\n",
    ),
    "sensitivity": (
        "sensitivity",
        ONE + UNCERTAIN + "sensitivity: {outputs: [largest V_ratio], samples: 16, draws: 100}\n",
    ),
    "optimise": (
        "optimise",
        ONE + "optimise: {case: gap, generations: 2, population: 8, slice_points: 5, least: largest drift,"
        " over: {cases.gap.gap: {from: 1 mm, to: 3 cm}}}\n",
    ),
}
"""Command and study of every page."""

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
FLAGS = [
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
]  # fmt: skip


@pytest.fixture(scope="session")
def reports(tmp_path_factory):
    """`reports(name)`: the results of a study and the file of its page, made once a session."""
    made: dict[str, tuple[pounding_cli.Results, Path]] = {}

    def make(name: str) -> tuple[pounding_cli.Results, Path]:
        if name not in made:
            folder = tmp_path_factory.mktemp(name)
            command, study = STUDIES[name]
            (folder / "study.yaml").write_text(study)
            figures = ["--format", "svg"] if name in ("kept", "twisted") else ["--no-figures"]
            for arguments in (
                [command, "study.yaml", "-o", "study.h5", "-q", "--engine", "serial"],
                ["report", "study.h5", "-o", "page", "-q", *figures],
            ):
                with contextlib.chdir(folder):
                    CliRunner().invoke(cli, arguments, catch_exceptions=False)
            made[name] = pounding_cli.open_results(folder / "study.h5"), folder / "page" / "report.html"
        return made[name]

    return make


@pytest.fixture(scope="session")
def browser():
    """Chromium, without a window."""
    sync_api = pytest.importorskip("playwright.sync_api")
    path = next(filter(None, map(shutil.which, BROWSERS)), None)
    if path is None:
        pytest.skip(f"no browser on the PATH: none of {', '.join(BROWSERS)}")
    with sync_api.sync_playwright() as started:
        opened = started.chromium.launch(executable_path=path, args=FLAGS)
        yield opened
        opened.close()


@pytest.fixture
def visit(browser, reports):
    """`visit(name, width, ...)`: the page of a study, ready; its errors and requests must be none at the end."""
    contexts, wrong, asked = [], [], []

    def go(name: str, width: int = 1280, scripts: bool = True, **options):
        context = browser.new_context(
            viewport={"width": width, "height": 900}, java_script_enabled=scripts, accept_downloads=True, **options
        )
        contexts.append(context)
        page = context.new_page()
        page.set_default_timeout(10_000)
        page.on("pageerror", lambda error: wrong.append(error.stack))
        page.on("console", lambda message: wrong.append(message.text) if message.type in ("error", "warning") else None)
        page.on("request", lambda request: asked.append(request.url))
        page.goto(reports(name)[1].as_uri())
        if scripts:
            page.wait_for_selector("html.ready")
        return page

    yield go
    for context in contexts:
        context.close()
    assert wrong == []
    assert [url for url in asked if not url.startswith(("file:", "data:", "blob:"))] == []
