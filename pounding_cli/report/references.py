"""The literature in `references.bib`, and which entries a study uses for what."""

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
from pounding_cli.numbers import join_limited
from pounding_cli.records import CODES, SOURCE_PREFIX, load_catalogue

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
        """The authors, "Family, A. B., Family, C. & Family, D."; of an organisation its name."""
        name = self.fields["author"]
        if name.startswith("{"):
            return name.strip("{}")
        *first, last = name.split(" and ")
        return f"{', '.join(first)} & {last}" if first else last

    @property
    def text(self) -> str:
        """The entry on one line."""
        fields = self.fields
        edition = f", {fields['edition']} edition" if "edition" in fields else ""
        issue = f"({fields['number']})" if "number" in fields else ""
        volume = f" {fields['volume']}{issue}" if "volume" in fields else ""
        container = fields.get("journal") or fields.get("booktitle") or fields.get("howpublished")
        places = [container + volume] if container else []
        for name in ("pages", "publisher", "address"):
            if name in fields:
                places.append(fields[name].replace("--", "-"))
        doi = f" doi:{fields['doi']}" if "doi" in fields else ""
        title = fields["title"].strip("{}")
        return f"{self.authors} ({fields['year']}). {title}{edition}. {', '.join(places)}.{doi}"


def parse_references(text: str) -> dict[str, Reference]:
    """Return the entries of a .bib file that has one field a line, by key.

    A key is the family name of the first author and the year.
    """
    references = {}
    for entry in _ENTRY.finditer(text):
        fields = {name: re.sub(r"\\([&%#_])", r"\1", value) for name, value in _FIELD.findall(entry[3])}
        references[entry[2]] = Reference(fields, entry[0])
    return references


_FILE = Path(__file__).with_name("references.bib")
REFERENCES = parse_references(_FILE.read_text(encoding="utf-8").replace("VERSION", __version__))
"""Every reference by its key."""


def list_citations(
    resolved: Mapping[str, Any],
    sources: Mapping[str, str],
    methods: Collection[str] = (),
    cite: Callable[[Mapping[str, Any]], Iterable[tuple[str, str]]] | None = None,
) -> dict[str, list[str]]:
    """Return what to cite for a study: keys of REFERENCES, and what each was used for.

    Parameters
    ----------
    resolved : the study with every default filled in
    sources : motion -> its label: "real", "stand-in", "user" or that of a set
    methods : keys in METHODS that solve its scenes, buildings alone included
    cite : the same of its question: resolved -> keys, and what each was used for
    """
    uses = defaultdict[str, list[str]](list)
    for key, purpose in (*_iter_scene_references(resolved, methods), *(cite(resolved) if cite else ())):
        uses[key].append(purpose)
    if "stand-in" in sources.values():
        uses["lilhanand1988"].append("the synthesis of the stand-in motions")
    if any(label.startswith(SOURCE_PREFIX) for label in sources.values()):
        uses["fema2009"].append("the sets of recorded motions")
        uses["chiou2008"].append("the records of these sets, of the PEER NGA database")
        uses["talley2023"].append("the files from which they are read")
    return {key: list(dict.fromkeys(uses[key])) for key in REFERENCES if key in uses}


def _iter_scene_references(resolved: Mapping[str, Any], methods: Collection[str]) -> Iterator[tuple[str, str]]:
    """Yield what the time histories of a study rest on: keys of references, and what each is used for."""
    yield "pounding_cli", "the computations"
    yield "spiliopoulos1996", "the model of the buildings, eqs (1) to (4)"
    yield from _iter_law_references(resolved)
    yield from _iter_archetype_references(resolved)
    scale = resolved["records"]["scale"]
    if scale == "table1":
        yield "spiliopoulos1996", "the scales of Table 1"
    yield from _iter_target_references(scale)
    if scale == "table1" or (isinstance(scale, Mapping) and "arias" in scale):
        yield "arias1970", "the intensity by which the motions are scaled"
    for method in (METHODS[name] for name in methods):
        for key, _ in method.citation:
            yield key, f"the method of solution, {method.title}"
        if resolved["estimate"] != "none":
            judge = METHODS["taylor"] if method.takes_step else method  # as solver.estimate has it
            for key, _ in judge.citation:
                yield key, "the finer runs for error and sensitivity"


