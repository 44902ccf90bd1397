"""What is raised where a kernel leaves the subset of Python that is translated."""

from __future__ import annotations


class Refused(Exception):
    """A construct outside the subset: its file, line and the reason; see ``docs/kernels.md``."""

    def __init__(self, reason: str, file: str = "", line: int = 0) -> None:
        super().__init__(f"{file}:{line}: {reason}" if file else reason)
        self.reason, self.file, self.line = reason, file, line
