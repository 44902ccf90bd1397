"""The version of symrender, as an image's metadata carries it."""

from typing import Final

VERSION: Final = "0.1.0"
