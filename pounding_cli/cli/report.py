"""`pound report`: figures, tables and the paper's claims from results files."""

from __future__ import annotations

from contextlib import nullcontext
from pathlib import Path

import click

from pounding_cli.cli.places import at_option, points_at
from pounding_cli.errors import InputError, Problem
from pounding_cli.numbers import counted


@click.command("report", short_help="Write figures, tables, claims and a page of results files.")
@click.argument("files", nargs=-1, required=True, type=click.Path(path_type=Path), metavar="FILE.h5...")
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    metavar="DIR",
    help="Folder of the report. Default: the name of the results file.",
)
@click.option(
    "--format",
    "formats",
    multiple=True,
    type=click.Choice(("png", "svg", "pdf")),
    help="Format of the figures; may be given more than once. Default: all three.",
)
@click.option(
    "--figures-for-paper",
    is_flag=True,
    help="Draw figures without titles and captions, as SVG and PDF; captions.md has the captions. No page.",
)
@click.option("--no-figures", is_flag=True, help="Write tables and claims only (much faster).")
@click.option("--no-page", is_flag=True, help="Do not write report.html.")
@click.option(
    "--quantity", "quantities", multiple=True, metavar="NAME", help="Quantity to draw over the sweep, e.g. drift."
)
@click.option("--case", help="Draw only this case of the sweep; `worst`: the worst of all.")
@click.option("--analysis", help="Draw only this analysis of the sweep.")
@click.option("--record", help="Draw only this motion of the sweep. Default: their mean.")
@click.option("--building", help="Draw only this building of the sweep; `worst`: the worst of all.")
@click.option("--storey", type=int, help="Draw only this storey of the sweep. Default: the worst.")
@click.option("--floor", type=int, help="Draw only this floor of the sweep. Default: the worst.")
@click.option("--link", help="Draw only this link of the sweep. Default: the worst.")
@at_option
@click.option("-q", "--quiet", is_flag=True, help="Print nothing.")
def command(
    files: tuple[Path, ...],
    output: Path | None,
    formats: tuple[str, ...],
    figures_for_paper: bool,
    no_figures: bool,
    no_page: bool,
    quantities: tuple[str, ...],
    case: str | None,
    analysis: str | None,
    record: str | None,
    building: str | None,
    storey: int | None,
    floor: int | None,
    link: str | None,
    at: tuple[str, ...],
    quiet: bool,
) -> None:
    """Draw the figures of results files, write their tables as CSV, and evaluate the paper's claims.

    The command accepts files of all commands that write results.

    The report is written to DIR, by default a folder next to the results file with its name: report.html (everything
    in one page, to open in a browser or to send), the figures, tables/. With several files, each has its own folder in
    DIR, and comparison.md compares their claims.

    A sweep is drawn as curves (one swept key) or maps (two swept keys). With more keys, the two with most values are
    drawn; --at fixes a key. By default the figures show the largest V/V0 (elastic) and mu/mu0 (inelastic) of every
    building; --quantity accepts any column of the tables storey, floor, link and scene.

    \b
    Example:
      pound report results/fig6.h5 -o report
      pound report results/fig6.h5 results/fig7.h5 --no-figures
      pound report results/fig6.h5 -o paper --figures-for-paper
      pound report results/sweep.h5 --quantity mu_ratio --case touching --building soft --storey 3
    """
    from pounding_cli.api.studies import open_results
    from pounding_cli.report import report
    from pounding_cli.report.claims import compare_claims, verdicts
    from pounding_cli.report.style import FORMATS, for_paper
    from pounding_cli.report.sweep import Asked, Choice

    if figures_for_paper and no_figures:
        hint = "leave one of them out"
        raise InputError(Problem("--figures-for-paper and --no-figures contradict each other", hint))
    usual = tuple(name for name in FORMATS if name != "png") if figures_for_paper else FORMATS
    chosen = () if no_figures else formats or usual
    opened = {path: open_results(path) for path in files}
    choice = Choice("", case, analysis, building, storey, floor, link, record)
    asked = {path: Asked(quantities, choice, points_at(results, at)) for path, results in opened.items()}
    folders = _folders(files, output)
    for path, results in opened.items():
        with for_paper() if figures_for_paper else nullcontext():
            written = report(results, asked=asked[path]).save(folders[path], chosen, not (no_page or figures_for_paper))
        if not quiet:
            click.echo(f"{written[-1]}: {counted(len(written), 'file')}")
            for key, verdict in verdicts(results).items():
                click.echo(f"  {key:22} {verdict}")
    if len(opened) > 1:
        folder = output or Path("comparison")
        page, _ = compare_claims({folders[path].name: results for path, results in opened.items()}, folder)
        if not quiet:
            click.echo(str(page))


def _folders(files: tuple[Path, ...], output: Path | None) -> dict[Path, Path]:
    """Where each report goes; files of one name are told apart by a number."""
    if output is not None and len(files) == 1:
        return {files[0]: output}
    folders: dict[Path, Path] = {}
    for path in files:
        base = output / path.stem if output is not None else path.with_suffix("")
        folder, number = base, 2
        while folder in folders.values():
            folder, number = base.with_name(f"{base.name}-{number}"), number + 1
        folders[path] = folder
    return folders
