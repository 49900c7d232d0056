"""A real browser over the report's page."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from tests.helpers.page_study import KEPT, report

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
FLAGS = [
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
]  # fmt: skip


@pytest.fixture(scope="session")
def study(tmp_path_factory):
    """`study(name, extra)`: the folder of a report on a study with `extra` lines, made once a session."""
    made: dict[str, Path] = {}

    def make(name: str, extra: str = "", **options) -> Path:
        if name not in made:
            made[name] = report(tmp_path_factory.mktemp(name), extra, **options)
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
def visit(browser):
    """`visit(file, width, ...)`: the page of a file, ready; its errors and requests must be none at the end."""
    contexts, wrong, asked = [], [], []

    def go(file: Path, width: int = 1280, scripts: bool = True, **options):
        context = browser.new_context(
            viewport={"width": width, "height": 900}, java_script_enabled=scripts, accept_downloads=True, **options
        )
        contexts.append(context)
        page = context.new_page()
        page.set_default_timeout(10_000)
        page.on("pageerror", lambda error: wrong.append(error.stack))
        page.on("console", lambda message: wrong.append(message.text) if message.type in ("error", "warning") else None)
        page.on("request", lambda request: asked.append(request.url))
        page.goto(file.as_uri())
        if scripts:
            page.wait_for_selector("html.ready")
        return page

    yield go
    for context in contexts:
        context.close()
    assert wrong == []
    assert [url for url in asked if not url.startswith(("file:", "data:", "blob:"))] == []


@pytest.fixture
def moving(study, visit):
    """The page of a study with two kept scenes."""
    return visit(study("moving", kept=KEPT) / "report.html")
