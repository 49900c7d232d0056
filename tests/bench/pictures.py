"""Pictures of the documentation that show reports, drawn from the studies that the documentation writes."""

from __future__ import annotations

import re
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

from tests.bench.pages import FIGURES, POUND, ROOT

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")

WIDTH = 1180
"""Width of the page on which the moving buildings are drawn [pixels]."""

ONLY_MOVING = """
.player > :not(.stage, canvas) { display: none !important }
.player { border: 0 !important; background: white !important }
"""
"""Style that leaves the buildings and their curves of the player."""


@dataclass(frozen=True)
class Picture:
    """A picture of the documentation that is a figure of a study's report.

    name : of the picture in docs/figures
    source : the study, or the page that writes it
    study : file that the page writes; "" where `source` is the study
    command : that solves it
    figure : of the report
    """

    name: str
    source: str
    study: str
    command: str
    figure: str


PICTURES = (
    Picture("first-study", "README.md", "two.yaml", "run", "stiff-response"),
    Picture("fig6-stiff", "configs/fig6.yaml", "", "run", "stiff-response"),
    Picture("isolators", "docs/how-to/isolation.md", "moat.yaml", "run", "isolators"),
    Picture("from-above", "docs/gallery/end-of-row.yaml", "", "run", "from-above"),
    Picture("rates", "docs/how-to/rate.md", "rate.yaml", "fragility", "fragility-rates"),
)

MOVING = "fig6-stiff"
"""The picture whose page has the moving buildings."""


def draw_pictures() -> None:
    """Write every picture into docs/figures.

    Raises `LookupError`: a page writes no such study, or there is no browser.
    """
    with tempfile.TemporaryDirectory() as folder:
        for picture in PICTURES:
            report = _write_report(picture, Path(folder) / picture.name)
            shutil.copy(report / f"{picture.figure}.png", FIGURES / f"{picture.name}.png")
            if picture.name == MOVING:
                _photograph_player(report / "report.html", FIGURES / "moving.png")


def read_study(picture: Picture) -> str:
    """Return the text of a picture's study.  Raises `LookupError`: the page writes no such study."""
    text = (ROOT / picture.source).read_text(encoding="utf-8")
    if not picture.study:
        return text
    written = re.search(rf"^cat > {re.escape(picture.study)} <<'END'\n(.*?)^END$", text, re.MULTILINE | re.DOTALL)
    if written is None:
        raise LookupError(f"{picture.source} writes no {picture.study}")
    return written[1]


def _write_report(picture: Picture, folder: Path) -> Path:
    """Solve the study of a picture in a folder, and return the folder of its report."""
    folder.mkdir()
    name = picture.study or Path(picture.source).name  # the title of a study without one
    (folder / name).write_text(read_study(picture), encoding="utf-8")
    for arguments in ([picture.command, name, "-o", "study.h5"], ["report", "study.h5", "-o", "report"]):
        subprocess.run([*POUND, *arguments, "-q"], cwd=folder, check=True)
    return folder / "report"


def _photograph_player(page: Path, picture: Path) -> None:
    """Write a picture of the moving buildings of a page, at the largest contact force of its first time history."""
    from playwright.sync_api import sync_playwright

    path = next(filter(None, map(shutil.which, BROWSERS)), None)
    if path is None:
        raise LookupError(f"no browser on the PATH: none of {', '.join(BROWSERS)}")
    with sync_playwright() as started:
        browser = started.chromium.launch(executable_path=path, args=["--headless", "--no-sandbox", "--disable-gpu"])
        opened = browser.new_page(viewport={"width": WIDTH, "height": 900}, color_scheme="light", bypass_csp=True)
        opened.goto(page.as_uri())
        opened.wait_for_selector("html.ready")
        opened.add_style_tag(content=ONLY_MOVING)
        opened.locator("#player").screenshot(path=picture)
        browser.close()
