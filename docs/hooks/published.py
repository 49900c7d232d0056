"""Published results beside ours: the studies of docs/published/ and of the paper, run, and the tables of
docs/published.md made of them.

`python docs/hooks/published.py [NAME ...]` runs studies and prints their rows; `--renew` puts them into the page and
draws its figures. The build of the site makes every table anew. Each study has a module in docs/hooks/published/.
"""

from __future__ import annotations

import argparse
import importlib
import importlib.util
import re
import shutil
import sys
import tempfile
from pathlib import Path
from typing import Any

import pandas as pd

import pounding_cli as pound

sys.path.append(str(Path(__file__).with_suffix("")))  # the modules of the studies; hooks are no package

from comparison import DOCS, GALLERY, NOT_KNOWN, Entry, Row

PAGE = DOCS / "published.md"
FIGURES = DOCS / "figures"

OVERVIEW_BEGIN = "<!-- overview: begin -->\n\n"
OVERVIEW_END = "\n\n<!-- overview: end -->"


def _load(name: str) -> Any:
    """Return a module of this folder, none of which is a package."""
    spec = importlib.util.spec_from_file_location(f"hook_{name}", Path(__file__).with_name(f"{name}.py"))
    assert spec is not None
    assert spec.loader is not None
    module = sys.modules[spec.name] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


gallery = sys.modules.get("hook_gallery") or _load("gallery")


class Solution:
    """A study of `pound run` that was run in this process, which is quicker than by the command."""

    def __init__(self, study: Path, command: str, folder: Path) -> None:
        self.study = study
        self.file = folder / f"{study.stem}.h5"
        self.results = pound.run(study, self.file, workflow=command)

    def table(self, name: str) -> pd.DataFrame:
        """Return a table of the results, in SI."""
        return getattr(self.results, name)()


def find_entries() -> dict[str, Entry]:
    """Return the studies by name, in the order of the page."""
    names = re.findall("<!-- published: begin (.+) -->", PAGE.read_text(encoding="utf-8"))
    return {name: importlib.import_module(name.replace("-", "_")).ENTRY for name in names}


ENTRIES = find_entries()


def solve_entry(name: str, folder: Path) -> Any:
    """Return the results of a study, run in a folder with the motions it needs."""
    entry = ENTRIES[name]
    for path in (*entry.folder.glob("*.txt"), *entry.find_motions()):
        shutil.copy(path, folder)
    study = Path(shutil.copy(entry.folder / f"{name}.yaml", folder))
    solve = gallery.Solved if entry.folder == GALLERY else Solution
    return solve(study, entry.command, folder)


def find_rows(name: str) -> list[Row]:
    """Return the rows of a study, which is run."""
    with tempfile.TemporaryDirectory(prefix="published-") as folder:
        return list(ENTRIES[name].rows(solve_entry(name, Path(folder))))


def format_rows(rows: list[Row]) -> str:
    """Return a Markdown table."""
    head = "| quantity | published | ours | difference | why |\n|---|---|---|---|---|"
    return "\n".join([head, *(row.format() for row in rows)])


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


def split_rows(table: str) -> list[list[str]]:
    """Return the cells of the rows of a table as it stands on the page, without its head."""
    return [line.strip("| ").split(" | ") for line in table.splitlines()[2:]]


def find_percentages(table: str) -> list[float]:
    """Return the differences in per cent of the rows of a table that have one, without signs."""
    found = (re.fullmatch(r"[-+]([\d.]+) %", row[3]) for row in split_rows(table))
    return [float(match[1]) for match in found if match]


def summarise_table(table: str) -> str:
    """Return the largest difference of the rows with numbers of a table and how many statements hold."""
    differences = [row[3] for row in split_rows(table)]
    numbers = [each for each in differences if re.fullmatch(r"[-+][\d.]+ (%|µs)", each)]
    words = [each for each in differences if each not in (*numbers, NOT_KNOWN)]
    parts = [max(numbers, key=lambda each: abs(float(each.split()[0]))).lstrip("+-")] if numbers else []
    if words:
        parts.append(f"{words.count('none')} of {len(words)} statements hold")
    return ", ".join(parts) or NOT_KNOWN


def count_matches(markdown: str) -> str:
    """Return how many numbers of a page there are and how many agree, in a sentence."""
    tables = [find_percentages(split_page(markdown, name)[1]) for name in ENTRIES]
    differences = [each for table in tables for each in table]
    close, near, far = (sum(each <= limit for each in differences) for limit in (0.1, 1.0, 5.0))
    studies = sum(1 for table in tables if table)
    first = f"Of {len(differences)} numbers of {studies} studies {close} agree within 0.1 %"
    return f"{first}, {near} within 1 % and {far} within 5 %."


def format_overview(markdown: str) -> str:
    """Return the table of all studies of a page: where each stands, its rows, and how well these agree."""
    lines = ["| study | name | rows | difference |", "|---|---|---|---|"]
    for name in ENTRIES:
        before, table, _ = split_page(markdown, name)
        heading = re.findall("^##+ (.+)$", before, re.MULTILINE)[-1]
        anchor = re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-")
        count = len(split_rows(table))
        lines.append(f"| [{heading}](#{anchor}) | `{name}` | {count} | {summarise_table(table)} |")
    return "\n".join(lines)


def put_overview(markdown: str) -> str:
    """Return a page with the overview of its tables."""
    before, rest = markdown.split(OVERVIEW_BEGIN)
    _, after = rest.split(OVERVIEW_END)
    overview = f"{count_matches(markdown)}\n\n{format_overview(markdown)}"
    return before + OVERVIEW_BEGIN + overview + OVERVIEW_END + after


def on_page_markdown(markdown: str, page: Any, **_: object) -> str:
    """Called by mkdocs: makes the tables of the page anew, but for studies whose motion is not installed."""
    if page.file.src_uri != PAGE.name:
        return markdown
    for name, entry in ENTRIES.items():
        if not entry.find_missing_sources():
            markdown = put_table(markdown, name, format_rows(find_rows(name)))
    return put_overview(markdown)


def main() -> None:
    """Run studies, print their rows, and put them into the page where that is asked for."""
    parser = argparse.ArgumentParser(description="Compare published results with ours.")
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"{', '.join(ENTRIES)}; all unless given")
    parser.add_argument("--renew", action="store_true", help="put the rows into docs/published.md and draw its figures")
    options = parser.parse_args()
    if unknown := set(options.names) - set(ENTRIES):
        parser.error(f"there is no study {', '.join(sorted(unknown))}; there are {', '.join(ENTRIES)}")
    for name in options.names or ENTRIES:
        if missing := ENTRIES[name].find_missing_sources():
            print(f"## {name}\n\nneeds a motion of {', '.join(missing)}\n")
            continue
        with tempfile.TemporaryDirectory(prefix="published-") as folder:
            solved = solve_entry(name, Path(folder))
            table = format_rows(list(ENTRIES[name].rows(solved)))
            if options.renew and ENTRIES[name].draw:
                ENTRIES[name].draw(solved, FIGURES / f"{name}.svg")
        print(f"## {name}\n\n{table}\n")
        if options.renew:
            text = PAGE.read_text(encoding="utf-8")
            PAGE.write_text(put_overview(put_table(text, name, table)), encoding="utf-8")


if __name__ == "__main__":
    main()
