"""Scattering, a file each: value, density and choice of a direction, in the frame of the surface, z its normal.

``wo`` and ``wi`` are unit vectors to the eye, above the surface, and to the light. ``dispatch.py`` is their one list.
"""
