"""Derivatives stay what they were: those that ``sr.gradient`` and ``sr.probe`` gave once are stored and asked again.

    python benchmarks/derivatives_stay.py --make [--quick]     # ask all and write benchmarks/data/derivatives.json.gz
    python benchmarks/derivatives_stay.py --check [--quick]    # ask again and compare with what is stored
    python benchmarks/derivatives_stay.py --speed [--quick]    # CPU time of gradients over that of their images

Asked are the scenes of the gallery, the adversary's families (``tests/adversary/families.py``), pixels of scenes in
units of the series under filters, bounced light of crowds and filtered pixels of hostile scenes. Two derivatives of
one place agree where they differ by no more than both state. What was met and no longer is, what was given and is
refused or unsupported, is counted. It is no judge of either: those are the adversary's own differences
(``tests/adversary/slopes.py``), ``bounced_derivatives_are_stated.py`` and ``filtered_slopes_are_stated.py``.
"""

from __future__ import annotations

import argparse
import gzip
import json
import math
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from measure import Report, cpu_seconds

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from bounced_light_is_stated import drawn
from filtered_derivatives_are_stated import names_of as hostile_names
from filtered_slopes_are_stated import asked, series
from pixels_are_stated import hostile
from tests.adversary.families import FAMILIES, generate
from tests.adversary.slopes import names_of

import symrender as sr
from symrender.errors import SymrenderError

DATA = Path(__file__).parent / "data" / "derivatives.json.gz"
SERIES = ("gloss", "chapter8", "grazing", "needle", "penumbra", "room", "furnace", "mirror")
RADIOMETRIC = ("metal", "veach", "furnace_radiometric", "interreflection")
UNREAL = ("cell", "ku", "kv", "offset")
"""Numbers of textures: most pixels say 0 of them."""
SEEDS, FILTERED, CROWDS, HOSTILE = 8, 16, 30, 12
NAMES = 3
GIVEN = 2
"""Largest status of a derivative that is given."""
Row = tuple[str, str, list[float], float, int]
"""Question, parameter, the derivative of three channels, what it states and its status."""


def image_rows(key: str, scene: Any, names: list[str], every: int, **how: Any) -> list[Row]:
    """Some pixels of derivatives of an image."""
    try:
        images = sr.gradient(scene, names, threads=1, **how)
    except SymrenderError:
        return [(key, ",".join(names), [], math.inf, -1)]
    rows: list[Row] = []
    for name, image in images.items():
        value, stated = image.layer("radiance").reshape(-1, 3), image.layer("error").ravel()
        status = image.layer("status").ravel()
        for k in range(0, len(stated), every):
            rows.append((f"{key}[{k}]", name, value[k].tolist(), float(stated[k]), int(status[k])))
    return rows


def probe_rows(key: str, scene: Any, names: list[str], **how: Any) -> list[Row]:
    """Derivatives of one place."""
    try:
        found = sr.probe(scene, wrt=names, threads=1, **how)
    except SymrenderError:
        return [(key, ",".join(names), [], math.inf, -1)]
    gradient, stated, status = found.gradient, found.gradient_error, found.gradient_status
    return [(key, n, np.asarray(gradient[n])[0].tolist(), float(stated[n][0]), int(status[n][0])) for n in gradient]


def some(names: list[str], count: int, *seed: int) -> list[str]:
    """Some of the names, in an order of their own."""
    order = np.random.default_rng(seed).permutation(len(names))
    return [names[k] for k in order[:count]]


def gallery() -> Iterator[list[Row]]:
    """Small images of the gallery's scenes."""
    for k, scene in enumerate((*SERIES, *RADIOMETRIC)):
        loaded = sr.load(scene)
        names = [
            p.name for p in loaded.parameters()
            if isinstance(p.value, float) and not any(word in p.name for word in (*UNREAL, "eta", "mix"))
        ]  # fmt: skip
        for part in range(2):
            yield image_rows(f"{scene}#{part}", loaded, some(names, NAMES, k, part), 5, size=(6, 4), tol=1e-4)


