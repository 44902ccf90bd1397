"""What a ray sees, as SymPy expressions: the formulas of the symbolic pipeline, each written once."""
