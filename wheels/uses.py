"""Names of the first uses in ``first_uses``, in an order that keeps two processes busy: the longest first.

Apart from it because who lists them does not import the package: a process each compiles them.
"""

from __future__ import annotations

from typing import Final

USES: Final = ("slopes", "chambers", "radiometric_slopes", "radiometric", "means", "bumps", "pair", "faces")
"""What two of them compile takes seconds: closed forms of images stand under all that is made of them."""