def _iter_archetype_references(resolved: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield where the numbers of buildings that are only seen come from, and how uncertain they are."""
    buildings = {name: resolved["buildings"][name].get("archetype") for name in resolved["group"]}
    seen = {name: archetype for name, archetype in buildings.items() if archetype}
    if not seen:
        return
    types = ", ".join(f"{name} ({each['type']}, {each['design']})" for name, each in seen.items())
    yield "fema2012", f"the building type of {types}, Tables 5.1, 5.4, 5.5, 5.7 and 5.9"
    if any(each["uncertain"] or each["sample"] for each in seen.values()):
        yield "fema2012", "the dispersion of strength and drift capacity, section 5.4"
        yield "goel1997", "the dispersion of the period"
        yield "porter2002", "the dispersion of the damping"
        yield "mckay1979", "the choice of the buildings that a neighbour may be"


def _iter_target_references(scale: Any) -> Iterator[tuple[str, str]]:
    """Yield the code whose spectrum the motions are scaled to."""
    target = scale.get("target") if isinstance(scale, Mapping) else None
    if isinstance(target, Mapping) and "code" in target:
        rules = CODES[target["code"]]
        yield rules.reference, f"the target spectrum, {rules.clause}"


def _iter_law_references(resolved: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield what the links, storeys, isolators and yield shears of a study rest on."""
    buildings = {name: resolved["buildings"][name] for name in resolved["group"]}
    kinds = {link["link"].partition(" of ")[0] for case in resolved["cases"].values() for link in case["links"]}
    storeys = {building.get("storey_law") for building in buildings.values()}
    for laws, names in ((link_laws(), kinds), (storey_laws(), storeys)):
        for law in laws.values():
            if law.name in names:
                yield from law.citation
    bases = [building.get("foundation") for building in buildings.values()]
    if any(isinstance(base, dict) and (base.get("isolation") or {}).get("friction") for base in bases):
        yield from FrictionPendulum.citation
    if any(building.get("plan") for building in buildings.values()):
        yield "kan1977", "elastic floors that twist"
        yield "kan1981", "floors that twist and yield"
    for name, building in buildings.items():
        has_code = building["yield_shear"] is None and "code" in building["yield"]
        if has_code and not _gives_yield_shears(building.get("plan")):
            yield f"ubc{building['yield']['code'][-4:]}", f"the yield shears of {name}, the separation"


def _gives_yield_shears(plan: Mapping[str, Any] | None) -> bool:
    """Return whether the frame lines of a plan give the yield shears of a building as numbers."""
    shears = [line["yield_shear"] for line in (plan or {}).get("lines") or ()]
    return bool(shears) and all(isinstance(each, list) or each == "never" for each in shears)


def iter_motion_sources(sources: Mapping[str, str]) -> Iterator[str]:
    """Yield where the motions come from, as far as the catalogue knows, one line each.

    sources : as for `list_citations`
    """
    names_of_set = defaultdict[str, list[str]](list)
    for name, kind in sources.items():
        if kind.startswith(SOURCE_PREFIX):
            names_of_set[kind].append(name)
    for kind, names in names_of_set.items():
        yield f"{kind}: {join_limited(names)}; recorded motions of the PEER NGA database, as recorded"
    for name, kind in sources.items():
        if kind.startswith(SOURCE_PREFIX):
            continue
        known = load_catalogue().get(name)
        if known is None or kind.startswith("user"):
            yield f"{name} ({kind}): your own file: cite its source"
            continue
        event = f"{known.title}: {known.event}, {known.date}, magnitude {known.magnitude}, {known.station}"
        origin = "your own file: cite its source"
        if not kind.startswith("real"):
            origin = f"synthesized by pounding_cli from: {'; '.join(known.sources)}"
        yield f"{name} ({kind}): {event}, {known.component}; {origin}"


def list_method_sources(names: Iterable[str]) -> list[str]:
    """Return the publications of methods of solution as lines of Markdown, one a method."""
    lines = []
    for name in names:
        texts = [f"{REFERENCES[key].text}{f' ({where})' if where else ''}" for key, where in METHODS[name].citation]
        lines.append(f"- `{name}`: {'; '.join(texts)}")
    return lines
