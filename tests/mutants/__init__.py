"""Deliberate faults in physics and numerics, each with the test that has to see it: `python -m tests.mutants`."""
