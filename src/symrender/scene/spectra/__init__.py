"""Spectra as linear RGB: tables of the standard observer, curves, black bodies."""
