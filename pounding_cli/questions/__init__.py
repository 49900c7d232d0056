"""The questions that `pound` answers, one folder or file each; a line in `TITLES` adds one.

Everything of a question follows from its `QUESTION` (`question.py`): its command, the section of a study that says what
it asks, its tables with their columns, what its report says and draws, and what it cites. Read a folder in this order:
`spec.py` (the section of the study), `tables.py` (the columns of the answer), `question.py` (the `StudyQuestion`, which
has the time histories solved and makes the tables), `words.py` and `figures.py` (what is said and drawn of the tables).
"""

from __future__ import annotations

import functools
import importlib
import json
from typing import TYPE_CHECKING

from pounding_cli.errors import InputError

if TYPE_CHECKING:
    from pounding_cli.questions.question import Question
    from pounding_cli.study.schema.study import StudySpec

TITLES = {
    "run": "Run a study and print its summary.",
    "gap": "Find how wide the gap must be.",
    "fragility": "Find how likely limits are passed.",
    "sensitivity": "Find which uncertain keys matter most.",
    "optimise": "Find the best values of keys.",
    "screen": "Rank the pairs of neighbours of a street by how often they strike.",
}
"""Every question by the name of its module here, with its line in `pound --help`."""


@functools.cache
def load_question(name: str) -> Question:
    """Return a question by its name.  Raises InputError: there is none."""
    if name not in TITLES:
        raise InputError(f"there is no question {name}", f"write one of {', '.join(TITLES)}")
    question: Question = importlib.import_module(f"pounding_cli.questions.{name}").QUESTION
    return question


def load_questions() -> list[Question]:
    """Return all questions."""
    return [load_question(name) for name in TITLES]


@functools.cache
def study_model() -> type[StudySpec]:
    """Return the model of a study with the sections of all questions."""
    from pounding_cli.study.schema.study import add_sections

    return add_sections(tuple(each.section for each in load_questions() if each.section is not None))


def schema_text() -> str:
    """Return the JSON Schema of study files, for editors."""
    from pounding_cli.study.schema.study import json_schema

    return json.dumps(json_schema(study_model()), indent=2, ensure_ascii=False) + "\n"
