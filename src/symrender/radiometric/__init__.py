"""Radiometric scenes on the symbolic side: emission and direct light in closed form, from the emitted formulas."""
