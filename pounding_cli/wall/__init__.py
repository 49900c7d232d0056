"""The bumper wall of Fig. 8: plane stress and frame elements."""
