"""docs/study-file.md: its tables are those of the schema, key by key, and its examples are sound."""

from __future__ import annotations

import re
import typing
from pathlib import Path

import pytest

from pounding_cli.study import load_study, record_schema, schema
from pounding_cli.study.rules import StiffnessRule
from pounding_cli.study.units import Quantity, TextForm

PAGE = Path("docs/study-file.md")
MODELS = {
    "The file": schema.StudyModel,
    "`records`": record_schema.Records,
    "`records.use`: a file of your own": record_schema.RecordFile,
    "`records.scale`: Arias intensity": record_schema.AriasScale,
    "`records.scale`: peak acceleration": record_schema.PgaScale,
    "`records.scale`: peak velocity": record_schema.PgvScale,
    "`records.scale`: an ordinate of the spectrum": record_schema.SaScale,
    "`records.scale`: a target spectrum": record_schema.SpectrumScale,
    "`buildings.NAME`": schema.BuildingSpec,
    "`yield`": schema.CodeDesign,
    "`rayleigh`": schema.Rayleigh,
    "`foundation`": schema.FoundationSpec,
    "`impact`": schema.Impact,
    "`cases.NAME`": schema.CaseSpec,
    "`report`": schema.ReportSpec,
    "`keep.histories`": schema.HistoriesSpec,
}


def forms(annotation: object) -> str:
    """The values a field takes, in a few words."""
    found: list[str] = []

    def visit(kind: object) -> None:
        if typing.get_origin(kind) is typing.Annotated:
            inner, *extras = typing.get_args(kind)
            for extra in extras:
                if isinstance(extra, Quantity):
                    found.append(
                        ", ".join(filter(None, [extra.si or "-", extra.range, *map("`{}`".format, extra.words)]))
                    )
                    return
                if isinstance(extra, TextForm):
                    found.append("N/m, or a multiple of a storey's")
                    return
            visit(inner)
        elif typing.get_origin(kind) is typing.Literal:
            found.extend(f"`{word}`" for word in typing.get_args(kind))
        elif typing.get_origin(kind) is tuple:
            before = len(found)
            visit(typing.get_args(kind)[0])
            found[before:] = [f"list of {' / '.join(found[before:])}"]
        elif typing.get_origin(kind) is dict:
            found.append("mapping")
        elif typing.get_args(kind):
            for part in typing.get_args(kind):
                visit(part)
        elif isinstance(kind, type) and kind is not type(None) and kind is not StiffnessRule:
            word = {"str": "text", "int": "whole number", "bool": "`true`, `false`", "float": "number"}
            found.append(word.get(kind.__name__, "mapping"))

    visit(annotation)
    return "; ".join(dict.fromkeys(found)) or "mapping or list"


def default(field: object) -> str:
    """The default as a user would write it."""
    if field.is_required():
        return "required"
    value = field.default
    if value is None or value in ("", {}):
        return ""
    if isinstance(value, schema.Model):
        return "see below"
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    if isinstance(value, tuple):
        return f"`[{', '.join(value)}]`"
    return f"`{value:g}`" if isinstance(value, float) else f"`{value}`"


def table(model: type[schema.Model]) -> list[str]:
    lines = ["| key | value | default | what it is |", "|---|---|---|---|"]
    for name, field in model.model_fields.items():
        annotation = typing.get_type_hints(model, include_extras=True)[name]
        cells = (f"`{field.alias or name}`", forms(annotation), default(field), field.description)
        lines.append(f"| {' | '.join(cells)} |")
    return lines


@pytest.mark.parametrize("heading", MODELS)
def test_table_is_that_of_the_schema(heading):
    text = PAGE.read_text(encoding="utf-8")
    section = re.split(r"^#+ ", text.split(f"# {heading}\n", 1)[1], maxsplit=1, flags=re.MULTILINE)[0]
    shown = [line for line in section.splitlines() if line.startswith("|")]
    wanted = table(MODELS[heading])
    assert shown == wanted, "the table should read:\n" + "\n".join(wanted)


def test_examples_are_sound(tmp_path):
    blocks = re.findall(r"```yaml\n(.*?)```", PAGE.read_text(encoding="utf-8"), flags=re.DOTALL)
    whole = [block for block in blocks if block.startswith("title:")]
    assert whole
    for block in whole:
        path = tmp_path / "study.yaml"
        path.write_text(block, encoding="utf-8")
        load_study(path)


CASES = """title: x
records: {use: [elcentro], duration: 5 s}
buildings:
  stiff: {storeys: 5, period: 0.36 s}
  soft: {like: stiff, period: 0.60 s}
group: [soft, stiff, soft]
"""


def test_case_examples_are_sound(tmp_path):
    """Blocks that begin with `cases:` belong to a group of three."""
    blocks = re.findall(r"```yaml\n(cases:.*?)```", PAGE.read_text(encoding="utf-8"), flags=re.DOTALL)
    assert blocks
    for block in blocks:
        path = tmp_path / "study.yaml"
        path.write_text(CASES + block, encoding="utf-8")
        load_study(path)
