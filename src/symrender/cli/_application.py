"""The typer application, assembled from the verbs found in this folder."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Final

import typer

from symrender.cli._help import Verb
from symrender.version import VERSION

EXIT_CODES = (
    "Exit codes: 0 success; 1 two images differ or an audit failed; 2 wrong input; 3 non-finite pixels, or an "
    "undecided audit; 4 a missed tolerance; 70 a fault in symrender; 74 the output could not be written; 130 "
    "interrupted."
)

_VERSION: Final = "--version"

PANELS = {
    "Draw": ("demo", "render", "truth", "gradient", "animate", "sweep"),
    "Ask": ("probe", "expression", "fit", "study"),
    "Look": ("info", "view", "compare", "audit", "simulator", "chapter", "lab"),
    "Carry": ("convert", "export", "suite"),
    "Know": ("scenes", "params", "doctor", "cite"),
}
"""The verbs by what one wants, as the help groups them."""


def panel_of(verb: str) -> str:
    """The heading a verb stands under."""
    return next(name for name, members in PANELS.items() if verb in members)


def verbs() -> list[str]:
    """Names of the commands: the modules of this folder without a leading underscore."""
    return sorted(m.name for m in pkgutil.iter_modules([str(Path(__file__).parent)]) if not m.name.startswith("_"))


def verbs_for(arguments: Sequence[str]) -> list[str]:
    """The verbs that ``arguments`` may ask for: the first of them where it is one, none for the version, else all.

    To read the options of all takes a tenth of a second.
    """
    first = next(iter(arguments), "")
    known = verbs()
    return [first] if first in known else [] if first == _VERSION else known


def application(arguments: Sequence[str] = ()) -> Any:
    """The command line as one command object, of the verbs that ``arguments`` may ask for."""
    app = typer.Typer(
        no_args_is_help=True,
        rich_markup_mode="markdown",
        pretty_exceptions_enable=False,
        context_settings={"help_option_names": ["-h", "--help"]},
        epilog=EXIT_CODES,
    )

    @app.callback()
    def symrender_(
        version: Annotated[
            bool, typer.Option(_VERSION, callback=_version, is_eager=True, help="Print the version.")
        ] = False,
        debug: Annotated[bool, typer.Option("--debug", help="Show the traceback of an error.")] = False,
        allow_outside: Annotated[
            bool,
            typer.Option("--allow-outside", help="Let scenes of Mitsuba and pbrt name files outside their folder."),
        ] = False,
    ) -> None:
        """The oracle for rendering: glossy reflection integrated numerically and symbolically, errors stated.

        Example: symrender render gloss --size 256 --out pictures
        """

    for name in sorted(verbs_for(arguments), key=_order):
        module = importlib.import_module(f"symrender.cli.{name}")
        app.command(name, cls=Verb, epilog=EXIT_CODES, rich_help_panel=panel_of(name))(getattr(module, name))
    command: Any = typer.main.get_command(app)
    for verb in command.commands.values():
        verb.group_options()
    return command


def _order(verb: str) -> tuple[int, int]:
    panels = list(PANELS)
    panel = panel_of(verb)
    return panels.index(panel), PANELS[panel].index(verb)


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"symrender {VERSION}")
        raise typer.Exit