def adversary(count: int) -> Iterator[list[Row]]:
    """One place of each case of the adversary's families."""
    for number, family in enumerate(FAMILIES):
        for seed in range(1000, 1000 + count):
            case = generate(family, seed)
            how = {"points": case.points[:1], "surface": case.surface, "disk": case.disk, "budget": case.budget}
            names = some(names_of(case), NAMES, number, seed)
            yield probe_rows(case.name, case.scene, names, tol=max(case.tol, 1e-5), **how)


def filtered(count: int) -> Iterator[list[Row]]:
    """Single pixels of scenes in units of the series, under filters."""
    for seed in range(count):
        made = series(seed)
        names = [p.name for p in asked(sr.load(made["scene"]), made["rng"])][:NAMES]
        yield image_rows(f"series#{seed}", made["scene"], names, 1, size=1, tol=1e-3, filter=made["filter"],
                         budget=100_000)  # fmt: skip


def crowds(count: int) -> Iterator[list[Row]]:
    """Bounced light along rays into crowds of balls and planes."""
    for seed in range(count):
        scene, origin, direction = drawn(np.random.default_rng(seed))
        loaded = sr.load(scene)
        names = [p.name for p in loaded.parameters() if isinstance(p.value, float) and "camera" not in p.name]
        yield probe_rows(f"crowd#{seed}", loaded, some(names, NAMES, seed), rays=(origin, direction), tol=1e-4,
                         budget=300_000)  # fmt: skip


def pixels(count: int) -> Iterator[list[Row]]:
    """Filtered pixels of hostile radiometric scenes."""
    for seed in range(count):
        try:
            scene = hostile(seed)
        except SymrenderError:
            continue
        yield image_rows(f"hostile#{seed}", scene, some(hostile_names(scene), NAMES, seed), 1, size=1, tol=1e-4,
                         filter="box", budget=100_000)  # fmt: skip


