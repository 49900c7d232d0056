"""docs/study-file.md: its tables are those of the schema, key by key, and its examples are sound."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from pounding_cli.study import (
    building_schema,
    case_schema,
    formulas,
    fragility_keys,
    gap_keys,
    load_study,
    optimise_keys,
    record_schema,
    schema,
    sensitivity_keys,
)  # fmt: skip
from pounding_cli.study.keys import table
from pounding_cli.study.plausible import RANGES, shown

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
    "`buildings.NAME`": building_schema.BuildingSpec,
    "`yield`": building_schema.CodeDesign,
    "`yield`: a base-shear coefficient": building_schema.BaseShear,
    "`stiffness`: by a period and masses": building_schema.StiffnessAt,
    "`rayleigh`": building_schema.Rayleigh,
    "`foundation`": building_schema.FoundationSpec,
    "`impact`": case_schema.Impact,
    "`laws.NAME`": formulas.LawSpec,
    "`cases.NAME`": case_schema.CaseSpec,
    "`report`": schema.ReportSpec,
    "`keep.histories`": schema.HistoriesSpec,
    "`fragility`": fragility_keys.FragilitySpec,
    "`gap`": gap_keys.GapSpec,
    "`sensitivity`": sensitivity_keys.SensitivitySpec,
    "`optimise`": optimise_keys.OptimiseSpec,
    "`gap.gb50011`": gap_keys.Gb50011Spec,
}


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


def test_the_plausible_ranges_are_those_of_the_code():
    page = PAGE.read_text(encoding="utf-8")
    section = page.split("## Warnings\n")[1].split("\n## ")[0]
    rows = [line.strip("| ").split(" | ") for line in section.splitlines() if line.startswith("|")][2:]
    assert [name for name, *_ in rows] == list(RANGES)
    for name, ends, reason in rows:
        fits = RANGES[name]
        pure = " over " in name
        assert ends == " to ".join(f"{end:g}" if pure else shown(end, fits.units) for end in (fits.low, fits.high))
        assert reason == fits.reason
