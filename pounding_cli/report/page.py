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
from pounding_cli.report.document import Report, Section
from pounding_cli.report.page_tables import BREAK, fit_table
from pounding_cli.report.style import PAGE, data_address, drawing_for
from pounding_cli.texts import join_units

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SCRIPTS = ("parts.js", "explorer.js", "stage.js", "above.js", "player.js", "main.js")
"""The scripts of the page, in the order they are needed."""


def write_page(report: Report, path: Path, has_figures: bool = True) -> Path:
    """Write the page of a report; return its path.

    has_figures : whether the figures of its sections are drawn; the group always is
    """
    drawn = _draw_figures(report, has_figures)
    style = _read_asset("style.css")
    scripts = "(() => {\n'use strict';\n" + "\n".join(map(_read_asset, SCRIPTS)) + "\n})();"
    text = _load_template("page.html.j2").render(
        report=report,
        answer=report.sections[0],
        sections=[section for section in report.sections[1:] if _has_content(section, drawn)],
        images={name: data_address(figure, facecolor="none") for name, figure in drawn.items()},
        sizes={name: [round(96 * inches) for inches in figure.get_size_inches()] for name, figure in drawn.items()},
        captions={name: figure.get_label() for name, figure in drawn.items()},
        fit_table=fit_table,
        version=__version__,
        data=to_json({section.widget: section.data for section in report.sections if section.data}),
        style=style,
        scripts=scripts,
        allowed_style=_hash_source(style),
        allowed_scripts=_hash_source(scripts),
    )
    path.write_text(text, encoding="utf-8")
    return path


def _draw_figures(report: Report, has_figures: bool) -> dict[str, Figure]:
    """Return the figures of a page by name: without titles, captions and the group, which the page has itself."""
    drawn = {}
    with drawing_for(PAGE):
        if report.sketch:
            drawn["group"] = report.sketch()
        if has_figures:
            for section in report.sections:
                drawn |= {picture.name: picture.draw() for picture in section.pictures}
    return drawn


def _has_content(section: Section, drawn: Mapping[str, Figure]) -> bool:
    """Return whether there is something to show of a section."""
    has_figure = any(picture.name in drawn for picture in section.pictures)
    return bool(has_figure or section.sentences or section.tables or section.widget)


def to_notebook_html(report: Report) -> str:
    """Return title and answer as HTML, with the figures."""
    answer = report.sections[0]
    images = {picture.name: data_address(picture.draw()) for picture in answer.pictures}
    template = _load_template("notebook.html.j2")
    return str(template.render(report=report, answer=answer, images=images, fit_table=fit_table))


def to_json(data: Any) -> str:
    """Return JSON that may stand in a script element: no markup can end it early."""
    text = json.dumps(data, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")


def _hash_source(text: str) -> str:
    """Return a source of a content security policy: this text by its hash, and no other."""
    digest = hashlib.sha256(text.encode()).digest()
    return f"'sha256-{base64.b64encode(digest).decode()}'"


def _read_asset(name: str) -> str:
    """Return the text of a file in `assets/`."""
    return resources.files("pounding_cli.report").joinpath("assets", name).read_text(encoding="utf-8")


@cache
def _load_template(name: str) -> Any:
    """Return the template of a file in `assets/`."""
    import jinja2

    environment = jinja2.Environment(
        loader=jinja2.FunctionLoader(_read_asset), autoescape=True, trim_blocks=True, lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )  # fmt: skip
    environment.filters["format_keys"] = _format_keys
    environment.filters["allow_breaks"] = _allow_breaks
    return environment.get_template(name)


def _format_keys(text: str) -> Any:
    """Return a sentence as HTML, with the keys of a study, which stand in backticks, as code."""
    import markupsafe

    parts = re.split(r"`([^`]+)`", str(markupsafe.escape(text)))  # words and keys by turns
    return markupsafe.Markup(
        "".join(f"<code>{part}</code>" if place % 2 else join_units(part) for place, part in enumerate(parts))
    )


def _allow_breaks(text: str) -> Any:
    """Return a cell as HTML in which lines may end within long names, and not before a unit."""
    import markupsafe

    return markupsafe.Markup("<wbr>").join(BREAK.split(join_units(text)))
