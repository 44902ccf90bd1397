"""Certify: the lobe integral enclosed by balls, with no estimate in it."""
