"""What the site takes from the code: commands, the keys of a study, methods, the API and the notebooks."""

from __future__ import annotations

import importlib.util
import json
import textwrap
from collections.abc import Iterator
from pathlib import Path

import click

from pounding_cli.cli.main import COMMANDS, cli
from pounding_cli.methods import METHODS
from pounding_cli.questions import load_questions, study_model
from pounding_cli.questions.gap.spec import Gb50011Spec, NtcSpec
from pounding_cli.report.references import list_method_sources
from pounding_cli.study.check.values import format_value
from pounding_cli.study.schema import building as building_spec
from pounding_cli.study.schema import links as link_specs
from pounding_cli.study.schema import records as records_spec
from pounding_cli.study.schema import study as schema
from pounding_cli.study.schema.quantity import PLAUSIBLE_RANGES

ROOT = Path(__file__).parents[2]
_spec = importlib.util.spec_from_file_location("keys", Path(__file__).with_name("keys.py"))
assert _spec is not None
assert _spec.loader is not None
keys = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(keys)
EXAMPLES = ROOT / "docs" / "examples"

API = {
    "Load, run, open": (
        "pounding_cli.api.studies.load_study",
        "pounding_cli.api.studies.run",
        "pounding_cli.api.standing.explain_run",
        "pounding_cli.api.studies.open_results",
    ),
    "A study": ("pounding_cli.study.study.Study",),
    "Results": ("pounding_cli.api.results.Results",),
    "Histories": ("pounding_cli.results.histories.History",),
    "One scene by hand": (
        "pounding_cli.api.scenes.building",
        "pounding_cli.api.scenes.motion",
        "pounding_cli.api.scenes.scene",
        "pounding_cli.solver.solve.solve",
        "pounding_cli.api.scenes.history",
    ),
    "What a scene is made of": (
        "pounding_cli.model.scene.Scene",
        "pounding_cli.model.building.Building",
        "pounding_cli.model.links.Link",
        "pounding_cli.laws.pounding.Pounding",
        "pounding_cli.laws.infill.Infill",
        "pounding_cli.laws.joints.Connector",
        "pounding_cli.records.motion.Motion",
    ),
    "Laws of links": (
        "pounding_cli.laws.law.LinkLaw",
        "pounding_cli.laws.law.Behaviour",
        "pounding_cli.laws.law.set_line",
        "pounding_cli.laws.law.set_open",
        "pounding_cli.laws.law.parameter",
    ),
    "What a solution holds": (
        "pounding_cli.solver.response.Response",
        "pounding_cli.solver.response.BuildingPeaks",
        "pounding_cli.solver.response.LinkPeaks",
        "pounding_cli.solver.response.ColumnPeaks",
        "pounding_cli.model.effects.DroppedEffect",
    ),
    "Exporting and comparing": (
        "pounding_cli.results.export.export",
        "pounding_cli.results.compare.compare",
        "pounding_cli.results.compare.Comparison",
    ),
    "Errors": ("pounding_cli.errors.InputError", "pounding_cli.errors.Issue"),
}
"""Headings of the API's page, and what stands under each."""


MODELS = {
    "The file": study_model(),
    "`records`": records_spec.RecordsSpec,
    "`records.use`: a file of your own": records_spec.RecordFileSpec,
    "`records.use`: a sinusoidal motion": records_spec.SineSpec,
    "`records.use.sine`: several frequencies": records_spec.FrequencyRangeSpec,
    "`records.scale`: Arias intensity": records_spec.AriasSpec,
    "`records.scale`: peak acceleration": records_spec.PgaSpec,
    "`records.scale`: peak velocity": records_spec.PgvSpec,
    "`records.scale`: an ordinate of the spectrum": records_spec.SaSpec,
    "`records.scale`: a target spectrum": records_spec.SpectrumSpec,
    **{f"`records.scale.target`: {name}": spec for name, spec in records_spec.CODE_TARGETS.items()},
    "`buildings.NAME`": building_spec.BuildingSpec,
    "`yield`": building_spec.CodeSpec,
    "`yield`: a base-shear coefficient": building_spec.BaseShearSpec,
    "`stiffness`: by a period and masses": building_spec.StiffnessAtSpec,
    "`rayleigh`": building_spec.RayleighSpec,
    "`foundation`": building_spec.FoundationSpec,
    "`impact`": link_specs.ImpactSpec,
    "`laws.NAME`": link_specs.OwnLawSpec,
    "`cases.NAME`": link_specs.SeveralLinks,
    "`report`": schema.ReportSpec,
    "`keep.histories`": schema.HistoriesSpec,
    **{f"`{each.name}`": each.section.spec for each in load_questions() if each.section is not None},
    "`gap.gb50011`": Gb50011Spec,
    "`gap.ntc2018`, `gap.ntc2008`": NtcSpec,
}
"""Headings of the page of keys, and the mapping under each."""


