"""Puts the independent references of tests/verification in reach of the hard scenes."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "verification"))
