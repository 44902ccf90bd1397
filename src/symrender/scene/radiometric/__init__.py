"""Scenes in radiometric units: their materials, shapes and lights, and the same as records."""
