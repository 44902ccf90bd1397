"""Help that fits a screen or two: of a verb with many options those that matter to most, all by ``--help-all``."""

from __future__ import annotations

from typing import Any, Final

import typer
from typer.core import TyperCommand

OPTION_PANELS: Final = {
    "Estimators": (
        *("lobe", "numeric", "normalised", "symbolic", "weights", "nodes", "partition", "disk", "aa", "tol", "budget"),
        *("seed", "silhouettes", "estimators"),
    ),
    "How the work is done": (
        *("threads", "tile", "cluster", "insecure_cluster", "resume", "restart", "max_pixels", "progress_mode"),
        "preview",
    ),
    "What is written": ("out", "force", "views", "exposure", "tonemap", "layers", "video", "rate", "open_"),
    "What is printed": ("json", "quiet"),
}
"""Options many verbs have, as their help groups them."""

RARE: Final = frozenset(
    (
        *("normalised", "weights", "disk", "aa", "budget", "seed"),
        *("tile", "cluster", "insecure_cluster", "restart", "max_pixels", "progress_mode"),
    )
)
"""Options whose defaults are left alone in all but few runs."""
_MANY: Final = 14
_WHOLE: Final = "symrender.help_all"


class Verb(TyperCommand):
    """A command whose help, where it is long, leaves out what is rare and says so."""

    def group_options(self) -> None:
        """Give the options of a verb with many of them their headings, and ``--help-all``."""
        if len(self.params) < _MANY:
            return
        for parameter in self.params:
            panel = next((name for name, members in OPTION_PANELS.items() if parameter.name in members), None)
            if panel is not None:
                parameter.rich_help_panel = panel  # type: ignore[attr-defined]
        self.context_settings["help_option_names"] = ["-h", "--help", "--help-all"]

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Read the arguments; which of the names of help was given is kept for it."""
        ctx.meta[_WHOLE] = "--help-all" in args
        return super().parse_args(ctx, args)

    def format_help(self, ctx: Any, formatter: Any) -> None:
        """Print the help, all of it where it is short or ``--help-all`` was asked for."""
        short = "--help-all" in ctx.help_option_names and not ctx.meta.get(_WHOLE)
        left_out: list[Any] = [p for p in self.params if short and p.name in RARE]
        for parameter in left_out:
            parameter.hidden = True
        try:
            super().format_help(ctx, formatter)
        finally:
            # completion leaves out what is hidden
            for parameter in left_out:
                parameter.hidden = False
        if left_out:
            typer.echo(f" {len(left_out)} more options, rarely needed: {ctx.command_path} --help-all")
