"""One lobe built up: one direction, four, sixteen, all of them, its walls; a choice of five beside one disc."""

from __future__ import annotations

import html
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from symrender.chapter.document.figures import shown
from symrender.chapter.document.lobe_disc import VIEW, Disc, Lobe
from symrender.chapter.document.pictures import data_uri
from symrender.images.srgb import encode_srgb
from symrender.quadrature.strata import Rings
from symrender.scene.arrays import Array


@dataclass(frozen=True, eq=False)
class Stage:
    """An estimate from ``directions`` readings: of a ``ring`` and as many sectors, or along the mirror alone."""

    directions: int
    ring: Rings | None
    value: Array
    error: float


def staged(
    lobe: Lobe, disc: Disc, stages: Sequence[Stage], true: Array, gain: float, walls: int, walls_image: str
) -> str:
    """The disc with what each stage reads over it, and the stages to choose from, each with the colour it finds.

    ``true`` is the gloss as it is shown; ``walls_image`` is the id of the same disc's picture with its walls drawn.
    Nothing here needs a program: which stage is shown is the state of a radio button.
    """
    outer = VIEW / 2 - 4
    parts = [
        f'<clipPath id="clip-stages"><circle cx="{VIEW / 2}" cy="{VIEW / 2}" r="{outer}"/></clipPath>',
        f'<image clip-path="url(#clip-stages)" x="4" y="4" width="{2 * outer}" height="{2 * outer}" '
        f'href="{data_uri(disc.pixels)}"/>',
    ]
    rows = []
    for k, stage in enumerate(stages, 1):
        marks = [f'<circle class="node" cx="{VIEW / 2}" cy="{VIEW / 2}" r="9"/>']
        if stage.ring is not None:
            marks = lobe.cells(stage.ring, len(stage.ring.nodes))
        parts.append(f'<g class="stage stage-{k}">{"".join(marks)}</g>')
        words = "One direction, the mirror" if stage.ring is None else f"{stage.directions} directions, equal weight"
        off = f'off by <data class="figure" value="{stage.error!r}" title="{stage.error!r}">'
        rows.append(_choice(k, stage.value * gain, words, f"{off}{shown(stage.error, 'percent')}</data>"))
    parts.append(f'<g class="stage stage-5"><use href="#{walls_image}"/></g>')
    parts.append(f'<circle class="rim" cx="{VIEW / 2}" cy="{VIEW / 2}" r="{outer}"/>')
    rows.append(_choice(4, true, "All directions, the integral", "the mean colour of the disc"))
    rows.append(_choice(5, true, "Its walls", f"{walls} of them; between any two it is smooth"))
    alt = html.escape("The disc of one lobe, with the directions in which the chosen stage reads it", quote=True)
    return (
        f'<div class="stages"><svg class="disc" viewBox="0 0 {VIEW} {VIEW}" role="img" aria-label="{alt}">'
        f"{''.join(parts)}</svg><fieldset><legend>What is read</legend>{''.join(rows)}</fieldset></div>"
    )


def _choice(number: int, color: Array, words: str, note: str) -> str:
    red, green, blue = encode_srgb(np.clip(color, 0.0, 1.0).reshape(1, 1, 3))[0, 0]
    checked = " checked" if number == 1 else ""
    return (
        f'<label><input type="radio" name="stage" value="{number}"{checked}>'
        f'<i class="swatch" style="background:rgb({red} {green} {blue})"></i><span>{words}: {note}</span></label>'
    )
