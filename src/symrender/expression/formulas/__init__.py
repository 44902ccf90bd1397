"""The smooth formulas of the symbolic side, each written once; ``every.py`` lists them."""
