"""Small scenes are those of the verification tests."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "verification"))
