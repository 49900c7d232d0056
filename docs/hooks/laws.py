"""A page for every law of links and storeys, and one that lists them: all from what the law declares of itself."""

from __future__ import annotations

import importlib.util
import inspect
import io
from collections.abc import Iterator
from dataclasses import MISSING
from math import inf
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from pydantic import Field

from pounding_cli.laws import link_laws, storey_laws
from pounding_cli.laws.law import LinkLaw
from pounding_cli.laws.storey import StoreyLaw
from pounding_cli.notes import NOTES
from pounding_cli.report.references import REFERENCES
from pounding_cli.report.style import RC
from pounding_cli.study.schema.building import BuildingSpec
from pounding_cli.study.schema.links import key_parameters, link_keys, link_models, needs_key
from pounding_cli.study.schema.lookup import fields_of


def _module(path: Path) -> Any:
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    found = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(found)
    return found


model = _module(Path(__file__).parents[1] / "figures" / "model.py")
keys = _module(Path(__file__).with_name("keys.py"))
row, require = keys.row, keys.require

HEAD = """\
# Laws

The force of every law, its keys, its loop and its source. [Laws of contact](../contact.md) compares the contacts, the
[modelling guide](../modelling.md) says which to take, and [extending](../extending.md) how to add one; a
[formula](../study-file.md#laws) in the study needs no program. The springs of a
[foundation](../theory.md#equations-of-motion) are linear, with a dashpot beside each. Every link also has the keys
`floors`, `pair` and `at`, which say [where it stands](../study-file.md#cases)."""

KEYS = ["| key | value | default | meaning |", "|---|---|---|---|"]


def pages() -> Iterator[tuple[str, str | bytes]]:
    """Place in the site and content of the pages and of their figures."""
    yield "laws/index.md", index()
    for name, law in link_laws().items():
        yield f"laws/{name}.md", link_page(law)
        closing, force = model.loop_of_link(model.LINKS[name])
        label = "closing v [mm]" if name in model.WITHIN_THE_GAP else "closing less the gap, v [mm]"
        yield f"laws/{name}.svg", drawn(1e3 * closing, 1e-6 * force, label, "force F [MN]")
    for name, law in storey_laws().items():
        yield f"laws/storey-{name}.md", storey_page(law)
        yield f"laws/storey-{name}.svg", drawn(*model.loop_of_storey(law), "drift / Dy", "shear / Vy")


def index() -> str:
    """All laws in two tables."""
    parts = [HEAD]
    for heading, laws, prefix in (("Links", link_laws(), ""), ("Storeys", storey_laws(), "storey-")):
        lines = [f"| [`{name}`]({prefix}{name}.md) | {said(law)} |" for name, law in laws.items()]
        parts += [f"## {heading}", "\n".join(["| law | |", "|---|---|", *lines])]
    return "\n\n".join(parts) + "\n"


def said(law: type) -> str:
    """The first paragraph of its docstring, fit for a cell of a table."""
    return " ".join((law.__doc__ or "").split("\n\n")[0].split()).replace("|", "\\|")


def link_page(law: type[LinkLaw]) -> str:
    """A law of a link."""
    fields = fields_of(link_models()[law.name])
    own = key_parameters(law)
    rows = []
    for name, (hint, given) in fields.items():
        if name in link_keys(law):
            is_needed = name == "gap" or (name in own and needs_key(law, name))
            rows.append(row(name, hint, require(given) if is_needed else given))
    facts = [
        f"Its force acts {'at all times' if law.joins else 'once the floors press'}; v is the closing of the two floors"
        + (", less the gap." if law.subtracts_gap else "."),
        solved(law.behaviour.force is not None, law.path_dependent),
    ]
    if law.beyond_gap:
        note = NOTES[law.beyond_gap]
        meaning = "" if note.can_be_accepted else "; the numbers of that scene then have no meaning"
        facts.append(f"A scene in which it closes more than the gap is flagged `{note.code}`, *{note.title}*{meaning}.")
    return page(law, f"# Link: `{law.name}`", rows, facts, "cases:\n  example: ", law.name)


def storey_page(law: type[StoreyLaw]) -> str:
    """A law of a storey."""
    fields = fields_of(BuildingSpec)
    rows = [row("hardening", *fields["hardening"])]
    for name, declared in key_parameters(law).items():
        default = law.parameters()[name].default
        given = Field(
            ... if default is MISSING else None if default == inf else default, description=declared.description
        )
        rows.append(row(name, fields[name][0], given))
    facts = [
        "D is the drift of the storey, k its stiffness, Vy its yield shear, Dy = Vy / k, and a its `hardening`.",
        solved(law.behaviour.force is not None, law.behaviour.history_rate is not None),
    ]
    return page(law, f"# Storey: `{law.name}`", rows, facts, "buildings:\n  example: ", f"storey-{law.name}")


def solved(smooth: bool, path_dependent: bool) -> str:
    """How the solver takes it."""
    way = "Dormand-Prince 8(5,3) while it acts" if smooth else "Taylor series between its events"
    return f"It is solved by {way}." + (" Methods of fixed steps refuse it." if path_dependent else "")


def page(law: type, heading: str, rows: list[str], facts: list[str], before: str, figure: str) -> str:
    """What both kinds of pages have in common."""
    kind = "storeys" if issubclass(law, StoreyLaw) else "links"
    sources = [f"- {REFERENCES[key].text} ({what})" for key, what in law.citation]
    return "\n\n".join(
        [
            heading,
            inspect.getdoc(law) or "",
            " ".join(facts) + f" [Theory](../theory.md#{kind}) has the equations.",
            f"![Loop of force over deformation from a run of the solver]({figure}.svg)",
            "## Keys",
            "\n".join([*KEYS, *rows]),
            "## Example",
            f"```yaml\n{before}{law.example}\n```",
            *(["## Source" + "s" * (len(sources) > 1), "\n".join(sources)] if sources else []),
        ]
    ) + "\n"  # fmt: skip


def drawn(x: np.ndarray, y: np.ndarray, x_label: str, y_label: str) -> bytes:
    """A loop as SVG."""
    with mpl.rc_context({**RC, "svg.hashsalt": "laws"}):
        figure = Figure(figsize=(4.2, 3.0), layout="constrained")
        ax = figure.add_subplot(xlabel=x_label, ylabel=y_label)
        ax.plot(x, y, color=model.BLUE, lw=1.3)
        ax.axhline(0.0, color=model.GREY, lw=0.5)
        ax.axvline(0.0, color=model.GREY, lw=0.5)
        kept = io.BytesIO()
        figure.savefig(kept, format="svg", metadata={"Date": None})
    return kept.getvalue()


def on_files(files, config):
    """Called by mkdocs: adds the pages to those that stand in docs/."""
    from mkdocs.structure.files import File

    for path, content in pages():
        files.append(File.generated(config, path, content=content))
    return files
