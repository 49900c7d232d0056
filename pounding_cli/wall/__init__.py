"""The bumper wall of Fig. 8: plane stress and frame elements, struck by a floor."""

from pounding_cli.wall.impact import strike as solve
from pounding_cli.wall.report import STATEMENTS, VARIABLES, cites, figures, lines
from pounding_cli.wall.report import write_fields as beside
from pounding_cli.wall.study import WallStudy as Study
from pounding_cli.wall.study import doubts
