"""A solver for tests of clusters: its answers are known, and it takes long enough to be killed at."""

import time

from tests.helpers.plans import known


def solve_slowly(scene, **options):
    time.sleep(0.02)
    return known(scene, options["accuracy"], options["method"])
