"""The page of a study: everything it carries, put together and written."""

from __future__ import annotations

import base64
import hashlib
import math
import re
from collections.abc import Mapping, Sequence
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from pounding_cli import __version__
from pounding_cli.numbers import counted
from pounding_cli.report.answer_page import AnswerPage
from pounding_cli.report.claim_tables import Column
from pounding_cli.report.evidence import Evidence, Tables, axis_keys, motion_label, motion_sentence
from pounding_cli.report.figures import drawn_part, main_building
from pounding_cli.report.verdicts import Judgement
from pounding_cli.report.web import story
from pounding_cli.report.web.answer import answer, largest
from pounding_cli.report.web.beside import accuracy_beside
from pounding_cli.report.web.data import as_json, charted, chosen_points, point_of, tables
from pounding_cli.report.web.limits import limits
from pounding_cli.report.web.motion import players
from pounding_cli.report.web.pictures import MOST_FIGURES, SPECTRUM, pictures
from pounding_cli.report.web.sweep import sweep_data
from pounding_cli.store import flag_groups_of
from pounding_cli.variables import ALONE
from pounding_cli.workflows import WORKFLOWS

PAGE = "report.html"
"""File name of the page."""

MOST_VERDICTS = 100
"""Points of a sweep whose verdicts are listed."""

SCRIPTS = tuple(
    f"{name}.js"
    for name in ("format", "data", "axes", "profile", "sweep", "table", "stage", "strips", "player", "main")
)

"""In the order they are needed."""


def write_page(
    results: Tables,
    folder: Path,
    figures: Mapping[str, Figure],
    evidences: Sequence[Evidence],
    shown: Evidence,
    columns: Sequence[Column],
    own: AnswerPage | None = None,
    scene: pd.DataFrame | None = None,
) -> Path:
    """Write `report.html` of one study into an existing folder.

    figures : drawn already, by name; none leaves them out
    evidences, shown : every point of the sweep, and the one the figures are of
    columns : the judgements at every point, headed by it
    own : what the workflow says in place of the ratios to the building alone
    scene : the scenes of the whole study, where `results` holds one of many samples
    """
    judgements = next((judged for where, judged in columns if where == shown.label), columns[0][1])
    scene = results.scene() if scene is None else scene
    is_sampled = WORKFLOWS[results.workflow].sampled
    everything = shown
    if (drawn := drawn_part(shown)) is not shown:
        evidences = [drawn if evidence is shown else evidence.only(drawn.cases) for evidence in evidences]
        shown = drawn
    chosen = chosen_points(evidences, shown)
    data = {
        "tables": tables(results, chosen),
        "points": [{"label": evidence.label, "point": point_of(evidence)} for evidence in chosen],
        "shown": shown.label,
        "sweep": None if own else sweep_data(results, shown.cases),
        "players": players(results, evidences),
        "cases": shown.cases,
        "motions": len(shown.records),
        "buildings": shown.group,
        "building": main_building(shown),
        "periods": shown.periods,
        "charted": charted("height"),
        "alone": ALONE,
    }
    images = pictures(figures, shown, own.words if own else {})
    content = {
        "title": results.title,
        "data": as_json(data),
        "evidence": shown,
        "group": _group(shown),
        "infinity": math.inf,
        "sentence": motion_sentence(shown.records),
        "motion_label": motion_label(shown.records),
        "swept": len(evidences) > 1 and not own,
        "samples": _points(scene) if is_sampled else 0,
        "points": len(evidences),
        "points_carried": len(chosen),
        "largest": None if own else largest(shown),
        "assumed": results.assumed_heights,
        "answer": None if own else answer(shown),
        "cases_left": len(everything.cases) - len(shown.cases),
        "motion_count": len(shown.records),
        "tiles": story.tiles(shown, judgements, scene),
        "judgements": judgements,
        "verdicts": _verdicts(columns) if len(columns) > 1 else None,
        "own": own,
        "pictures": [image for image in images if image.name != SPECTRUM],
        "spectra": [image for image in images if image.name == SPECTRUM],
        "pictures_left": len(figures) - len(images) if len(figures) > MOST_FIGURES else 0,
        "cases": story.cases(shown),
        "effects": story.effects(scene),
        "flags": flag_groups_of(scene, results.units),
        "limits": limits(results),
        "failures": story.failures(scene, shown.units),
        "runs": len(scene),
        "scenes": results.attrs.get("scenes"),
        "trust": story.trust(scene if is_sampled else shown.scene),
        "accuracy": accuracy_beside(
            getattr(results, "path", None), results.title, Path(str(results.attrs.get("study_file", ""))).name
        ),
        "motions": story.motions(shown),
        "spectrum": match.words if (match := results.spectrum_match) is not None else "",
        "players": data["players"],
        "study": results.study_text,
        "versions": story.versions(results),
        "created": str(results.attrs.get("created", "")).replace("T", " ").replace("+00:00", " UTC"),
        "command": f"pound {results.workflow} STUDY.yaml",
    }
    return render(folder / PAGE, "study.html.j2", content)


