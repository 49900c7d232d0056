"""`pound cite`: the references of what a study used."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

import click

from pounding_cli.errors import InputError, Problem


@click.command("cite")
@click.argument("source", type=click.Path(path_type=Path), metavar="STUDY|FILE.h5")
@click.option(
    "--format",
    "form",
    type=click.Choice(("text", "bibtex")),
    default="text",
    show_default=True,
    help="Plain text, or entries for a .bib file.",
)
def command(source: Path, form: str) -> None:
    """List the references of a study or a results file, and what each is used for.

    The list has the laws with the equations of the paper, the edition of the building code, the intensity measure,
    the methods of solution (for a study, those that a run would use) and the sources of the motions.

    \b
    Example:
      pound cite results/fig6.h5
      pound cite configs/fig6.yaml --format bibtex > references.bib
    """
    import importlib

    from pounding_cli.report.references import citations, motions

    title, kind, resolved, sources, methods = _study(source) if source.suffix in (".yaml", ".yml") else _results(source)
    asked = importlib.import_module(f"pounding_cli.report.{kind}")
    try:
        found = citations(resolved, sources, methods, getattr(asked, f"cite_{kind}", None))
    except (KeyError, TypeError, AttributeError, IndexError) as error:
        problem = Problem("its resolved study is not complete", "run the study again with this program", str(source))
        raise InputError(problem) from error
    if form == "bibtex":
        click.echo("\n\n".join(citation.reference.bibtex for citation in found))
        return
    click.echo(title)
    for citation in found:
        click.echo(f"\n{citation.reference.text}\n    for {'; '.join(citation.uses)}")
    if sources:
        click.echo("\nMotions")
    for line in motions(sources):
        click.echo(f"  {line}")


_Used = tuple[str, str, Mapping[str, Any], Mapping[str, str], Collection[str]]
"""Title, kind, study with every default filled in, the motions' sources, the methods."""


def _study(path: Path) -> _Used:
    from pounding_cli.study import load_study

    study = load_study(path)
    uses = [used.use for used in study.motions((0,) * len(study.axes)).values()]
    return study.title, "run", study.resolved(), {use.name: use.source for use in uses}, {study.model.method}


def _results(path: Path) -> _Used:
    from pounding_cli.api.studies import open_results

    results = open_results(path)
    records = results.records()
    sources = dict(zip(records["record"], records["source"], strict=True))
    return results.title, results.workflow, results.resolved, sources, results.methods
