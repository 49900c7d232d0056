"""What the solver costs, beside other programs and as scenes grow: `python -m tests.bench` (`make bench`).

`docs/figures/bench.json` keeps what was measured, `docs/performance.md` shows it.
"""
