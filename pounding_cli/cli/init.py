"""`pound init`: a commented study to start from."""

from __future__ import annotations

from pathlib import Path

import click


@click.command("init")
@click.argument("name")
@click.option(
    "-t",
    "--template",
    type=click.Choice(("pair", "measures", "connector", "wall")),
    default="pair",
    show_default=True,
    help="Study to start from.",
)
def command(name: str, template: str) -> None:
    """Write NAME.yaml, a commented study that is ready to run, and print the next steps.

    The command also writes pound.schema.json, which lets editors complete keys and mark mistakes.

    \b
    Templates:
      pair       two buildings, touching and with a gap, every key explained
      measures   the paper's measures: gap, infill, connectors, under its five motions
      connector  two connected oscillators in closed form
      wall       a floor striking a bumper wall

    \b
    Example:
      pound init my-study
      pound init walls/front --template wall
    """
    from pounding_cli.study.template import TEMPLATES, start_study

    written = start_study(name, template)
    study, how = written[0], TEMPLATES[template].command
    results = Path("results") / f"{study.stem}.h5"
    steps = [
        (f"pound check {study}", "checks it; repeat after every change"),
        (f"pound {how} {study}", f"writes {results} and prints a summary"),
    ]
    if how == "run":
        steps.append((f"pound show {results} storey", "shows shears and ductilities, storey by storey"))
        steps.append((f"pound report {results}", f"draws {results.with_suffix('') / 'report.html'}, figures, tables"))
    wide = max(len(line) for line, _ in steps)
    click.echo(f"wrote {', '.join(map(str, written))}\nNext, change it as you like, and:")
    for line, what in steps:
        click.echo(f"  {line:<{wide}}   {what}")
