"""The bumper wall of Fig. 8: plane stress and frame elements, struck by a floor."""

from pounding_cli.wall.impact import solve
from pounding_cli.wall.report import SHOWN, cites, pictures
from pounding_cli.wall.study import Study
