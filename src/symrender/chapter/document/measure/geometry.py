"""The drawing before the integral: eye, floor point, mirror ray and lobe from the side, and sentences that move it.

What is drawn here is drawn again by ``page/explore.js`` when a number is dragged; the ids are what the two share.
"""

from __future__ import annotations

import math
from typing import Final

from symrender.chapter.document.effort import Effort
from symrender.chapter.document.figures import Measured
from symrender.ledger.lobe_widths import lobe_widths

EXPONENT: Final = 16.0
HALF_ANGLE: Final = 60.0
PLACE: Final = 250.0
"""Where the floor point stands at first, in the units of the drawing."""
_WIDTH, _HEIGHT, _FLOOR = 680, 350, 300
_EYE: Final = (60.0, 96.0)
_BALL: Final = (470.0, 218.0, 82.0)
"""Centre and radius of the sphere, which stands on the floor."""
_LENGTH: Final = 170.0
"""How far the lobe reaches along the mirror ray."""
_STEPS: Final = 96


def measure(effort: Effort) -> Measured:
    """Blocks ``lobe.geometry`` and ``lobe.rulers``."""
    return Measured(blocks={"lobe.geometry": _drawing() + _sentence(), "lobe.rulers": _rulers()})


def share_angle(share: float, exponent: float, half_angle: float) -> float:
    """Half-angle in degrees of the cone that holds a share of the lobe: cos^u = 1 - share (1 - cos^u theta_max)."""
    u = exponent + 1.0
    whole = 1.0 - math.cos(math.radians(half_angle)) ** u
    return math.degrees(math.acos((1.0 - share * whole) ** (1.0 / u)))


def lobe_path(exponent: float, half_angle: float, axis: float) -> str:
    """The lobe in polar form about the floor point: r = length cos^n(angle to the axis), within the cone."""
    points = []
    for k in range(_STEPS + 1):
        off = math.radians(half_angle) * (2.0 * k / _STEPS - 1.0)
        reach = _LENGTH * max(0.0, math.cos(off)) ** exponent
        points.append(f"{PLACE + reach * math.cos(axis + off):.1f} {_FLOOR - reach * math.sin(axis + off):.1f}")
    return f"M{PLACE:.1f} {_FLOOR}L{'L'.join(points)}Z"