RATIOS = (
    "base yield shear over weight",
    "link stiffness",
    "contact stiffness",
    "stiffness of a Hertz contact",
    "force of a damper",
)
"""Plausible ranges of ratios: to a weight, or to the stiffness of the stiffest storey."""


def keys_page() -> str:
    """Every key of a study, and the ranges outside which a value is warned about."""
    parts = [
        "# Study keys",
        textwrap.dedent("""\
        Every key of a [study file](../study-file.md), from the schema: what it takes, its default, what it is. "-"
        stands for a number without unit. A case has the keys of all [laws](../laws/index.md) of links, a building
        those of all laws of storeys; each law's page shows its own."""),
    ]
    for heading, model in MODELS.items():
        parts += [f"## {heading}", "\n".join(keys.table(model))]
    lines = ["| quantity | plausible | because |", "|---|---|---|"]
    for name, fits in PLAUSIBLE_RANGES.items():
        ends = (f"{end:g}" if name in RATIOS else format_value(end, fits.units) for end in (fits.low, fits.high))
        lines.append(f"| {name} | {' to '.join(ends)} | {fits.reason} |")
    parts += [
        "## Plausible values",
        "A value outside these ranges is [warned about](../study-file.md#warnings).",
        "\n".join(lines),
        textwrap.dedent("""\
        A motion is also warned about where its peak in the file and its peak as used both exceed 2 g. A peak asked for
        is not checked along an axis of a sweep, which may begin low.

        In a file, numbers without a unit are warned about once for each key: forces, stiffnesses, dashpots, inertias,
        accelerations of at most 3, gaps of at least 0.1. In Python data numbers are SI.

        The stiffnesses of links and contacts are those over the stiffest storey's, that of a Hertz contact at 1 cm of
        penetration; the force of a damper is that at 1 m/s, or at which it slips, over the weight of the heaviest
        floor. The period of a storey is that of the building over its number of storeys, and is not checked for
        buildings of one storey. A gap of zero and a damping of zero are always plausible."""),
    ]
    return "\n\n".join(parts) + "\n"


def methods_page() -> str:
    """Sources of the methods of solution."""
    about = "[What accuracy costs](../accuracy.md#the-methods) describes and compares the methods. Sources:"
    return "\n\n".join(["# Methods", about, "\n".join(list_method_sources(METHODS))]) + "\n"


def commands_page() -> str:
    """Every command: its help, its arguments and options, and its subcommands."""
    parts = ["# Commands", "What `pound COMMAND --help` says. Exit codes: 0 done; 1 some time histories failed, or two "
             "files differ; 2 the input or the output was refused; 70 an internal error; 130 stopped; 141 the reader "
             "of the output has gone.", _help("pound", cli)]  # fmt: skip
    for name in COMMANDS:
        command = cli.get_command(click.Context(cli), name)
        assert command is not None
        parts += [f"## pound {name}", _help(f"pound {name}", command)]
        for inner, sub in getattr(command, "commands", {}).items():
            parts += [f"### pound {name} {inner}", _help(f"pound {name} {inner}", sub)]
    return "\n\n".join(parts) + "\n"


def _help(path: str, command: click.Command) -> str:
    context = click.Context(command, info_name=path, terminal_width=100, max_content_width=100)
    return f"```text\n{command.get_help(context).rstrip()}\n```"


def api_page() -> str:
    """The Python API, drawn from its docstrings."""
    parts = [
        "# Python",
        textwrap.dedent("""\
        What `import pounding_cli as pound` offers, and what it returns. The words are those of the study file; numbers
        are SI. [How to use it from Python](../how-to/python.md) shows it at work."""),
    ]
    for heading, names in API.items():
        parts += [f"## {heading}", *(f"::: {name}" for name in names)]
    return "\n\n".join(parts) + "\n"


def notebook_page(path: Path) -> str:
    """A notebook of the examples: its text, and its code as it stands, without what it shows."""
    parts = []
    for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
        text = "".join(cell["source"])
        parts.append(text if cell["cell_type"] == "markdown" else f"```python\n{text}\n```")
    parts.insert(1, f"This is the notebook [{path.name}]({path.name}), without what it shows.")
    return "\n\n".join(parts) + "\n"


def pages() -> Iterator[tuple[str, str]]:
    """Place in the site and text of every written page."""
    for path in sorted(EXAMPLES.glob("*.ipynb")):
        yield f"examples/{path.stem}.md", notebook_page(path)
    yield "reference/commands.md", commands_page()
    yield "reference/keys.md", keys_page()
    yield "reference/methods.md", methods_page()
    yield "reference/api.md", api_page()


def on_files(files, config):
    """Called by mkdocs: adds the written pages to those that stand in docs/."""
    from mkdocs.structure.files import File

    for path, text in pages():
        files.append(File.generated(config, path, content=text))
    return files
