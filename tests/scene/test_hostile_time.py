"""No text takes long to refuse, however it is made."""

from __future__ import annotations

import gc
import time
from itertools import pairwise

import pytest

from busy import in_processor_time
from symrender.errors import SceneError
from symrender.scene.load import parse

LIMIT = 0.5
"""Seconds of processor time, the best of three tries: 0.2 on the machine this was measured on (the worst took 0.19),
and room for slower ones. Undefended, the merge chain takes 7 s and the dotted key of 40 kB takes 6 s."""

MERGES = "a0: &a0 {k: 1}\n" + "".join(f"a{i}: &a{i} {{<<: [*a{i - 1}, *a{i - 1}]}}\n" for i in range(1, 19))
BILLION = "a: &a [x]\n" + "".join(f"{c}: &{c} [{', '.join([f'*{p}'] * 9)}]\n" for p, c in pairwise("abcdefghi"))
BOMBS = {
    "merge chain": (MERGES, ".yaml"),
    "billion laughs": (BILLION, ".yaml"),
    "deep list": ("a: " + "[" * 500_000, ".yaml"),
    "deep dashes": ("- " * 500_000, ".yaml"),
    "deep flow": ("{a: " * 250_000, ".yaml"),
    "question marks": ("? " * 500_000, ".yaml"),
    "wide list": ("a: [" + "1," * 500_000 + "]", ".yaml"),
    "many keys": ("".join(f"k{i}: 1\n" for i in range(90_000)), ".yaml"),
    "many unknown spheres": ("spheres: [" + "{}," * 4096 + "]", ".yaml"),
    "many wrong spheres": ("spheres: [" + "{a: 1, b: 2, c: 3, d: 4}," * 4096 + "]", ".yaml"),
    "long text": ("name: " + "x" * 1_000_000, ".yaml"),
    "long block": ("a: |\n" + " x\n" * 300_000, ".yaml"),
    "long escapes": ('name: "' + "\\x41" * 250_000 + '"', ".yaml"),
    "long integer": ("a: " + "9" * 1_000_000, ".yaml"),
    "long near number": ("a: " + "9" * 1_000_000 + "x", ".yaml"),
    "comments": ("#\n" * 500_000, ".yaml"),
    "json depth": ("[" * 1_000_000, ".json"),
    "json width": ("[" + "1," * 500_000 + "1]", ".json"),
    "json keys": ("{" + ",".join(f'"k{i}":1' for i in range(90_000)) + "}", ".json"),
    "json backslashes": ('"' + "\\" * 1_000_000, ".json"),
    "json lines": ("\n" * 1_000_000, ".json"),
    "json integer": ("9" * 1_000_000, ".json"),
    "toml dotted key": ("a" + ".a" * 500_000 + "=1", ".toml"),
    "toml 40 kB dotted key": ("a" + ".a" * 20_000 + "=1", ".toml"),
    "toml depth": ("a=" + "[" * 500_000, ".toml"),
    "toml inline depth": ("a=" + "{a=" * 300_000, ".toml"),
    "toml keys": ("".join(f"k{i}=1\n" for i in range(90_000)), ".toml"),
    "toml tables": ("".join(f"[a{i}.b.c.d.e.f.g.h]\n" for i in range(20_000)), ".toml"),
    "toml deep tables": ("".join("[" + "a." * 30 + f"b{i}]\n" for i in range(10_000)), ".toml"),
    "toml lists of tables": ("[[a]]\n" * 150_000, ".toml"),
    "toml integer": ("a=" + "9" * 1_000_000, ".toml"),
    "toml open text": ('a="""' + "x\n" * 400_000, ".toml"),
    "toml quotes": ("'" * 1_000_000, ".toml"),
    "toml triple quotes": ('"""' * 300_000, ".toml"),
    "toml equal signs": ("=" * 1_000_000, ".toml"),
}


def test_the_merge_chain_is_the_one_measured() -> None:
    assert len(MERGES) <= 650


@pytest.mark.parametrize("name", BOMBS)
def test_bombs_are_refused_at_once(name: str) -> None:
    text, suffix = BOMBS[name]
    best = float("inf")
    # what other tests left on the heap is not the parser's to collect
    gc.collect()
    gc.freeze()
    for _ in range(3):
        start = time.process_time()
        with pytest.raises(SceneError):
            parse(text, "bomb", suffix)
        best = min(best, time.process_time() - start)
        if best < LIMIT:
            break
    gc.unfreeze()
    assert in_processor_time(best, LIMIT)
