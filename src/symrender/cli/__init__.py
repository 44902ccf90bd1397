"""The command line: ``symrender VERB``; a verb is a file of this folder holding a function of its own name.

Files that begin with an underscore hold what verbs share. Nothing slow is imported before a verb needs it. A verb has
as many arguments as it has options, for its signature is what typer reads them from.
"""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Sequence

from symrender.cli._deadline import ends_in_time
from symrender.cli._signals import interruptible
from symrender.errors import SceneError, SymrenderError
from symrender.scene.files import outside_allowed

_INTERRUPTED = 130
_OUTPUT_FAILED = 74
_FAULT = 70
_ALLOW = "--allow-outside"


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line ``argv`` (default: that of the process) and return its exit code.

    A failure is one line on stderr, ``ERROR what: where: what was read, what was expected``; ``--debug`` anywhere
    shows the traceback instead. A process that runs its own command line ends within a second of Ctrl-C.
    """
    if argv is not None:
        # the process is somebody else's, who would not want it ended
        return _run(list(argv))
    with ends_in_time(_cut_short):
        return _run(sys.argv[1:])


def _run(arguments: list[str]) -> int:
    debug = "--debug" in arguments
    try:
        with interruptible():
            from symrender.cli._application import application

            given = [a for a in arguments if a not in ("--debug", _ALLOW)]
            with outside_allowed(_ALLOW in arguments):
                code = application(given).main(given, "symrender", standalone_mode=False)
            sys.stdout.flush()
    except KeyboardInterrupt:
        code = _INTERRUPTED
    except SystemExit as leave:
        if not isinstance(leave.__context__, BrokenPipeError):
            raise
        return _reader_gone()
    except BrokenPipeError:
        return _reader_gone()
    except Exception as error:
        if debug:
            raise
        return _report(error)
    if code == _INTERRUPTED:
        return _fail("interrupted", _INTERRUPTED)
    return code if isinstance(code, int) else 0


def _cut_short(number: int) -> None:
    if 128 + number == _INTERRUPTED:
        # the main thread may hold the lock of stderr or of an import
        os.write(2, b"ERROR interrupted\n")


def _report(error: Exception) -> int:
    if isinstance(error, SceneError):
        # one fault of a scene a line
        return max(_fail(line, error.exit_code) for line in str(error).splitlines() or [""])
    if isinstance(error, SymrenderError):
        return _fail(str(error), error.exit_code)
    if isinstance(error, MemoryError):
        return _fail("out of memory; ask for a smaller size", 2)
    if isinstance(error, OSError):
        return _fail(f"{error.filename or 'output'}: {error.strerror or error}", _OUTPUT_FAILED)
    usage = getattr(error, "format_message", None)
    if usage is not None:
        # without a command the help has been printed, and there is nothing to add
        return _fail(_choice(usage()), 2) if usage() else 2
    return _fail(f"a fault in symrender: {type(error).__name__}: {error}; --debug shows where", _FAULT)


def _reader_gone() -> int:
    # keep the interpreter from failing once more when it flushes at exit
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    return _OUTPUT_FAILED


def _fail(message: str, code: int) -> int:
    from symrender.scene.printable import printable

    print(f"ERROR {printable(' '.join(message.split()), 400)}", file=sys.stderr)
    return code


def _choice(message: str) -> str:
    """A usage error; where a value is none of an option's choices, with what it may have meant."""
    found = re.fullmatch(r"(Invalid value for .*?: )(?:Value error, )?'([^']*)' is not one of ('.*')\.?", message)
    if found is None:
        return message
    from symrender.scene.nearest import did_you_mean

    choices = re.findall(r"'(.*?)'", found[3])
    return f"{found[1]}'{found[2]}' is not one of {', '.join(choices)}{did_you_mean(found[2], choices)}"
