"""The report of an audit: one offline HTML file without scripts, its pictures inside."""

from __future__ import annotations

import base64
import hashlib
import math
from html import escape
from importlib import resources
from typing import Final

import numpy as np
import numpy.typing as npt

from symrender.audit.verdict import Finding, Verdict
from symrender.images import png
from symrender.images.picture import DIVERGING, SEQUENTIAL, color_map
from symrender.version import VERSION

Array = npt.NDArray[np.float64]

_BINS: Final = 41
_EDGE: Final = 5.0
_LARGEST: Final = 640
"""Pixels across beyond which a map is thinned, so that the page stays small."""


def page(verdict: Verdict) -> str:
    """The whole page."""
    style = (resources.files("symrender.audit") / "page.css").read_text(encoding="utf-8")
    digest = base64.b64encode(hashlib.sha256(style.encode()).digest()).decode()
    policy = f"default-src 'none'; style-src 'sha256-{digest}'; img-src data:; base-uri 'none'; form-action 'none'"
    word = verdict.verdict
    parts = [
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">',
        f'<meta http-equiv="Content-Security-Policy" content="{escape(policy)}">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        f"<title>{escape(verdict.scene)}: audit {word}</title>\n<style>{style}</style>\n</head>\n<body>",
        f'<header><p class="quiet">symrender audit</p><h1>{escape(verdict.scene)}</h1>',
        f'<p class="verdict {word}">{escape(verdict.sentence())}</p></header>\n<main>',
        _maps(verdict),
        "<section><h2>Regions</h2><p>The signed mean of the render less the truth over each population of pixels. "
        "<em>Visible</em> is what this audit could see: a bias of that size fails with probability .9.</p>",
        _table(verdict),
        "</section>",
        _attribution(verdict),
        f"<section><h2>Single pixels</h2>{_histogram(verdict)}{_pixels(verdict)}</section>",
        _aside(verdict),
        _notes(verdict),
        "</main>",
        f'<footer><p class="quiet">{escape(_receipt(verdict))}</p></footer>\n</body>\n</html>\n',
    ]
    return "\n".join(part for part in parts if part)


def _maps(verdict: Verdict) -> str:
    difference = verdict.maps["difference"].mean(axis=-1)
    z = verdict.maps["z"]
    worst = np.take_along_axis(z, np.abs(z).argmax(axis=-1)[..., None], -1)[..., 0]
    sizes = np.abs(difference[difference != 0])
    reach = float(np.percentile(sizes, 99)) if sizes.size else 1.0
    marks = verdict.maps["discovered"] + verdict.maps["rejected"]
    shown = (
        ("Difference", _picture(difference, -reach, reach, DIVERGING), f"blue -{reach:.3g}, white 0, red +{reach:.3g}"),
        ("z", _picture(worst, -_EDGE, _EDGE, DIVERGING), f"worst channel: blue -{_EDGE:g}, white 0, red +{_EDGE:g}"),
        (
            "Pixels that are off",
            _picture(marks, 0.0, 2.0, SEQUENTIAL),
            "green: discovered; yellow: rejected",
        ),
        ("Pixels set aside", _picture(verdict.maps["aside"], 0.0, 1.0, SEQUENTIAL), "yellow: set aside"),
    )
    figures = "".join(
        f'<figure><img alt="{escape(name)}: {escape(words)}" src="data:image/png;base64,{data}">'
        f"<figcaption><b>{escape(name)}</b> {escape(words)}</figcaption></figure>"
        for name, data, words in shown
    )
    return f'<section class="maps">{figures}</section>'


def _picture(values: Array, low: float, high: float, hexes: tuple[str, ...]) -> str:
    thin = max(1, math.ceil(max(values.shape) / _LARGEST))
    pixels = color_map(np.nan_to_num(values[::thin, ::thin], posinf=1e9, neginf=-1e9), low, high, hexes)
    return base64.b64encode(png.encode(pixels, {})).decode()


def _table(verdict: Verdict) -> str:
    head = "".join(
        f"<th>{words}</th>"
        for words in ("region", "channel", "pixels", "truth", "bias", "of truth", "z", "p", "visible", "outcome")
    )
    rows = "".join(_row(test) for test in (*verdict.tests, *verdict.regions))
    return f'<div class="wide"><table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table></div>'


