"""``explore``: a scene with sliders in a notebook cell. Python draws, so the numbers are those of ``render``."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

from symrender.errors import OptionError, SymrenderError, remedy
from symrender.images.image import Image
from symrender.images.png import encode
from symrender.scene.load import load
from symrender.scene.scene import Scene
from symrender.settings import Tonemap
from symrender.widget.sliders import Drawing, Ranges


def explore(
    scene: Scene | str | Path | Mapping[str, Any] = "gloss",
    sliders: Ranges = (),
    *,
    size: int = 256,
    exposure: float = 0.0,
    tonemap: Tonemap = "clip",
    **options: Any,
) -> Any:
    """Show a scene in a notebook with sliders for its numbers.

    Parameters
    ----------
    scene : str, path, mapping or scene
        A scene in units of the series.
    sliders : sequence of str or mapping
        Dotted names, or names with the ends of their sliders, ``{"floor.lobe.exponent": (8, 512)}``; by default the
        exponents of the lobes.
    size : int
        Side of the image at rest in pixels; it is coarser while a slider moves.
    exposure : float
        Stops by which the image is brightened.
    tonemap : {"clip", "reinhard", "aces"}
        Display of values above 1.
    **options : dict
        Options of ``render``; by default the symbolic estimator that follows the lobe.

    Returns
    -------
    Explore
        The widget; ``scene`` and ``image`` are those shown. Its trait ``asked`` sets values from Python.

    Raises
    ------
    OptionError
        The extra ``widget`` is missing, or a name is not a number of the scene.
    """
    kind = _widget_class()
    return kind(Drawing(load(scene, "explore"), sliders, size, options), exposure, tonemap)


def caption_of(image: Image, drawing: Drawing) -> str:
    """What is shown, in words: the image's own, and where its sliders stand."""
    names = {p.name: p.value for p in drawing.scene.parameters()}
    places = ", ".join(f"{slider.name} = {names[slider.name]:.4g}" for slider in drawing.sliders)
    return f"{image.width} x {image.height}: {places}"


@cache
def _widget_class() -> type[Any]:
    """The class, made where anywidget is there to be its base."""
    try:
        import anywidget
        import traitlets
    except ImportError:
        raise OptionError(f"explore: anywidget is not installed: {remedy('widget')}") from None
    files = resources.files("symrender.widget")

    class Explorer(anywidget.AnyWidget):
        """One scene and its sliders; the page beside it is ``explore.js``."""

        _esm = (files / "explore.js").read_text(encoding="utf-8")
        _css = (files / "explore.css").read_text(encoding="utf-8")
        sliders = traitlets.List().tag(sync=True)
        size = traitlets.Int().tag(sync=True)
        asked = traitlets.Dict().tag(sync=True)
        picture = traitlets.Bytes().tag(sync=True)
        caption = traitlets.Unicode().tag(sync=True)
        trouble = traitlets.Unicode().tag(sync=True)

        def __init__(self, drawing: Drawing, exposure: float, tonemap: Tonemap) -> None:
            self._drawing, self._exposure, self._tonemap = drawing, exposure, tonemap
            super().__init__(sliders=drawing.plain(), size=drawing.size)
            self._draw({})
            self.observe(lambda change: self._draw(change["new"]), names="asked")

        def __repr__(self) -> str:
            return f"Explorer({self.scene.name}, {', '.join(s['name'] for s in self.sliders)})"

        @property
        def scene(self) -> Scene:
            """The scene that is shown."""
            return self._drawing.scene

        @property
        def image(self) -> Image:
            """The image that is shown."""
            assert self._drawing.image is not None
            return self._drawing.image

        def _draw(self, asked: Mapping[str, Any]) -> None:
            try:
                image = self._drawing.draw(asked.get("values", {}), moving=asked.get("moving") is True)
                shown = image.view(exposure=self._exposure, tonemap=self._tonemap)
            except SymrenderError as error:
                self.trouble = str(error)
                return
            with self.hold_sync():
                self.trouble = ""
                self.picture = encode(shown.pixels, {})
                self.caption = caption_of(image, self._drawing)

    return Explorer
