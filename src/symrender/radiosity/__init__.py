"""Diffuse light between flat faces: tables of what they send, and what a place gathers of it."""