def all_rows(quick: bool) -> Iterator[Row]:
    """All questions and answers, in order; each kind begins where the quick ones do."""
    part = (lambda n: max(1, n // 8)) if quick else (lambda n: n)
    kinds: list[Callable[[], Iterator[list[Row]]]] = [
        gallery, lambda: adversary(part(SEEDS)), lambda: filtered(part(FILTERED)), lambda: crowds(part(CROWDS)),
        lambda: pixels(part(HOSTILE)),
    ]  # fmt: skip
    for kind in kinds:
        for rows in kind():
            yield from rows


def make(quick: bool) -> None:
    """Write what is answered now."""
    rows = list(all_rows(quick))
    DATA.parent.mkdir(exist_ok=True)
    DATA.write_bytes(gzip.compress(json.dumps(rows).encode(), mtime=0))
    print(f"{len(rows)} derivatives in {DATA.stat().st_size} bytes")


def check(quick: bool) -> None:
    """Ask again and compare."""
    report = Report("derivatives_stay", "derivatives of public verbs stay what they were, within what both state")
    stored = {(key, name): row for key, name, *row in json.loads(gzip.decompress(DATA.read_bytes()))}
    counts, beyond, ratios = Counter[str](), [], []
    for key, name, value, stated, status in all_rows(quick):
        before = stored.get((key, name))
        if before is None:
            counts["new (was refused)"] += 1
            continue
        counts["asked"] += 1
        old, old_stated, old_status = before
        given, was = 0 <= status <= GIVEN, 0 <= old_status <= GIVEN
        if was != given:
            counts["given, was not" if given else "not given, was"] += 1
            beyond += [] if given else [(key, name, "given before, now status", status, old_status, 0.0)]
            continue
        if not given:
            continue
        counts["compared"] += 1
        counts["with signal"] += bool(np.abs(old).max() > 10.0 * old_stated)
        counts["met before"] += old_status == 0
        counts["met now"] += status == 0
        off, both = float(np.abs(np.subtract(value, old)).max()), stated + old_stated
        if off > both + 1e-12 * float(np.abs(old).max()):
            beyond.append((key, name, "differs", off, both, float(np.abs(old).max())))
        if old_stated > 0.0:
            ratios.append(stated / old_stated)
    report.table(("what", "count"), sorted(counts.items()))
    quantiles = np.quantile(ratios, (0.05, 0.5, 0.95)) if ratios else np.zeros(3)
    report.say(f"Errors stated now over those before: 5 % {quantiles[0]:.2g}, half {quantiles[1]:.2g}, "
               f"95 % {quantiles[2]:.2g}.")  # fmt: skip
    report.table(("question", "parameter", "what", "off", "stated by both", "size"), beyond)
    report.claim_number("derivatives that do not stay", len(beyond), 0)
    report.leave()


def crowd_of(spheres: int) -> dict[str, Any]:
    """A scene of spheres side by side over a glossy floor."""
    side = math.ceil(math.sqrt(spheres))
    rng = np.random.default_rng(7)
    balls = []
    for k in range(spheres):
        radius = float(rng.uniform(0.25, 0.4))
        at = [k % side - 0.5 * side + 0.5, k // side - 0.5 * side + 0.5, radius]
        balls.append({"name": f"S{k}", "center": at, "radius": radius, "color": rng.uniform(0.2, 0.9, 3).tolist()})
    data = json.loads(json.dumps(sr.load("gloss").model_dump(mode="json")))
    return data | {"name": "crowd", "spheres": balls}


def speed(quick: bool) -> None:
    """CPU time of gradients over that of their images."""
    report = Report("derivatives_stay", "a gradient costs a few of its images")
    size, rows = (16 if quick else 64), []
    gloss, crowd = sr.load("gloss"), sr.load(crowd_of(20))
    three = [f"spheres.B.center.{axis}" for axis in "xyz"]
    many = [f"spheres.{s}.{n}" for s in "AB" for n in ("center.x", "center.y", "center.z", "radius", "color")]
    many += ["lights.key.position", "floor.lobe.exponent", "shading.kd", "shading.shininess"][:4]
    eighty = [f"spheres.S{k}.{n}" for k in range(20) for n in ("center.x", "center.y", "center.z", "radius")]
    metal = ["materials.gold05.alpha"]
    for name, scene, wrt in (
        ("gloss, 1", gloss, three[:1]), ("gloss, 3", gloss, three), ("gloss, many", gloss, many),
        ("chapter8, 3", sr.load("chapter8"), three), ("metal, 1", sr.load("metal"), metal),
        ("20 spheres, 80", crowd, eighty),
    ):  # fmt: skip
        how = {"size": size, "tol": 1e-4, "threads": 1}
        sr.truth(scene, **(how | {"size": 2}))
        sr.gradient(scene, wrt, **(how | {"size": 2}))
        image = min(cpu_seconds(lambda s=scene, h=how: sr.truth(s, **h)) for _ in range(2))
        slope = cpu_seconds(lambda s=scene, w=wrt, h=how: sr.gradient(s, w, **h))
        rows.append((name, image, slope, slope / image))
    report.table(("scene, parameters", "image CPU s", "gradient CPU s", "ratio"), rows)


def main() -> None:
    """Entry point."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    what = parser.add_mutually_exclusive_group(required=True)
    for word, does in (("make", "write what is answered now"), ("check", "compare"), ("speed", "time gradients")):
        what.add_argument(f"--{word}", action="store_true", help=does)
    parser.add_argument("--quick", action="store_true", help="an eighth of the scenes")
    options = parser.parse_args()
    if options.make:
        make(options.quick)
    elif options.speed:
        speed(options.quick)
    else:
        check(options.quick)


if __name__ == "__main__":
    main()
