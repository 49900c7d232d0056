"""The literature behind laws, codes, measures, methods and questions: `references.bib` beside this module, read."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from pounding_cli import __version__

_ENTRY = re.compile(r"^@(\w+)\{([^,\s]+),\n(.*?)^\}$", re.MULTILINE | re.DOTALL)
_FIELD = re.compile(r"^  (\w+) = \{(.*)\},?$", re.MULTILINE)


@dataclass(frozen=True)
class Reference:
    """One entry.

    key : its BibTeX key, the first author's family name and the year
    fields : BibTeX field -> value, without the escapes of BibTeX
    bibtex : the entry for a .bib file (UTF-8)
    """

    key: str
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
    """The entries of a .bib file that has one field a line, by key in the order of the file.

    Raises
    ------
    ValueError : an entry has a line that is no field, or a key is there twice
    """
    found: dict[str, Reference] = {}
    for entry in _ENTRY.finditer(text):
        key, body = entry[2], entry[3]
        fields = {name: re.sub(r"\\([&%#_])", r"\1", value) for name, value in _FIELD.findall(body)}
        if len(fields) != len(body.splitlines()):
            raise ValueError(f"{key}: a line is no `  field = {{value}},`")
        found[key] = Reference(key, fields, entry[0])
    if len(found) != text.count("\n@"):
        raise ValueError(
            "a key is there twice, or an entry does not begin with `@kind{key,` or end with `}` on a line of its own"
        )
    return found


REFERENCES = read(
    Path(__file__).with_name("references.bib").read_text(encoding="utf-8").replace("VERSION", __version__)
)
"""Every reference by its key."""
