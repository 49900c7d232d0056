"""A report as one self-contained HTML page, and as a part of a notebook."""

from __future__ import annotations

import base64
import hashlib
import json
import re
from collections.abc import Mapping
from functools import cache
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pounding_cli import __version__
from pounding_cli.report.document import Report
from pounding_cli.report.style import data_address
from pounding_cli.tables import PAGE_ROWS

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SCRIPTS = ("parts.js", "explorer.js", "stage.js", "player.js", "main.js")
"""In the order they are needed."""


def write_page(report: Report, path: Path, drawn: Mapping[str, Figure]) -> Path:
    """Write the page; `drawn` : the figures by name, none where none are wanted."""
    kept = dict(drawn) | ({"group": report.sketch()} if report.sketch else {})
    sizes = {name: [round(96 * inches) for inches in figure.get_size_inches()] for name, figure in kept.items()}
    # A figure that fits stands beside the title: the first screen has the answer, the group, a figure and the table.
    first = [picture for picture in report.sections[0].pictures[:1] if picture.name in kept]
    beside = [picture for picture in first if sizes[picture.name][0] <= 760 and sizes[picture.name][1] <= 560]
    style = _asset("style.css")
    scripts = "(() => {\n'use strict';\n" + "\n".join(map(_asset, SCRIPTS)) + "\n})();"
    sections = [
        each for each in report.sections[1:]
        if each.sentences or each.tables or each.widget or any(picture.name in kept for picture in each.pictures)
    ]  # fmt: skip
    images = {name: data_address(figure, facecolor="none") for name, figure in kept.items()}
    text = _template("page.html.j2").render(
        report=report, sections=sections, images=images,
        sizes=sizes, beside=beside,
        most=PAGE_ROWS, version=__version__,
        data=as_json({each.widget: each.data for each in report.sections if each.data}),
        style=style, scripts=scripts,
        allowed_style=_allowed(style), allowed_scripts=_allowed(scripts),
    )  # fmt: skip
    path.write_text(text, encoding="utf-8")
    return path


def in_notebook(report: Report) -> str:
    """Title and answer as HTML, with the figures."""
    answer = report.sections[0]
    drawn = {picture.name: data_address(picture.draw()) for picture in answer.pictures}
    return str(_template("notebook.html.j2").render(report=report, answer=answer, images=drawn, most=PAGE_ROWS))


def as_json(data: Any) -> str:
    """JSON that may stand in a script element: no markup can end it early."""
    text = json.dumps(data, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")


def _allowed(source: str) -> str:
    """The source of a content security policy: this text by its hash, and no other."""
    return f"'sha256-{base64.b64encode(hashlib.sha256(source.encode()).digest()).decode()}'"


def _asset(name: str) -> str:
    """The text of a file in `assets/`."""
    return resources.files("pounding_cli.report").joinpath("assets", name).read_text(encoding="utf-8")


@cache
def _template(name: str) -> Any:
    import jinja2

    environment = jinja2.Environment(
        loader=jinja2.FunctionLoader(_asset), autoescape=True, trim_blocks=True, lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )  # fmt: skip
    environment.filters["keys_as_code"] = _keys_as_code
    return environment.get_template(name)


def _keys_as_code(text: str) -> Any:
    """A sentence whose keys of a study stand in backticks, as HTML."""
    import markupsafe

    return markupsafe.Markup(re.sub(r"`([^`]+)`", r"<code>\1</code>", str(markupsafe.escape(text))))
