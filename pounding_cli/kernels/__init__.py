"""The numerical heart: numba kernels on flat arrays, no classes."""
