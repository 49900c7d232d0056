"""Writing a whole report: figures, CSV tables, claims and pages, for one results file or several."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from pounding_cli.outputs import check_folder
from pounding_cli.report import claim_tables
from pounding_cli.report.answer_page import answer_page
from pounding_cli.report.claims import judge
from pounding_cli.report.evidence import TABLES, Evidence, Tables, points
from pounding_cli.report.figures import draw_all, drawn_part
from pounding_cli.report.spectra import draw_spectra
from pounding_cli.report.style import FORMATS, save, unwritable
from pounding_cli.report.sweep import Asked, sweep_figures
from pounding_cli.report.tables import write_csv
from pounding_cli.report.web import write_page
from pounding_cli.texts import cells, write_markdown
from pounding_cli.workflows import WORKFLOWS


def write_report(
    results: Tables,
    folder: Path,
    formats: Sequence[str] = FORMATS,
    with_page: bool = True,
    asked: Asked | None = None,
) -> list[Path]:
    """Write the report of one results file into `folder`; returns the files written.

    formats : of the figures, any of "png", "svg", "pdf"; none leaves the figures out
    with_page : write report.html too, the whole report in one file
    asked : what is drawn over a sweep

    Raises
    ------
    InputError : the folder cannot be written to; something asked for is not there
    """
    is_sampled = WORKFLOWS[results.workflow].sampled
    everything, results = results, results.first_sample() if is_sampled else results
    evidences = points(results)
    shown = nominal(evidences)
    swept = len(evidences) > 1
    part = drawn_part(shown)
    own = answer_page(results, shown, bool(formats))
    figures = {} if own is None else {name: each.figure for name, each in own.figures.items()}
    if formats and own is None:
        figures = sweep_figures(results, part, asked)  # first: it may refuse what is asked for
    check_folder(folder)
    if formats and own is None:
        figures |= draw_all(part)
    match = results.spectrum_match
    if match is not None and formats:
        figures["target-spectrum"] = draw_spectra(match, results.title, shown.unit("acceleration"))
    files = save(figures, folder, formats)
    judgements = judge(shown) if own is None else []
    try:
        files += write_csv(everything, folder / "tables", ("records",) if is_sampled else TABLES)
        files += own.beside(folder) if own is not None and own.beside else []
        columns = claim_tables.judge_points(evidences) if own is None else [(shown.label, judgements)]
        if own is None:
            files.append(folder / "tables" / "claims.csv")
            cells(claim_tables.frame(columns)).to_csv(files[-1], index=False)
        if swept and judgements:
            title = f"Claims over the sweep: {results.title}"
            files.append(write_markdown(folder / "claims-sensitivity.md", claim_tables.page(title, columns)))
        if with_page:
            files.append(write_page(results, folder, figures, evidences, shown, columns, own, everything.scene()))
    except OSError as error:
        raise unwritable(folder, error) from error
    return files


def write_comparison(results: Mapping[str, Tables], folder: Path) -> list[Path]:
    """Write `comparison.md` and `comparison.csv`: the claims in several results, at every point."""
    columns: list[claim_tables.Column] = []
    for name, tables in results.items():
        for evidence in points(tables):
            columns.append((f"{name}: {evidence.label}" if evidence.label else name, judge(evidence)))
    try:
        folder.mkdir(parents=True, exist_ok=True)
        title = "Claims compared: " + ", ".join(results)
        text = write_markdown(folder / "comparison.md", claim_tables.page(title, columns))
        cells(claim_tables.frame(columns)).to_csv(folder / "comparison.csv", index=False)
    except OSError as error:
        raise unwritable(folder, error) from error
    return [text, folder / "comparison.csv"]


def nominal(evidences: Sequence[Evidence]) -> Evidence:
    """The point of the sweep that equals the study without its sweep; where none does the first, in the middle of every
    bracket."""
    for keys in (evidences[0].point, evidences[0].resolved.get("bracket") or ()):
        for evidence in evidences:
            if all(_at(evidence.resolved, key) == evidence.point[key] for key in keys):
                return evidence
    return evidences[0]


def _at(tree: object, key: str) -> object:
    """The value at a dotted key of nested dicts; None where there is none."""
    for part in key.split("."):
        if not isinstance(tree, Mapping):
            return None
        tree = tree.get(part)
    return tree
