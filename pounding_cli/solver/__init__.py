"""From a scene to its response: elements and records, one kernel, peaks and energies, and how far to trust them."""