def _points(scene: pd.DataFrame) -> int:
    """The different points of the swept keys."""
    return len(scene[axis_keys(scene)].drop_duplicates())


def render(path: Path, template: str, content: Mapping[str, Any]) -> Path:
    """Fill a template with content, style and scripts, and write it."""
    style, theme, scripts = asset("style.css"), asset("theme.js"), _scripts()
    text = (
        _environment()
        .get_template(template)
        .render(
            **content, version=__version__, style=style, theme=theme, scripts=scripts, tone=story.verdict_tone,
            allowed_style=_allowed(style), allowed_scripts=_allowed(theme, scripts),
        )
    )  # fmt: skip
    path.write_text(text, encoding="utf-8")
    return path


def _allowed(*sources: str) -> str:
    """Sources of a content security policy: these texts by their hashes, and no others."""
    digests = (base64.b64encode(hashlib.sha256(source.encode()).digest()).decode() for source in sources)
    return " ".join(f"'sha256-{digest}'" for digest in digests)


def asset(name: str) -> str:
    """The text of a file in `assets/`."""
    return resources.files("pounding_cli.report.web").joinpath("assets", name).read_text(encoding="utf-8")


@cache
def _environment() -> Any:
    import jinja2

    loader = jinja2.FunctionLoader(asset)
    environment = jinja2.Environment(
        loader=loader, autoescape=True, trim_blocks=True, lstrip_blocks=True, undefined=jinja2.StrictUndefined
    )
    environment.filters["counted"] = counted
    environment.filters["keys_as_code"] = _keys_as_code
    environment.filters["unbroken"] = _unbroken
    return environment


def _unbroken(text: str) -> str:
    """Numbers that break before their brackets alone: `0.139 (0.11 to 0.176)`."""
    return text.replace(" ", "\N{NO-BREAK SPACE}").replace("\N{NO-BREAK SPACE}(", " (")


def _keys_as_code(text: str) -> Any:
    """A sentence whose keys of a study stand in backticks, as HTML."""
    import markupsafe

    return markupsafe.Markup(re.sub(r"`([^`]+)`", r"<code>\1</code>", str(markupsafe.escape(text))))


def _scripts() -> str:
    """All scripts as one that leaves nothing behind in the page's global scope."""
    return "(() => {\n'use strict';\n" + "\n".join(asset(name) for name in SCRIPTS) + "\n})();"


def _group(evidence: Evidence) -> list[dict[str, Any]]:
    """Name, period [s], storeys (bottom and top [m]) and V/W [-] of every building, left to right, for the drawing."""
    parts = dict(iter(evidence.buildings.groupby("building", sort=False)))
    main = main_building(evidence)
    return [
        {
            "name": name,
            "period": evidence.periods[name],
            "levels": _levels(parts[name]["height"]),
            "strength": float(parts[name]["base_shear_ratio"].iloc[0]),
            "main": name == main,
        }
        for name in evidence.group
    ]


def _levels(heights: pd.Series) -> list[tuple[float, float]]:
    """Bottom and top of every storey [m]."""
    tops = heights.cumsum()
    return list(zip(tops - heights, tops, strict=True))


def _verdicts(columns: Sequence[Column]) -> dict[str, Any] | None:
    """Claims across, points down, verdicts in the cells; None without claims."""
    keys = list(dict.fromkeys(judgement.claim.key for _, judged in columns for judgement in judged))
    if not keys:
        return None
    rows: list[tuple[str, list[Any]]] = []
    for where, judged in columns[:MOST_VERDICTS]:
        by_key: dict[str, Judgement] = {judgement.claim.key: judgement for judgement in judged}
        rows.append((where, [by_key[key].verdict if key in by_key else None for key in keys]))
    return {"keys": keys, "rows": rows, "left": max(len(columns) - MOST_VERDICTS, 0)}
