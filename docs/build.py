"""Builds the documentation into docs/_build/html: notebooks are run, pages with code are run, a warning is an error.

Everything it needs is on this machine; what it makes beside the site (docs/laboratory, docs/_extra) is not kept in
version control.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path

DOCS = Path(__file__).resolve().parent
SITE = DOCS / "_build" / "html"
EXTRA = DOCS / "_extra"


def symrender(*arguments: str) -> None:
    """Run the command line of this environment."""
    program = "import sys; from symrender.cli import main; sys.exit(main())"
    subprocess.run([sys.executable, "-c", program, *arguments], check=True)


def main() -> None:
    """Run the laboratory, build the pages that open by themselves, then the site around them."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--reuse", action="store_true", help="keep notebooks and pages an earlier build has made")
    options = parser.parse_args()
    EXTRA.mkdir(exist_ok=True)
    made = {
        DOCS / "laboratory" / "README.md": ("lab", "--execute", "-o", str(DOCS / "laboratory")),
        EXTRA / "live.html": ("simulator", "gloss", "-o", str(EXTRA / "live.html")),
        EXTRA / "chapter8.html": ("chapter", "-o", str(EXTRA / "chapter8.html")),
    }
    for path, arguments in made.items():
        if not (options.reuse and path.exists()):
            symrender(*arguments, "--force")
    # figures of the chapter once more, by code that shares nothing with the package; one that differs ends the build
    subprocess.run([sys.executable, str(DOCS / "second_opinion.py"), str(EXTRA / "chapter8.html")], check=True)
    sphinx = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-E", "-a", "-q", "-b", "html"]
    subprocess.run([*sphinx, str(DOCS), str(SITE)], check=True)
    print(f"built {SITE / 'index.html'}")


if __name__ == "__main__":
    main()