def _row(test: Finding) -> str:
    name = "scale of the whole" if test.name == "scale" else test.region
    cells = (
        *(name, test.channel, f"{test.pixels}", f"{test.truth:.4g}", f"{test.bias:+.3g} ± {test.error:.2g}"),
        *(_percent(test.relative), f"{test.z:+.2f}", f"{test.adjusted:.2g}", _percent(test.visible_relative)),
    )
    why = f' <span class="quiet">{escape(test.why)}</span>' if test.why else ""
    kind = test.outcome.replace(" ", "-")
    body = "".join(f"<td>{escape(cell)}</td>" for cell in cells)
    return f'<tr class="{kind}">{body}<td>{test.outcome}{why}</td></tr>'


def _attribution(verdict: Verdict) -> str:
    if not verdict.attribution:
        return ""
    items = "".join(
        f"<li{' class=likely' if found.consistent else ''}>{escape(found.text())} "
        f'<span class="quiet">{escape(found.how)}</span></li>'
        for found in verdict.attribution
    )
    return f"<section><h2>What would explain it</h2><ol>{items}</ol></section>"


def _histogram(verdict: Verdict) -> str:
    """The z values of pixels and the normal density, as SVG."""
    z = verdict.maps["z"]
    z = z[np.isfinite(z) & (z != 0.0)]
    if z.size < 16:
        return "<p>Too few pixels are noisy to draw their distribution.</p>"
    edges = np.linspace(-_EDGE, _EDGE, _BINS + 1)
    counts, _ = np.histogram(np.clip(z, -_EDGE, _EDGE), edges)
    middle, width = 0.5 * (edges[1:] + edges[:-1]), edges[1] - edges[0]
    normal = z.size * width * np.exp(-0.5 * middle**2) / math.sqrt(2 * math.pi)
    top = float(max(counts.max(), normal.max()))
    bars = "".join(
        f'<rect x="{10 * k + 0.5:.1f}" y="{150 - 140 * c / top:.2f}" width="9" height="{140 * c / top:.2f}"/>'
        for k, c in enumerate(counts)
    )
    line = " ".join(f"{10 * k + 5:.1f},{150 - 140 * v / top:.2f}" for k, v in enumerate(normal))
    ticks = "".join(
        f'<text x="{10 * _BINS * (t + _EDGE) / (2 * _EDGE):.1f}" y="165">{t:+d}</text>' for t in (-4, -2, 0, 2, 4)
    )
    words = f"Histogram of {z.size} z values and the normal density"
    return (
        f'<svg role="img" aria-label="{words}" viewBox="0 0 {10 * _BINS} 172">{bars}<polyline points="{line}"/>{ticks}'
        f'</svg><p class="quiet">{words}; the outermost bars hold all beyond.</p>'
    )


def _pixels(verdict: Verdict) -> str:
    pixel = verdict.pixels
    words = (
        f"{pixel.judged} pixels judged by themselves, {pixel.unjudged} not (too noisy, or without a truth); "
        f"{pixel.rejected} rejected by Holm, {pixel.discovered} discovered by Benjamini-Hochberg. "
        f"Largest |z| {pixel.largest:.3g} at column {pixel.worst[0]}, row {pixel.worst[1]}; "
        f"kurtosis {pixel.kurtosis:.3g}."
    )
    return f"<p>{escape(words)} {escape(pixel.why)}</p>"


def _aside(verdict: Verdict) -> str:
    if not verdict.pixels.aside:
        return ""
    head = "".join(f"<th>{words}</th>" for words in ("column", "row", "truth", "least within reach", "most"))
    rows = "".join(
        f"<tr><td>{one.column}</td><td>{one.row}</td>"
        + "".join(f"<td>{escape(' '.join(f'{v:.5g}' for v in part))}</td>" for part in (one.truth, one.low, one.high))
        + "</tr>"
        for one in verdict.sub_pixel
    )
    return (
        f"<section><h2>Pixels set aside</h2><p>The truth of {verdict.pixels.aside} pixels changes within reach of the "
        "renderer's rays, so they decide nothing. Those that differ most, red green blue:</p>"
        f'<div class="wide"><table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table></div></section>'
    )


def _notes(verdict: Verdict) -> str:
    if not verdict.notes:
        return ""
    return (
        f"<section><h2>To know</h2><ul>{''.join(f'<li>{escape(note)}</li>' for note in verdict.notes)}</ul></section>"
    )


def _receipt(verdict: Verdict) -> str:
    return (
        f"scene {verdict.scene_hash[:16]}, {verdict.size[0]} x {verdict.size[1]} pixels, {verdict.source}, "
        f"{verdict.samples} samples, family-wise level {verdict.level:g}, look {verdict.looks}, symrender {VERSION}"
    )


def _percent(share: float) -> str:
    return f"{100 * share:.3g} %" if np.isfinite(share) else "-"
