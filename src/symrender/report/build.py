"""The report: one offline HTML file with the pictures as numbers, their errors, the ledger and the way to them."""

from __future__ import annotations

import base64
import hashlib
import html as html_text
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any, Final

import numpy as np

from symrender.execution.tiles import Progress
from symrender.images.output import write_bytes
from symrender.limits import MAX_PIXELS
from symrender.report.demo import Demo, Finished, demo
from symrender.report.pixels import packed
from symrender.report.strip import strip
from symrender.scene.dump import to_yaml
from symrender.scene.load import load
from symrender.scene.scene import Scene
from symrender.settings import ESTIMATORS, Estimators, Settings, image_size
from symrender.simulator.build import escaped
from symrender.truth import STATUS
from symrender.version import VERSION

_SCRIPTS: Final = ("unpack.js", "paint.js", "stage.js", "readout.js", "page.js")
_LAYERS: Final = ("radiance", "gloss")


@dataclass(frozen=True)
class Report:
    """The page of a ``demo``: ``html`` is the whole file; shown inline in a notebook."""

    html: str
    demo: Demo

    def save(self, path: str | Path, *, force: bool = True) -> None:
        """Write the page; ``OutputError`` when it cannot be written."""
        write_bytes(path, self.html.encode(), force=force)

    def __repr__(self) -> str:
        d = self.demo
        return f"Report({d.scene.name}, {d.settings.width}x{d.settings.height}, {len(self.html) / 1e6:.1f} MB of HTML)"

    def _repr_html_(self) -> str:
        return (
            f'<iframe srcdoc="{html_text.escape(self.html)}" width="100%" height="860" '
            'style="border: 0" title="symrender report"></iframe>'
        )


def report(
    scene: Scene | str | Path | dict[str, Any] = "gloss",
    path: str | Path | None = None,
    *,
    size: int | tuple[int, int] = 256,
    seconds: float = 40.0,
    tol: float = 1e-3,
    lobe: int = 4,
    estimators: Estimators = "best",
    silhouettes: int = 3,
    disk: str = "2x2",
    seed: int = 7,
    threads: int = 0,
    progress: Progress | None = None,
    finished: Finished | None = None,
) -> Report:
    """Draw a scene by sampling and by quadrature with the reference, as one offline HTML page.

    Parameters
    ----------
    scene : str, path, mapping or scene
        A scene in units of the series.
    path : str or path, optional
        File that is written.
    size : int or (int, int)
        Width and height in pixels; a single number is a square.
    seconds : float
        The size shrinks until the reference should take at most so long.
    tol : float
        Absolute error asked of the reference.
    lobe : int
        K of the K x K directions of a lobe.
    estimators : {"best", "chapter"}
        Estimators that follow the lobe, or the source chapter's.
    silhouettes : int
        K of the K x K points averaged in pixels next to another shape.
    disk : str
        ``"KxK"`` replaces a disk light by K x K points.
    seed : int
        Seed of the samplers.
    threads : int
        Worker threads; 0 takes the processors of this process.
    progress : callable, optional
        Called with finished and total work.
    finished : callable, optional
        Called with the name and image of ``numeric``, ``symbolic`` and ``truth`` as each is complete.

    Returns
    -------
    Report
        The page; it is shown in a notebook.

    Raises
    ------
    OutputError
        The file cannot be written.
    Unsupported
        The scene is radiometric.

    Notes
    -----
    Keywords are many because each is an option of ``symrender demo``.
    """
    loaded = load(scene, "report")
    settings = demo_settings(size, lobe, estimators, silhouettes, disk, seed, threads)
    made = page_of(demo(loaded, settings, tol=tol, seconds=seconds, progress=progress, finished=finished))
    if path is not None:
        made.save(path)
    return made


def demo_settings(
    size: int | tuple[int, int],
    lobe: int,
    estimators: Estimators,
    silhouettes: int,
    disk: str,
    seed: int,
    threads: int,
    max_pixels: int = MAX_PIXELS,
) -> Settings:
    """Settings of the pair of a report."""
    width, height = image_size(size)
    return Settings(
        width=width,
        height=height,
        lobe=lobe,
        disk=disk,
        silhouettes=silhouettes,
        seed=seed,
        threads=threads,
        max_pixels=max_pixels,
        **ESTIMATORS.get(estimators, {"numeric": estimators}),
    )


