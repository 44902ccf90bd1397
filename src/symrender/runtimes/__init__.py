"""Text to callable: compiled by Numba, or run as it is."""
