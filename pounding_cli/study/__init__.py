"""The study file: schema, units, loading with file:line:column errors, expansion into scenes."""

from pounding_cli.study.data import study_of
from pounding_cli.study.expand import expand
from pounding_cli.study.load import Study, load_study
from pounding_cli.study.plan import Axis, MotionUse, Plan, Row

__all__ = ["Axis", "MotionUse", "Plan", "Row", "Study", "expand", "load_study", "study_of"]