def page_of(made: Demo, *, simulator: str = "", command: str = "") -> Report:
    """The page of ``made``; ``simulator`` is the address of the scene's simulator, ``command`` what made the report."""
    files = resources.files("symrender.report") / "page"
    style = (files / "style.css").read_text(encoding="utf-8")
    code = "\n".join((files / name).read_text(encoding="utf-8") for name in _SCRIPTS)
    code = f'(() => {{\n"use strict";\n{code}\n}})();'
    policy = (
        f"default-src 'none'; script-src {_digest(code)}; style-src {_digest(style)}; img-src data: blob:; "
        "base-uri 'none'; form-action 'none'"
    )
    poster = strip(made)._repr_png_()
    holes = {
        "policy": html_text.escape(policy),
        "title": html_text.escape(f"{made.scene.name}: symrender report"),
        "name": html_text.escape(made.scene.name),
        "description": html_text.escape(made.scene.description),
        "poster": base64.b64encode(poster).decode(),
        "scene": html_text.escape(to_yaml(made.scene)),
        "style": style,
        "script": code,
        "data": escaped(page_data(made, simulator, command)),
    }
    parts = (files / "page.html").read_text(encoding="utf-8").split("@@")
    if sorted(set(parts[1::2])) != sorted(holes):
        raise ValueError("page.html: holes and values differ")
    return Report("".join(holes[part] if k % 2 else part for k, part in enumerate(parts)), made)


def page_data(made: Demo, simulator: str, command: str) -> dict[str, Any]:
    """What the page is told: plain data only."""
    images = {"truth": made.truth, "numeric": made.numeric, "symbolic": made.symbolic}
    return {
        "name": made.scene.name,
        "width": made.settings.width,
        "height": made.settings.height,
        "asked": [made.asked.width, made.asked.height],
        "smaller": made.smaller,
        "tol": made.truth_tol,
        "lobe": made.settings.lobe,
        "silhouettes": made.settings.silhouettes,
        "disk": made.settings.disk,
        "seconds": made.seconds,
        "truthSeconds": made.truth_seconds,
        "evaluations": int(made.truth.layer("evaluations").sum()),
        "judgement": made.judgement.as_json(),
        "between": made.pair.ledger.as_json()["comparisons"],
        "notes": list(made.pair.ledger.notes),
        "surfaces": [
            *("nothing", "floor"),
            *(f"spheres.{sphere.name}" for sphere in made.scene.spheres),
            *(f"planes.{plane.name}" for plane in made.scene.planes),
        ],
        "statuses": {str(code): word for code, word in STATUS.items()},
        "simulator": simulator,
        "command": command,
        "receipt": _receipt(made),
        "layers": {name: {layer: packed(image.layer(layer)) for layer in _LAYERS} for name, image in images.items()},
        "error": packed(made.truth.layer("error")),
        "status": packed(made.truth.layer("status")),
        "hitClass": packed(made.truth.layer("hit_class")),
    }


def _receipt(made: Demo) -> list[tuple[str, str]]:
    s = made.settings
    smooth = f"{s.silhouettes} x {s.silhouettes} points where a neighbour meets another shape, else its centre"
    return [
        ("scene", made.scene.hash),
        ("symrender", VERSION),
        ("code", made.code),
        ("size", f"{s.width} x {s.height} pixels, row 0 on top"),
        ("a pixel", smooth if s.silhouettes > 1 else "the ray through its centre"),
        ("floor texture", "filtered over the pixel" if s.aa == "analytic" else "read at the centre"),
        ("disk lights", "integrated" if s.disk == "exact" else f"{s.disk} points, the same in all three pictures"),
        ("units", "linear RGB in scene units of radiance; a lobe is a " + made.truth.meta["convention"]),
        ("bounces", "one: direct light, and what the lobe sees of it"),
        ("truth", f"lobe split at its walls, {made.truth_tol:g} asked of every pixel"),
        ("seed", str(s.seed)),
        ("machine", f"{made.threads} threads, NumPy {np.__version__}"),
    ]


def _digest(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"
