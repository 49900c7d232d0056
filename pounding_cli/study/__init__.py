"""The study file: schema, units, loading with file:line:column errors, expansion into scenes."""

from pounding_cli.study.axes import Axis
from pounding_cli.study.data import study_of
from pounding_cli.study.expand import expand
from pounding_cli.study.motions import MotionUse
from pounding_cli.study.plan import Plan, Row
from pounding_cli.study.study import Study, load_study

__all__ = ["Axis", "MotionUse", "Plan", "Row", "Study", "expand", "load_study", "study_of"]
