"""Tables of the pages that are written from the code: `python docs/hooks/tables.py` writes them, `--check` only looks.

The keys of a study under their headings in study-file.md, its plausible ranges, and the methods in accuracy.md."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from pathlib import Path

from pounding_cli import methods
from pounding_cli.report.citations import method_sources
from pounding_cli.study import laws, models, questions, schema
from pounding_cli.study.keys import table
from pounding_cli.study.plausible import shown
from pounding_cli.study.usual import RANGES

DOCS = Path(__file__).parents[1]
MODELS = {
    "The file": schema.Study,
    "`records`": models.Records,
    "`records.use`: a file of your own": models.RecordFile,
    "`records.scale`: Arias intensity": models.Arias,
    "`records.scale`: peak acceleration": models.Pga,
    "`records.scale`: peak velocity": models.Pgv,
    "`records.scale`: an ordinate of the spectrum": models.Sa,
    "`records.scale`: a target spectrum": models.Spectrum,
    "`buildings.NAME`": models.Building,
    "`yield`": models.Code,
    "`yield`: a base-shear coefficient": models.BaseShear,
    "`stiffness`: by a period and masses": models.StiffnessAt,
    "`rayleigh`": models.Rayleigh,
    "`foundation`": models.Foundation,
    "`impact`": laws.Impact,
    "`laws.NAME`": models.OwnLaw,
    "`cases.NAME`": models.Case,
    "`report`": schema.Report,
    "`keep.histories`": schema.Histories,
    "`fragility`": questions.FragilitySpec,
    "`gap`": questions.GapSpec,
    "`sensitivity`": questions.SensitivitySpec,
    "`optimise`": questions.OptimiseSpec,
    "`gap.gb50011`": questions.Gb50011Spec,
}


def ranges() -> list[str]:
    """Plausible values, over which a study is warned of."""
    lines = []
    for name, fits in RANGES.items():
        ends = (f"{end:g}" if " over " in name else shown(end, fits.units) for end in (fits.low, fits.high))
        lines.append(f"| {name} | {' to '.join(ends)} | {fits.reason} |")
    return lines


def written() -> Iterator[tuple[Path, str]]:
    """The pages with their tables as the code has them."""
    page = DOCS / "study-file.md"
    text = page.read_text(encoding="utf-8")
    for heading, model in MODELS.items():
        text = under(text, heading, table(model))
    yield page, under(text, "Warnings", ranges(), keep=2)
    page = DOCS / "accuracy.md"
    text = page.read_text(encoding="utf-8")
    for mark, lines in (("methods", methods.table()), ("sources", method_sources(methods.METHODS))):
        before, begin, rest = text.partition(f"<!-- {mark}: begin")
        head, _, rest = rest.partition("-->\n")
        _, end, after = rest.partition(f"<!-- {mark}: end")
        text = "".join((before, begin, head, "-->\n", "\n".join(lines), "\n", end, after))
    yield page, text


def under(text: str, heading: str, lines: list[str], keep: int = 0) -> str:
    """The text with the first table below a heading replaced, its first `keep` lines kept."""
    found = re.search(rf"^#+ {re.escape(heading)}\n", text, re.MULTILINE)
    if found is None:
        raise ValueError(f"no heading {heading}")
    start = text.index("\n|", found.end() - 1) + 1
    old = re.match(r"(?:\|.*\n)+", text[start:])
    kept = old[0].splitlines(keepends=True)[:keep]
    return text[:start] + "".join(kept) + "\n".join(lines) + "\n" + text[start + old.end() :]


if __name__ == "__main__":
    stale = [(page, text) for page, text in written() if page.read_text(encoding="utf-8") != text]
    for page, text in stale:
        if "--check" not in sys.argv:
            page.write_text(text, encoding="utf-8")
        print(f"{page.name}: {'stale' if '--check' in sys.argv else 'written'}")
    sys.exit("--check" in sys.argv and bool(stale))
