"""Mitsuba 3 scene files, as far as they mean what a radiometric scene says."""
