"""Two connected oscillators in closed form (Figs 4 and 5)."""

from pounding_cli.connector import report
from pounding_cli.connector.oscillators import USUAL, ConnectorStudy, answer, doubts
from pounding_cli.points import Question

QUESTION = Question(
    "connector", ConnectorStudy, USUAL, answer, report.VARIABLES, report.lines, report.STATEMENTS, report.figures,
    report.cites, doubts=doubts,
)  # fmt: skip
