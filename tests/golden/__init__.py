"""Whole studies and the tables that the program gave for them: `python -m tests.golden`."""
