"""Imported by the process from which runs that are killed are forked: has every question answered once, so that what
they need is loaded."""

import tempfile
from pathlib import Path

from tests.matrix.work import STUDIES, answered, written

for workflow in STUDIES:
    with tempfile.TemporaryDirectory() as folder:
        answered(workflow, "serial", written(workflow, Path(folder)), Path(folder, "r.h5"))
