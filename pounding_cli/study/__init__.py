"""Study files: read, validated, and planned as scenes.

Text becomes a tree that knows its lines (`text/`), the tree validated sections (`schema/`), these, at the points of a
sweep (`vary/`), the parts of a study (`construct/`, `study.py`), and the parts a plan of scenes (`run_plan.py`);
`check/` says what is doubtful, and `load.py` calls them all.
docs/architecture.md follows one file through all of them.
"""

from pounding_cli.study.construct.motions import MotionUse
from pounding_cli.study.data import study_of
from pounding_cli.study.load import load_study_file
from pounding_cli.study.run_plan import Plan, PlanRow, make_plan
from pounding_cli.study.study import Study
from pounding_cli.study.vary.axes import Axis

__all__ = ["Axis", "MotionUse", "Plan", "PlanRow", "Study", "load_study_file", "make_plan", "study_of"]
