"""Scenes and formulas carried to other renderers."""
