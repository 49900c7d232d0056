"""What a study rests on: the literature in `references.bib`, and who uses which entry for what."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pounding_cli import __version__
from pounding_cli.laws import link_laws, storey_laws
from pounding_cli.laws.foundation import FrictionPendulum
from pounding_cli.methods import METHODS
from pounding_cli.records import load_catalogue

_ENTRY = re.compile(r"^@(\w+)\{([^,\s]+),\n(.*?)^\}$", re.MULTILINE | re.DOTALL)
_FIELD = re.compile(r"^  (\w+) = \{(.*)\},?$", re.MULTILINE)


@dataclass(frozen=True)
class Reference:
    """One entry.

    fields : BibTeX field -> value, without the escapes of BibTeX
    bibtex : the entry for a .bib file (UTF-8)
    """

    fields: dict[str, str]
    bibtex: str

    @property
    def authors(self) -> str:
        """The authors: "Family, A. B., Family, C. & Family, D."; of an organisation its name."""
        name = self.fields["author"]
        if name.startswith("{"):
            return name.strip("{}")
        *first, last = name.split(" and ")
        return f"{', '.join(first)} & {last}" if first else last

    @property
    def text(self) -> str:
        """The entry on one line."""
        at = self.fields
        edition = f", {at['edition']} edition" if "edition" in at else ""
        volume = f" {at['volume']}" + (f"({at['number']})" if "number" in at else "") if "volume" in at else ""
        within = at.get("journal") or at.get("booktitle") or at.get("howpublished")
        where = [within + volume] if within else []
        where += [at[name].replace("--", "-") for name in ("pages", "publisher", "address") if name in at]
        doi = f" doi:{at['doi']}" if "doi" in at else ""
        return f"{self.authors} ({at['year']}). {at['title'].strip('{}')}{edition}. {', '.join(where)}.{doi}"


def read(text: str) -> dict[str, Reference]:
    """The entries of a .bib file that has one field a line, by key (family name of the first author and year)."""
    found = {}
    for entry in _ENTRY.finditer(text):
        fields = {name: re.sub(r"\\([&%#_])", r"\1", value) for name, value in _FIELD.findall(entry[3])}
        found[entry[2]] = Reference(fields, entry[0])
    return found


_FILE = Path(__file__).with_name("references.bib")
REFERENCES = read(_FILE.read_text(encoding="utf-8").replace("VERSION", __version__))
"""Every reference by its key."""


def citations(
    resolved: Mapping[str, Any], sources: Mapping[str, str], methods: Collection[str] = (),
    cite: Callable[[Mapping[str, Any]], Iterable[tuple[str, str]]] | None = None,
) -> dict[str, list[str]]:  # fmt: skip
    """What to cite for a study: keys of REFERENCES, and what each was used for.

    Parameters
    ----------
    resolved : the study with every default filled in
    sources : motion -> its label: "real", "stand-in" or "user"
    methods : keys in METHODS that solve its scenes, buildings alone included
    cite : keys that its question uses besides, and what for
    """
    uses = defaultdict[str, list[str]](list)
    for key, what in (*_of_scenes(resolved, methods), *(cite(resolved) if cite else ())):
        uses[key].append(what)
    if "stand-in" in sources.values():
        uses["lilhanand1988"].append("the synthesis of the stand-in motions")
    return {key: list(dict.fromkeys(uses[key])) for key in REFERENCES if key in uses}


def _of_scenes(resolved: Mapping[str, Any], methods: Collection[str]) -> Iterator[tuple[str, str]]:
    """What the scenes of a study rest on: keys of references, and what each is used for."""
    yield "pounding_cli", "the computations"
    yield "spiliopoulos1996", "the model of the buildings, eqs (1) to (4)"
    buildings = {name: resolved["buildings"][name] for name in resolved["group"]}
    kinds = {link["link"].partition(" of ")[0] for case in resolved["cases"].values() for link in case["links"]}
    storeys = {building.get("storey_law") for building in buildings.values()}
    for laws, acting in ((link_laws(), kinds), (storey_laws(), storeys)):
        for law in (law for law in laws.values() if law.name in acting):
            yield from law.citation
    bases = [building.get("foundation") for building in buildings.values()]
    if any(isinstance(base, dict) and (base.get("isolation") or {}).get("friction") for base in bases):
        yield from FrictionPendulum.citation
    for name, building in buildings.items():
        if building["yield_shear"] is None and "code" in building["yield"]:
            yield f"ubc{building['yield']['code'][-4:]}", f"the yield shears of {name}, the separation"
    scale = resolved["records"]["scale"]
    if scale == "table1":
        yield "spiliopoulos1996", "the scales of Table 1"
    if scale == "table1" or (isinstance(scale, Mapping) and "arias" in scale):
        yield "arias1970", "the intensity by which the motions are scaled"
    for method in (METHODS[name] for name in methods):
        yield from ((key, f"the method of solution, {method.title}") for key, _ in method.citation)
        if resolved["estimate"] != "none":
            judge = METHODS["taylor"] if method.takes_step else method  # as solver.estimate has it
            yield from ((key, "the finer runs for error and sensitivity") for key, _ in judge.citation)


def motions(sources: Mapping[str, str]) -> Iterator[str]:
    """Where the motions come from, as far as the catalogue knows, one line each; `sources` as for `citations`."""
    for name, kind in sources.items():
        known = load_catalogue().get(name)
        said = "your own file: cite its source"
        if known is not None and not kind.startswith("user"):
            what = f"{known.title}: {known.event}, {known.date}, magnitude {known.magnitude}, {known.station}"
            made = f"synthesized by pounding_cli from: {'; '.join(known.sources)}"
            said = f"{what}, {known.component}; {said if kind.startswith('real') else made}"
        yield f"{name} ({kind}): {said}"


def method_sources(names: Iterable[str]) -> list[str]:
    """The publications of methods of solution as lines of Markdown, one a method."""
    lines = []
    for name in names:
        cited = ((REFERENCES[key].text, where) for key, where in METHODS[name].citation)
        lines.append(f"- `{name}`: {'; '.join(f'{text} ({where})' if where else text for text, where in cited)}")
    return lines
