"""Sliders over a scene in a notebook, drawn by Python as they move."""
