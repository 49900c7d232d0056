"""Study files: read, validated, and planned as scenes."""

from pounding_cli.study.axes import Axis
from pounding_cli.study.data import study_of
from pounding_cli.study.motions import MotionUse
from pounding_cli.study.plan import Plan, PlanRow, make_plan
from pounding_cli.study.study import Study, load_study_file

__all__ = ["Axis", "MotionUse", "Plan", "PlanRow", "Study", "load_study_file", "make_plan", "study_of"]
