"""``animate``: a scene that changes, or is gone round, as pictures and a video, in one call."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

from symrender.errors import OptionError
from symrender.execution.fill import Means
from symrender.execution.tiles import Progress
from symrender.scene.load import load
from symrender.scene.scene import Scene
from symrender.sequences.animate import animate as draw
from symrender.sequences.makers import Rendered
from symrender.sequences.orbit import orbit as around
from symrender.sequences.over import frames, parse_over
from symrender.sequences.video import Container
from symrender.settings import ESTIMATORS, Settings, image_size


def animate(
    scene: Scene | str | Path | Mapping[str, Any],
    folder: str | Path,
    *,
    over: str = "",
    orbit: int = 0,
    pipeline: Literal["symbolic", "numeric"] = "symbolic",
    size: int | tuple[int, int] = (320, 240),
    lobe: int = 8,
    disk: str = "2x2",
    seed: int = 7,
    silhouettes: int = 1,
    video: Container = "mp4",
    rate: float = 24.0,
    threads: int = 0,
    force: bool = False,
    progress: Progress | None = None,
) -> list[dict[str, Any]]:
    """Draw a scene as a value changes or as the camera turns about its target.

    Parameters
    ----------
    scene : str, path, mapping or scene
        A scene in units of the series.
    folder : str or path
        Folder that receives the frames as PNG, and the film.
    over : str
        ``"floor.lobe.exponent=8:512:24:log"``: 24 values from 8 to 512, a frame each.
    orbit : int
        Frames of one turn of the camera, instead of ``over``.
    pipeline : {"symbolic", "numeric"}
        Which renderer draws.
    size : (int, int) or int
        Width and height in pixels.
    lobe : int
        K of the K x K directions of a lobe.
    disk : str
        ``"KxK"`` replaces a disk light by K x K points.
    seed : int
        Seed of the samplers.
    silhouettes : int
        K of the K x K points averaged in pixels next to another shape.
    video : {"mp4", "webm", "none"}
        Format of the film (extra ``video``).
    rate : float
        Frames a second.
    threads : int
        Worker threads; 0 takes the processors of this process.
    force : bool
        Replace existing files.
    progress : callable, optional
        Called with finished and total work.

    Returns
    -------
    list of dict
        One row of figures a frame.

    Raises
    ------
    OptionError
        An argument is out of range, or the extra is missing.
    OutputError
        A file cannot be written.

    Notes
    -----
    Keywords are many because each is an option of ``symrender animate``.
    """
    if bool(over) == bool(orbit):
        raise OptionError("over, orbit: give exactly one of them")
    chosen = load(scene, "animate")
    width, height = image_size(size)
    sides = {"numeric": "none"} if pipeline == "symbolic" else {"symbolic": "none"}
    named: dict[str, Any] = {**ESTIMATORS["best"], **sides}
    settings = Settings(
        width=width, height=height, lobe=lobe, disk=disk, seed=seed, silhouettes=silhouettes, threads=threads, **named
    )
    drawn = around(chosen, orbit) if orbit else frames(chosen, parse_over(over))
    means = Means(threads)
    return draw(drawn, Rendered(settings), folder, video=video, rate=rate, means=means, force=force, progress=progress)
