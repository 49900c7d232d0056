"""Where the time of a run stands: the places of the step's numbers in `Run.clock`, of its counts in `Run.tally`."""

from __future__ import annotations

# Doubles: step h [s] and 1 / h; ground acceleration at the step's start and its change over the step [m/s2]; what is
# not resolved [m/s2]; length of a segment [s]; time since the segment's start, -1 at its end [s]; where in the step it
# stops [-]; ground acceleration at the segment's start [m/s2] and its slope [m/s3]; no step of the segment is longer
# until something happens [s].
H, PER_H, GROUND, CHANGE, QUIET, LENGTH, SINCE, END, START, SLOPE, PACE = range(11)
CLOCK = 16

# Integers: order of the series; segment; link and guard of the next link event; events in a row without time going on;
# steps, events, orders so far.
ORDER, SEGMENT, LINK, GUARD, STANDING, STEPS, EVENTS, ORDERS = range(8)
TALLY = 8