def _drawing() -> str:
    rise = math.atan2(_FLOOR - _EYE[1], PLACE - _EYE[0])
    ends = {
        name: (PLACE + reach * math.cos(angle), _FLOOR - reach * math.sin(angle))
        for name, angle, reach in (
            ("mirror", rise, 560.0),
            ("low", rise - math.radians(HALF_ANGLE), 190.0),
            ("high", rise + math.radians(HALF_ANGLE), 190.0),
            ("name", rise, 196.0),
        )
    }

    def line(name: str, kind: str) -> str:
        x, y = ends[name]
        return f'<line id="geometry-{name}" class="{kind}" x1="{PLACE}" y1="{_FLOOR}" x2="{x:.1f}" y2="{y:.1f}"/>'

    tiles = "".join(f'<rect class="tile" x="{x}" y="{_FLOOR}" width="34" height="9"/>' for x in range(0, _WIDTH, 68))
    return (
        f'<svg class="geometry" id="geometry" viewBox="0 0 {_WIDTH} {_HEIGHT}" role="group" '
        f'data-eye="{_EYE[0]} {_EYE[1]}" data-floor="{_FLOOR}" data-length="{_LENGTH}" '
        'aria-label="From the side: a ray from the eye meets the floor at P; '
        'about the mirrored ray opens the lobe, which a sphere partly fills">'
        f'<clipPath id="geometry-above"><rect width="{_WIDTH}" height="{_FLOOR}"/></clipPath>'
        f'<clipPath id="geometry-below"><rect y="{_FLOOR}" width="{_WIDTH}" height="{_HEIGHT - _FLOOR}"/></clipPath>'
        f'<circle class="ball" cx="{_BALL[0]}" cy="{_BALL[1]}" r="{_BALL[2]}"/>{tiles}'
        f'<line class="ground" x1="0" y1="{_FLOOR}" x2="{_WIDTH}" y2="{_FLOOR}"/>'
        + "".join(
            f'<path class="{kind}" clip-path="url(#geometry-{side})" d="{lobe_path(EXPONENT, HALF_ANGLE, rise)}"/>'
            for side, kind in (("above", "lobe"), ("below", "lobe buried"))
        )
        + line("low", "cone")
        + line("high", "cone")
        + f'<g id="geometry-normal"><line class="normal" x1="{PLACE}" y1="{_FLOOR}" x2="{PLACE}" y2="150"/>'
        f'<text x="{PLACE + 8}" y="158">N</text></g>'
        + f'<line id="geometry-eye" class="ray" x1="{_EYE[0]}" y1="{_EYE[1]}" x2="{PLACE}" y2="{_FLOOR}"/>'
        + line("mirror", "ray mirror")
        + f'<g class="eye" transform="translate({_EYE[0]} {_EYE[1]})"><path d="M-17 0Q0 -15 17 0Q0 15 -17 0Z"/>'
        '<circle r="5"/></g>'
        f'<text x="{_EYE[0] - 16}" y="{_EYE[1] - 20}">eye</text>'
        f'<text id="geometry-name" x="{ends["name"][0]:.1f}" y="{ends["name"][1] - 8:.1f}">m</text>'
        f'<g id="geometry-point" class="point" transform="translate({PLACE} {_FLOOR})" tabindex="0" role="slider" '
        f'aria-label="Floor point" aria-valuemin="110" aria-valuemax="600" aria-valuenow="{PLACE:.0f}" '
        'aria-orientation="horizontal"><circle r="16" class="grip"/><circle r="6.5"/>'
        '<text x="-5" y="30">P</text></g></svg>'
    )


def _dragged(name: str, value: float, unit: str = "") -> str:
    """A number in a sentence that can be dragged, or moved by arrow keys."""
    low, high, words = (1, 4096, "exponent n") if name == "n" else (5, 90, "half-angle of the cone, degrees")
    return (
        f'<span class="drag" data-drag="{name}" role="slider" tabindex="0" aria-label="{words}" aria-valuemin="{low}" '
        f'aria-valuemax="{high}" aria-valuenow="{value:g}" aria-valuetext="{value:g}{unit}">{value:g}{unit}</span>'
    )


def _live(name: str, value: float) -> str:
    return f'<output class="live" data-live="{name}">{value:.1f}°</output>'


def _sentence() -> str:
    half, most = (share_angle(share, EXPONENT, HALF_ANGLE) for share in (0.5, 0.9))
    return (
        '<p class="explain">Drag the point, or a number. With exponent <i>n</i> = '
        f"{_dragged('n', EXPONENT)} within {_dragged('theta', HALF_ANGLE, '°')} of <i>m</i>, half of the lobe’s weight "
        f"lies within {_live('half', half)} of the mirror ray and nine tenths within {_live('most', most)}. "
        '<output class="live" data-live="horizon">Part of the cone lies below the floor: it sees nothing, and '
        "counts.</output></p>"
    )


def _rulers() -> str:
    found = lobe_widths("", EXPONENT, math.radians(HALF_ANGLE))
    told = {
        name: math.degrees(value)
        for name, value in (
            ("sigma", found.sigma), ("rms", found.rms_angle), ("limit", found.rms_angle_limit),
            ("ruler", found.chapter_ruler),
        )
    }  # fmt: skip
    words = (("per axis", "sigma"), ("RMS angle", "rms"), ("its limit", "limit"), ("the source’s ruler", "ruler"))
    listed = ", ".join(f"{text} {_live(name, told[name])}" for text, name in words)
    at = f"{_dragged('n', EXPONENT)} within {_dragged('theta', HALF_ANGLE, '°')}"
    return f'<p class="explain">At <i>n</i> = {at}: {listed}.</p>'
