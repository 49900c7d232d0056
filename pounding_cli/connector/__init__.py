"""Two connected oscillators in closed form (Figs 4 and 5)."""

from pounding_cli.connector.oscillators import ConnectorStudy as Study
from pounding_cli.connector.oscillators import answer as solve
from pounding_cli.connector.oscillators import doubts
from pounding_cli.connector.report import STATEMENTS, VARIABLES, beside, cites, figures, lines
