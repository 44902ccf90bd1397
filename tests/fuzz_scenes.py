"""Scene files nobody should write: generated, mutated in structure, mutated in bytes; and what must hold for each.

Driven by any ``random.Random``: hypothesis's own in the tests, a seeded one in the benchmark, bytes from a fuzzer.
"""

from __future__ import annotations

import json
import math
import random
import time
from functools import cache
from pathlib import Path
from typing import Any

from busy import in_processor_time
from symrender.errors import SceneError
from symrender.scene import gallery
from symrender.scene.arrays import scene_arrays
from symrender.scene.dump import to_yaml
from symrender.scene.load import load, parse
from symrender.scene.warnings import warnings

CORPUS = Path(__file__).parent / "fuzz_corpus"
LIMIT = 2.0
"""Most processor seconds a file may take; waiting for others is not the file's."""
SUFFIXES = (".yaml", ".json", ".toml")
NUMBERS = (
    *(0, 1, -1, 2, 64, 1e-300, 1e300, 1e308, -1e308, 5e-324, 1e-12, 1e12, 1e13, 1e15, 0.5, -0.5, -2.0, 3.999, 1e-154),
    *(math.pi, math.pi / 2, math.nextafter(math.pi / 2, 4), math.inf, -math.inf, math.nan, -0.0, 2**53, 2**63, 10**30),
)
TEXTS = (
    *("", " ", "A", "eye", "checker", "look_at", "plane", "on", "no", "010", "1:30", "2024-01-01", "1e3", "~", "null"),
    *("sin(t)", "9**9**9", "().__class__", "__import__('os').system('x')", "x; } void main(){} //", "\x1b[31m"),
    *("</script><script>", "\u2028", "${}", "\u202e", "../../x.png", "a" * 101, "a" * 5000, "NaN", "\ud83d\ude00"),
)
SNIPPETS = (
    *(b"&a ", b"*a ", b"<<: ", b"!!int ", b"!!python/object/apply:os.system ", b"---\n", b"...\n", b"\n\n", b"  "),
    *(b"\t", b": ", b"- ", b"? ", b"[", b"]", b"{", b"}", b"'", b'"', b"#", b"|", b">", b"%", b"@", b"\0", b"\xff"),
    *(b"\xed\xa0\x80", b"\xef\xbb\xbf", b"\xe2\x80\xae", b"\xe2\x80\xa8", b"1e400", b"-1", b".nan", b".inf", b"null"),
    *(b"9" * 500, b"0x" + b"f" * 300, b"[[" * 40, b"{a: " * 40, b'"""', b"'''", b"= ", b"\\", b"\\ud800", b"[[x]]"),
    *(b"a." * 40, b"radius: 1\n", b"spheres:\n", b"type: checker\n", b"1_000", b"0o17", b"1e-400", b"-0.0", b"true"),
)


@cache
def originals() -> tuple[str, ...]:
    """Every gallery scene as JSON."""
    return tuple(json.dumps(load(name).model_dump()) for name in gallery.names())


def places(value: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Paths of everything inside plain data."""
    found = [path] if path else []
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, entry in items:
        found += places(entry, (*path, key))
    return found


def hostile(draw: random.Random, depth: int = 0) -> Any:
    """A value no field expects, or one just at its edge."""
    match draw.randrange(9 if depth < 4 else 5):
        case 0 | 1:
            return draw.choice(NUMBERS)
        case 2:
            return draw.choice(TEXTS)
        case 3:
            return draw.choice((None, True, False, [], {}))
        case 4:
            return draw.uniform(-10, 10)
        case 5:
            return [hostile(draw, depth + 1) for _ in range(draw.choice((1, 2, 3, 4, 65)))]
        case 6:
            return {draw.choice(TEXTS) or "k": hostile(draw, depth + 1) for _ in range(draw.randrange(1, 5))}
        case 7:
            return [draw.uniform(-5, 5) for _ in range(3)]
        case _:
            return {"name": draw.choice(TEXTS), "center": [0, 0, draw.choice(NUMBERS)], "radius": draw.choice(NUMBERS)}


def restructured(draw: random.Random) -> Any:
    """A gallery scene with values replaced, dropped, renamed, moved and repeated."""
    data = json.loads(draw.choice(originals()))
    for _ in range(draw.choice((1, 1, 1, 2, 3, 8))):
        path = draw.choice(places(data))
        holder = data
        for step in path[:-1]:
            holder = holder[step]
        key = path[-1]
        match draw.randrange(7):
            case 0 | 1 | 2:
                holder[key] = hostile(draw)
            case 3:
                del holder[key]
            case 4 if isinstance(holder, dict):
                name = str(key)
                cut = draw.randrange(len(name))
                holder[name[:cut] + draw.choice(("", "x", name[cut:][::-1])) + name[cut + 1 :] or "k"] = holder.pop(key)
            case 5 if isinstance(holder, list):
                holder.extend([holder[key]] * draw.choice((1, 2, 300)))
            case _:
                other = draw.choice(places(data))
                value: Any = data
                for step in other:
                    value = value[step]
                holder[key] = json.loads(json.dumps(value))
        if not places(data):
            break
    return data


def generated(draw: random.Random) -> Any:
    """A scene from nothing, mostly of the right shape."""

    def odd(value: Any, chance: float = 0.004) -> Any:
        return hostile(draw) if draw.random() < chance else value

    def number() -> Any:
        return odd(draw.choice((0, 1, -1, 1e-12, 1e12, -1e12, 0.1)) if draw.random() < 0.1 else draw.uniform(-4, 4))

    def length() -> Any:
        return odd(draw.choice((1e-150, 1e-30, 1e12, 3)) if draw.random() < 0.1 else draw.uniform(0.01, 4))

    def share() -> Any:
        return odd(draw.choice((0, 1, 0.0, 1.0)) if draw.random() < 0.2 else draw.random())

    def vector() -> Any:
        return odd([number() for _ in range(3)])

    def color() -> Any:
        return odd([share() for _ in range(3)])

    def lobe() -> Any:
        exponent = draw.choice((0, 1, 64, 1e12, 1e-300, draw.uniform(0, 1e4)))
        theta = draw.choice((0, 1e-300, 0.3, math.pi / 2, draw.uniform(0, 1.57)))
        return odd({"weight": share(), "exponent": odd(exponent), "theta_max": odd(theta)})

    def texture() -> Any:
        kind = draw.choice(("solid", "checker", "stripes", "marble"))
        return odd({"type": kind} | ({"ku": draw.choice((0, 1, 8, 4096))} if kind != "solid" else {}))

    def sphere(k: int) -> Any:
        made = {"name": odd(f"s{k}"), "center": vector(), "radius": length(), "lobe": lobe(), "color": color()}
        return odd(made | ({"texture": texture()} if draw.random() < 0.5 else {}))

    def light(k: int) -> Any:
        made = {"type": "point", "name": f"l{k}", "position": vector(), "color": color()}
        if draw.random() < 0.5:
            made |= {"type": "disk", "radius": length(), "target": vector()}
        return odd(made)

    camera = {"type": "look_at", "eye": vector(), "target": vector(), "fov": odd(draw.uniform(1, 179))}
    if draw.random() < 0.3:
        camera = {"type": "plane", "eye": vector(), "window_half": length()}
    scene: dict[str, Any] = {"name": odd("scene", 0.1), "camera": odd(camera)}
    scene["spheres"] = odd([sphere(k) for k in range(draw.choice((0, 1, 2, 5, 40)))])
    scene["lights"] = odd([light(k) for k in range(draw.choice((0, 1, 2, 9)))])
    if draw.random() < 0.6:
        scene["floor"] = {"lobe": lobe()}
    if draw.random() < 0.1:
        scene[draw.choice(TEXTS)] = hostile(draw)
    return scene


def toml(value: Any) -> str:
    """Plain data as a TOML value."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(str(k))} = {toml(v)}" for k, v in value.items() if v is not None) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(toml(entry) for entry in value if entry is not None) + "]"
    if isinstance(value, float):
        return "nan" if math.isnan(value) else ("inf" if value > 0 else "-inf") if math.isinf(value) else repr(value)
    return json.dumps(value)


