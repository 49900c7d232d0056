"""From a scene to its response: arrays, methods, accuracy."""
