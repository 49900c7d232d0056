"""The bumper wall of Fig. 8: plane stress and frame elements, struck by a floor."""

from pounding_cli.points import Question
from pounding_cli.wall import report
from pounding_cli.wall.impact import strike
from pounding_cli.wall.study import USUAL, WallStudy

QUESTION = Question(
    "wall", WallStudy, USUAL, strike, report.VARIABLES, report.lines, report.STATEMENTS, report.figures, report.cites,
    report.write_fields,
)  # fmt: skip
