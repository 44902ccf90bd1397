"""Scene files of pbrt-v4, as far as they mean what a radiometric scene says."""
