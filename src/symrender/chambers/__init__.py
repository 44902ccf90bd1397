"""Chambers: where the lobe integrand stops being smooth, in closed form along scan lines."""