def written(data: Any, suffix: str) -> bytes:
    """Plain data as the text of a file."""
    if suffix == ".toml" and isinstance(data, dict):
        text = "\n".join(f"{json.dumps(str(k))} = {toml(v)}" for k, v in data.items() if v is not None)
    elif suffix == ".yaml" and isinstance(data, dict):
        flow = json.dumps(data).replace("NaN", ".nan").replace("-Infinity", "-.inf").replace("Infinity", ".inf")
        text = flow if len(data) % 2 else "\n".join(f"{json.dumps(str(k))}: {json.dumps(v)}" for k, v in data.items())
    else:
        text = json.dumps(data, indent=1)
    return text.encode("utf-8", "surrogatepass")


def mutated(data: bytes, draw: random.Random) -> bytes:
    """``data`` with a few bytes cut, put in, repeated or moved."""
    for _ in range(draw.choice((1, 1, 2, 3, 12))):
        at, span = draw.randrange(len(data) + 1), draw.choice((0, 1, 2, 8, 60))
        match draw.randrange(6):
            case 0:
                data = data[:at] + data[at + span :]
            case 1 | 2:
                data = data[:at] + draw.choice(SNIPPETS) + data[at:]
            case 3:
                data = data[:at] + bytes([draw.randrange(256)]) + data[at + 1 :]
            case 4:
                data = data[:at] + data[at : at + span] * draw.choice((2, 3, 200)) + data[at + span :]
            case _:
                other = draw.randrange(len(data) + 1)
                data = data[:at] + data[other : other + span] + data[at:]
    return data


def scene_file(draw: random.Random) -> tuple[str, bytes]:
    """A file ending and the bytes of a file: 4 in 10 generated, 4 restructured, 2 mutated from either or the corpus."""
    suffix = draw.choice(SUFFIXES)
    kind = draw.randrange(10)
    if kind < 4:
        return suffix, written(generated(draw), suffix)
    if kind < 8:
        return suffix, written(restructured(draw), suffix)
    source = draw.randrange(3)
    if source == 0:
        path = draw.choice(sorted(CORPUS.iterdir()))
        return path.suffix if path.suffix in SUFFIXES else suffix, mutated(path.read_bytes(), draw)
    if source == 1:
        return ".yaml", mutated(gallery.text(draw.choice(gallery.names())).encode(), draw)
    return suffix, mutated(written(json.loads(draw.choice(originals())), suffix), draw)


def check(path: Path) -> bool:
    """Whether the file at ``path`` is a scene; AssertionError if what loading it did is against the rules."""
    begun = time.process_time()
    try:
        scene = load(path)
    except SceneError as error:
        scene = None
        lines = str(error).split("\n")
        assert all(line and line.isprintable() and len(line) <= 400 for line in lines), lines
        assert lines[0].startswith(str(path)[:80]), lines[0]
    if scene is not None:
        assert parse(to_yaml(scene), "again") == scene
        assert parse(to_yaml(scene), "again").hash == scene.hash
        assert all(isinstance(warning, str) for warning in warnings(scene))
        scene_arrays(scene)
    seconds = time.process_time() - begun
    assert in_processor_time(seconds, LIMIT), f"{seconds:.2f} s"
    return scene is not None
