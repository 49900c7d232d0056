"""The results file: HDF5 written and read."""
