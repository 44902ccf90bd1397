"""What share of public scene files loads: every whole scene of Mitsuba and pbrt below a folder, and what blocks most.

    python benchmarks/public_files.py FOLDER [--render N] [--list]

A whole scene has a camera of its own, or by what it includes; files of Nori, and of versions of pbrt before 4, are
counted apart. ``--render N`` renders N of the scenes that load at 32 x 32, 4 paths a pixel. Files may name others
outside their own folder.
"""

from __future__ import annotations

import os
import re
import signal
import sys
import time
from collections import Counter, defaultdict
from pathlib import Path
from typing import Any

import numpy as np

import symrender as sr
from symrender.errors import SceneError, SymrenderError

SECONDS = 120
"""Longest time for one file."""
PLACE = re.compile(r"^.*?:\d+:\d+: ?")
TIMES = re.compile(r" \(\d+ times, first here\)$")
VALUE = re.compile(
    r"(?:, )?got .*$|\b[\w./-]+\.(?:exr|png|jpg|jpeg|ply|obj|hdr|serialized|spd|gz|pbrt|xml|tga)\b|[-+]?\d[\d.e+-]*"
)


class TooLong(Exception):
    """A file took longer than ``SECONDS``."""


def alarmed(*_: Any) -> None:
    raise TooLong


def kind_of(path: Path) -> str:
    """``mitsuba``, ``nori`` (or what is like it), ``pbrt``, or nothing for what is no whole scene."""
    text = path.read_bytes().decode("utf-8", "replace")
    if path.suffix == ".pbrt":
        return "pbrt" if re.search(r"^\s*WorldBegin", text, re.MULTILINE) and "Camera" in text else ""
    if not re.search(r"<scene[\s>]", text):
        return ""
    if re.search(r"<(?:camera|accel|mesh|brdf|world)[\s>]", text) and "<sensor" not in text:
        return "nori"
    if {"include", "fragments"} & {*path.parts}:
        # parts of scenes, which have a camera and lack what includes them
        return ""
    return "mitsuba" if any(tag in text for tag in ("<sensor", "<camera", "<include")) else ""


def reasons(error: SceneError) -> list[str]:
    """Kinds of what is wrong, without places and values."""
    lines = []
    for line in str(error).splitlines():
        words = TIMES.sub("", PLACE.sub("", line))
        lines.append(VALUE.sub("_", words)[:110])
    return lines


def loaded(path: Path) -> Any:
    signal.signal(signal.SIGALRM, alarmed)
    signal.alarm(SECONDS)
    try:
        return sr.load(path, allow_outside=True)
    finally:
        signal.alarm(0)


def main() -> int:
    os.chdir(sys.argv[1])
    folder = Path()
    renders = int(sys.argv[sys.argv.index("--render") + 1]) if "--render" in sys.argv else 0
    files = sorted(path for ending in ("xml", "pbrt") for path in folder.rglob(f"*.{ending}"))
    counts: dict[str, Counter[str]] = defaultdict(Counter)
    blocks: dict[str, Counter[str]] = defaultdict(Counter)
    alone: dict[str, Counter[str]] = defaultdict(Counter)
    crashed = []
    for path in files:
        kind = kind_of(path)
        if not kind:
            continue
        begun = time.process_time()
        try:
            scene = loaded(path)
        except SceneError as error:
            found = reasons(error)
            if "earlier version" in str(error):
                kind = "pbrt before 4"
            counts[kind]["refused"] += 1
            for reason in set(found):
                blocks[kind][reason] += 1
            if len(set(found)) == 1:
                alone[kind][found[0]] += 1
            if "--list" in sys.argv:
                print("--", path.relative_to(folder), len(found), found[0])
            continue
        except TooLong:
            crashed.append(f"{path}: longer than {SECONDS} s")
            continue
        except Exception as error:
            crashed.append(f"{path}: {type(error).__name__}: {error}"[:300])
            continue
        counts[kind]["loads"] += 1
        if "--list" in sys.argv:
            print("ok", path.relative_to(folder), f"{time.process_time() - begun:.1f} s")
        if renders > 0:
            renders -= 1
            try:
                image = sr.render(scene, size=32, numeric="independent", symbolic="none", lobe=2)
                assert np.isfinite(image.numeric.radiance).all()
            except SymrenderError as error:
                counts[kind]["not rendered"] += 1
                blocks[f"{kind}, rendered"][str(error)[:110]] += 1
            except Exception as error:
                crashed.append(f"{path}: rendered: {type(error).__name__}: {error}"[:300])
    for kind, found_of in counts.items():
        total = found_of["loads"] + found_of["refused"]
        print(
            f"{kind}: {found_of['loads']} of {total} whole scenes load, {found_of['loads'] / total:.0%}; "
            f"{dict(found_of)}"
        )
        for reason, count in blocks[kind].most_common(45):
            print(f"  {count:4d}  alone {alone[kind][reason]:3d}  {reason}")
    for kind in blocks:
        if kind.endswith("rendered"):
            print(kind, blocks[kind].most_common(10))
    print(f"{len(crashed)} files crashed or took too long")
    print("\n".join(crashed))
    return bool(crashed)


if __name__ == "__main__":
    sys.exit(main())
