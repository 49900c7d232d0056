"""Places of the numbers that describe the present step (`Run.clock`) and of its counts (`Run.tally`)."""

from __future__ import annotations

# Doubles: step h [s] and 1 / h; ground acceleration at the step's start and its change over the step [m/s2]; the least
# scale of accelerations that errors are measured by [m/s2]; length of a segment [s]; time elapsed since the segment's
# start, -1 at its end [s]; where in the step it ends [-]: 1 or the place of an event; ground acceleration at the
# segment's start [m/s2] and its slope [m/s3]; no step is longer until the next event or segment [s]; when a storey
# collapses, since the segment's start [s].
(
    H,
    INVERSE_H,
    GROUND,
    GROUND_CHANGE,
    LEAST_SCALE,
    SEGMENT_LENGTH,
    ELAPSED,
    END,
    SEGMENT_GROUND,
    GROUND_SLOPE,
    LONGEST_STEP,
    COLLAPSE_TIME,
) = range(12)
CLOCK_SIZE = 16

# Integers: order of the series; segment; link and guard of the next link event; events in a row at one instant;
# steps, events, orders so far; whether a storey collapses at the step's end.
ORDER, SEGMENT, EVENT_LINK, EVENT_GUARD, EVENTS_AT_INSTANT, STEPS, EVENTS, ORDERS, COLLAPSED = range(9)
TALLY_SIZE = 16
