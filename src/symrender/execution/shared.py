"""Tables that the workers of a cluster are handed, so that none of them makes one."""

from __future__ import annotations

import contextlib
import hashlib
from typing import Any

from symrender.execution.jobs import Job
from symrender.execution.tables import all_given, tables_needed, take_all
from symrender.runtimes.tables import is_had


class SharedTables:
    """What was shared by a client of dask."""

    def __init__(self, client: Any) -> None:
        self._client = client
        self._names: set[str] = set()

    def share(self, job: Job) -> None:
        """Give every worker, and whoever joins later, the tables of a job that this process has.

        What a worker cannot take, of another machine or code, it makes itself.
        """
        needed = tables_needed(job)
        name = "symrender " + hashlib.sha256("".join(need.key for need in needed).encode()).hexdigest()
        if needed and name not in self._names and all(is_had(need) for need in needed):
            self._client.register_plugin(_plugin(job, all_given(needed)), name=name)
            self._names.add(name)

    def forget(self) -> None:
        """Let the scheduler drop them."""
        for name in self._names:
            with contextlib.suppress(Exception):
                self._client.unregister_worker_plugin(name)
        self._names.clear()


def _plugin(job: Job, data: bytes) -> Any:
    """What the scheduler hands to workers as they come: they take the tables of a job as they begin."""
    from distributed import WorkerPlugin

    class Tables(WorkerPlugin):  # type: ignore[misc]
        def setup(self, worker: Any) -> None:
            take_all(tables_needed(job), data)

    return Tables()
