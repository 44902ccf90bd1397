from __future__ import annotations

import difflib
import os
import shutil
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

import pytest

from symrender.jit.kernel import Kernel

GOLDEN = Path(__file__).parent / "golden"
CHROMIUM = os.environ.get("CHROMIUM") or shutil.which("chromium") or shutil.which("chromium-browser")
FLAGS = (
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)

LONGEST: Final = (
    "simulator/test_means.py",
    "adversary/test_known.py",
    "adversary/test_many.py",
    "radiometric/test_bounced_gradient.py",
    "radiosity/test_crowded.py",
    "radiosity/test_endless.py",
    "simulator/test_page.py",
    "radiosity/test_disks.py",
    "radiometric/test_bounced_pixels.py",
    "radiometric/test_black.py",
    "execution/test_tables.py",
    "simulator/test_panels.py",
    "test_wheel.py",
    "chapter/test_lab.py",
    "adversary/test_evaluator.py",
    "chapter/test_document_page.py",
    "cli/test_long_runs.py",
    "audit/test_audit.py",
    "radiometric/test_hot_places.py",
    "radiometric/test_gradient.py",
    "radiosity/test_cornell.py",
    "radiometric/test_emission_slopes.py",
    "radiometric/test_slopes_of_lights.py",
    "radiometric/test_bounce_of_lights.py",
    "radiometric/test_exposure.py",
    "radiometric/test_cut_bounce.py",
)
"""Files that take longest, which begin first: what begins last must be short, or one worker waits for the other.

Those that draw in a browser stand apart from each other, for it has threads of its own.
"""

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    # a shell starts background jobs deaf to Ctrl-C, and so would be everything the tests start
    signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--update-golden", action="store_true", help="rewrite the files of tests/golden")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """The files of ``LONGEST`` first, in its order; the others keep theirs."""
    rank = {Path(__file__).parent / name: place for place, name in enumerate(LONGEST)}
    if gone := [path.name for path in rank if not path.exists()]:
        raise pytest.UsageError(f"conftest.LONGEST names files that are gone: {gone}")
    items.sort(key=lambda item: rank.get(item.path, len(LONGEST)))


@pytest.fixture
def golden(request: pytest.FixtureRequest) -> Callable[[str, str], None]:
    """Compare a text with the file of that name in tests/golden; a difference is shown as a unified diff."""

    def compare(name: str, text: str) -> None:
        path = GOLDEN / name
        if request.config.getoption("--update-golden"):
            path.write_text(text, encoding="utf-8")
            return
        stored = path.read_text(encoding="utf-8")
        lines = difflib.unified_diff(stored.splitlines(), text.splitlines(), name, "emitted now", lineterm="", n=2)
        if stored != text:
            pytest.fail("\n".join([*lines, "--update-golden rewrites the file"]), pytrace=False)

    return compare


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """Chromium, started once for all the pages of a process: Playwright refuses a second loop beside an open one."""
    sync_api = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    if CHROMIUM is None:
        pytest.skip("no chromium on this machine: apt-get install chromium, or name one in CHROMIUM")
    with sync_api.sync_playwright() as playwright:
        launched = playwright.chromium.launch(executable_path=CHROMIUM, args=list(FLAGS))
        yield launched
        launched.close()


class Clock:
    """The time limit of the test that runs, an alarm of pytest-timeout, which stands still while a kernel is compiled.

    What compiling takes is the machine's business, and the first test that needs a kernel is no slower than the next.
    """

    def __init__(self) -> None:
        self._lock, self._depth = threading.Lock(), 0
        self._left: tuple[float, float] = (0.0, 0.0)

    @contextmanager
    def stopped(self) -> Iterator[None]:
        """Within the block the limit does not run; blocks may lie in each other and in several threads."""
        self.stop()
        try:
            yield
        finally:
            self.go_on()

    def stop(self) -> None:
        with self._lock:
            if self._depth == 0 and hasattr(signal, "setitimer"):
                self._left = signal.setitimer(signal.ITIMER_REAL, 0.0)
            self._depth += 1

    def go_on(self) -> None:
        with self._lock:
            self._depth -= 1
            if self._depth == 0 and self._left[0] > 0.0:
                signal.setitimer(signal.ITIMER_REAL, *self._left)


CLOCK: Final = Clock()


@contextmanager
def alone(path: Path) -> Iterator[bool]:
    """Within the block no other process is in one of the same file; gives whether one was, and had to be waited for."""
    import fcntl

    with path.open("w") as file:
        waited = False
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            waited = True
            fcntl.flock(file, fcntl.LOCK_EX)
        try:
            yield waited
        finally:
            # a process forked meanwhile has the file open too
            fcntl.flock(file, fcntl.LOCK_UN)


@pytest.fixture(scope="session", autouse=True)
def compiling_takes_no_time(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Our own compiling, where of two workers that need the same kernel at the same time one compiles it.

    Kernels of one function have most of their parts in common, whatever their types, so one is compiled at a time.
    """
    translate, folder = Kernel._compile, tmp_path_factory.getbasetemp().parent
    shared = "PYTEST_XDIST_WORKER" in os.environ and sys.platform != "win32"

    def untimed(kernel: Kernel, *types: Any) -> Any:
        with CLOCK.stopped():
            if not shared:
                return translate(kernel, *types)
            with alone(folder / f"{'.'.join(kernel.name)}.compiling") as waited:
                made = kernel._read(*types) if waited else None
                return translate(kernel, *types) if made is None else made

    Kernel._compile = untimed  # type: ignore[method-assign]
    yield
    Kernel._compile = translate  # type: ignore[method-assign]


@pytest.fixture(autouse=True)
def numba_takes_no_time() -> Iterator[None]:
    """Numba's, in tests that begin when some test has imported it."""
    if "numba" not in sys.modules:
        yield
        return
    from numba.core import event

    class Listener(event.Listener):  # type: ignore[misc]
        def on_start(self, event: Any) -> None:
            CLOCK.stop()

        def on_end(self, event: Any) -> None:
            CLOCK.go_on()

    with event.install_listener("numba:compile", Listener()):
        yield
