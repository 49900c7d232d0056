"""The physics of a scene as frozen dataclasses: buildings, code design, foundations, links."""
