"""Say what is compiled, as a command needs it."""

from __future__ import annotations

import logging
import sys


def announce_compilation() -> None:
    """On a terminal, print a line on standard error when a kernel is compiled: which, and about how long it takes.

    Only a command may do this: it has its process to itself.
    """
    log = logging.getLogger("symrender")
    if sys.stderr.isatty() and not log.handlers:
        handler = logging.StreamHandler()
        handler.setFormatter(logging.Formatter("%(message)s"))
        log.addHandler(handler)
        log.setLevel(logging.INFO)
