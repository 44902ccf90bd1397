"""Bounced light as a mean over pixels: cut where shapes and textures end, the lobes' integrals at the nodes."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Final, Protocol

import numpy as np
import numpy.typing as npt

from symrender.radiometric.pixels.cells import Eye
from symrender.radiometric.shaken import shaken
from symrender.radiometric.vectors import Array
from symrender.radiometric.world import Seen, seen_all
from symrender.runtimes.bounce import Bounced
from symrender.runtimes.hot_places import hot_places
from symrender.runtimes.pixel_parts import INNER, Canvas, Light, Mean, PixelRule, Places
from symrender.runtimes.pixels import DOMAINS, brightest, families_of, mean_world, seen_walls
from symrender.scene.radiometric.arrays import RadiometricArrays
from symrender.settings import Settings

DIRECT_SHARE: Final = 0.3
"""Part of the tolerance that direct light takes where light bounces."""
_BOUNCED: Final = 0.6
"""Part of a strict budget that the rays of a pixel are given, of which they take up to 1.8 times (``budgets.py``)."""
CHANNELS: Final = 3

BouncedMeans = Callable[[int, int, int, int], Mean]
"""Means of the pixels of a tile, row by row."""


class Sends(Protocol):
    """Who integrates the light that bounces along rays."""

    def sent(
        self, rays: list[tuple[Array, Array]], tol: float, budget: int, blurred: npt.NDArray[np.bool_] | None = None
    ) -> Bounced:  # fmt: skip
        """As ``Bouncer.sent``."""


def node_tolerance(tol: float) -> float:
    """What a single ray may be off by, of a pixel to ``tol`` with its direct light."""
    return INNER * (1.0 - DIRECT_SHARE) * tol


def direct_budget(settings: Settings) -> int:
    """Evaluations that direct light of a pixel takes in addition to bounced light."""
    return max(1, int(DIRECT_SHARE * settings.budget)) if settings.strict else settings.budget


def canvas_of(view: Seen, settings: Settings) -> Canvas:
    """An image of bounced light: cut where shapes and textures end."""
    bright = brightest(view)
    place = (float(view.eye[0]), float(view.eye[1]), float(view.eye[2]))
    eye = Eye(
        view.world, mean_world(view.world), place, seen_walls(view), families_of(view), bright, True,
        DOMAINS[settings.filter], hot=hot_places(view.world),
    )  # fmt: skip
    return Canvas(eye, view.window, settings.width, settings.height, settings.reach, bright, True)


def prepare_bounced(arrays: RadiometricArrays, settings: Settings, sender: Callable[[], Sends]) -> BouncedMeans:
    """What makes means of bounced light over the pixels of a tile; a thread calls ``sender`` once."""
    views = seen_all(shaken(arrays), settings.width, settings.height)
    canvas = canvas_of(views[0], settings)
    rule, own = PixelRule(canvas, CHANNELS), threading.local()
    tol = (1.0 - DIRECT_SHARE) * settings.tol
    budget = max(1, int(_BOUNCED * settings.budget)) if settings.strict else settings.budget

    def means(x0: int, y0: int, x1: int, y1: int) -> Mean:
        if not hasattr(own, "sends"):
            own.sends = sender()
        sends: Sends = own.sends

        def look(places: Places, asked: float, budget: int) -> Light:
            rays = [(_eyes(each, places), _through(each, places, settings)) for each in views]
            found = sends.sent(rays, asked, budget, places.blurred)
            return Light(found.indirect, found.error, found.status, found.evaluations)

        return rule.means(x0, y0, x1, y1, look, tol, budget, settings.strict)

    return means


def _eyes(view: Seen, places: Places) -> Array:
    return np.tile(view.eye, (len(places.columns), 1))


def _through(view: Seen, places: Places, settings: Settings) -> Array:
    """(N, 3) unit directions of rays through places of an image."""
    forward, right, up = view.window
    a, b = 2.0 * places.columns / settings.width - 1.0, 1.0 - 2.0 * places.rows / settings.height
    found = forward + a[:, None] * right + b[:, None] * up
    return np.ascontiguousarray(found / np.sqrt((found**2).sum(axis=1, keepdims=True)))
