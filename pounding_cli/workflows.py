"""The workflows: every question that `pound` answers, what it adds to a study file, and where each part of it is made.

They are stated here alone; commands, results files, reports and citations read this list. A part is named as
"module:name" and imported when it is needed, so that reading the list costs nothing.

A workflow proposes scenes (`expand`, then `refine` as often as it likes); the one batch solves them with every engine,
resume and progress (`batch.run_plan`), the one store keeps them, and `tables` says what follows from them."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from pounding_cli.errors import InputError, Problem


@dataclass(frozen=True)
class Workflow:
    """One kind of question.

    Parameters
    ----------
    name : its command, its section of a study file, and the root attribute `workflow` of its results files
    title : its line in `pound --help`
    marks : top-level keys that only its studies have; none where its studies are those of `pound run`
    shows : tables that it adds to a results file
    schema : pydantic model of its section of a study file
    question : (Study) -> what its section asks; raises `InputError` where it asks what the study cannot answer
    expand : (study) -> Plan, the scenes of the first round
    refine : (Plan, responses by digest) -> Plan of the next round, which holds the scenes of all rounds before;
        None when nothing is left to ask
    tables : (Plan, read) -> list of `store.answers.Table`; `read(name)` gives a variable over the whole study, shape
        (swept axes, dimensions of the variable)
    page : (Results, Evidence of the point shown, with_figures) -> `report.answer_page.AnswerPage`: what the report says
        and draws in place of the ratios to the building alone
    cite : (resolved study, used) -> None; calls `used(key of REFERENCES, what for)`
    sampled : whether its last swept axis holds samples that nobody wrote: reports show none of them by itself
    """

    name: str
    title: str
    marks: tuple[str, ...] = ()
    shows: tuple[str, ...] = ()
    schema: str = ""
    question: str = ""
    expand: str = ""
    refine: str = ""
    tables: str = ""
    page: str = ""
    cite: str = ""
    sampled: bool = False

    @property
    def is_section(self) -> bool:
        """Whether it asks by a section of a study of `pound run`."""
        return bool(self.schema) and not self.marks

    def part(self, name: str) -> Any:
        """One of its parts, imported; None where it has none."""
        place = getattr(self, name)
        if not place:
            return None
        module, _, attribute = place.partition(":")
        return getattr(importlib.import_module(module), attribute)


_LIST = (
    Workflow(
        "run",
        "Run a study and print its summary.",
        ("records", "buildings", "group", "cases"),
        expand="pounding_cli.study.expand:expand",
    ),
    Workflow(
        "gap",
        "Find how wide the gap must be.",
        shows=("gap", "gap_cases", "property_line"),
        schema="pounding_cli.study.questions:GapSpec",
        expand="pounding_cli.study.gap:expand_gap",
        tables="pounding_cli.store.gap:gap_tables",
        page="pounding_cli.report.gap:gap_page",
        cite="pounding_cli.report.gap:cite_gap",
    ),
    Workflow(
        "fragility",
        "Find how likely limits are passed.",
        shows=("fragility", "fragility_motions"),
        schema="pounding_cli.study.questions:FragilitySpec",
        question="pounding_cli.study.fragility:question_of",
        expand="pounding_cli.study.fragility:expand_fragility",
        refine="pounding_cli.study.fragility_rounds:refine_fragility",
        tables="pounding_cli.store.fragility:fragility_tables",
        page="pounding_cli.report.fragility:fragility_page",
        cite="pounding_cli.report.fragility:cite_fragility",
    ),
    Workflow(
        "sensitivity",
        "Find which uncertain keys matter most.",
        shows=(
            "sensitivity",
            "sensitivity_outputs",
            "sensitivity_samples",
            "sensitivity_claims",
            "sensitivity_thresholds",
            "sensitivity_verdicts",
        ),
        schema="pounding_cli.study.questions:SensitivitySpec",
        question="pounding_cli.study.sensitivity:question_of",
        expand="pounding_cli.study.sensitivity:expand_sensitivity",
        tables="pounding_cli.report.claim_samples:sensitivity_and_claims",
        page="pounding_cli.report.sensitivity:sensitivity_page",
        cite="pounding_cli.report.sensitivity:cite_sensitivity",
        sampled=True,
    ),
    Workflow(
        "optimise",
        "Find the best values of keys.",
        shows=("optimise", "optimise_design", "optimise_points"),
        schema="pounding_cli.study.questions:OptimiseSpec",
        question="pounding_cli.study.optimise:question_of",
        expand="pounding_cli.study.optimise:expand_optimise",
        refine="pounding_cli.store.optimise:refine_optimise",
        tables="pounding_cli.store.optimise:optimise_tables",
        page="pounding_cli.report.optimise:optimise_page",
        cite="pounding_cli.report.optimise:cite_optimise",
        sampled=True,
    ),
)

WORKFLOWS: Mapping[str, Workflow] = {workflow.name: workflow for workflow in _LIST}
"""Every workflow by name."""


def expansion(name: str) -> Callable[..., Any]:
    """`expand` of a workflow.  Raises InputError: there is none of that name."""
    if name not in WORKFLOWS:
        raise InputError(Problem(f"there is no workflow {name}", f"write one of {', '.join(WORKFLOWS)}"))
    return WORKFLOWS[name].part("expand")
