"""Quadrature of the lobe integral: rules, strata, and the rule that splits at the walls."""
