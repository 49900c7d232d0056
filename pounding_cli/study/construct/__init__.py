"""From validated sections to objects of `model/`, `laws/` and `records/`, at every point of the sweep."""
