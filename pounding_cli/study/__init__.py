"""Study files: read, validated, and planned as scenes.

Text becomes a tree that knows its lines (`file.py`), the tree validated sections (`schema.py` and the `..._spec.py`),
these the parts of a study at the points of its sweep (`resolve.py`), and the parts a plan of scenes (`plan.py`);
docs/architecture.md follows one file through all of them.
"""

from pounding_cli.study.axes import Axis
from pounding_cli.study.data import study_of
from pounding_cli.study.motions import MotionUse
from pounding_cli.study.plan import Plan, PlanRow, make_plan
from pounding_cli.study.study import Study, load_study_file

__all__ = ["Axis", "MotionUse", "Plan", "PlanRow", "Study", "load_study_file", "make_plan", "study_of"]
