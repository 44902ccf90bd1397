"""Reading scene files of pbrt-v4."""
