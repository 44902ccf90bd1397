"""Mutated gallery files load or raise SceneError, in no time, and whatever loads can be dumped and loaded."""

from __future__ import annotations

import json
import random
import time
from pathlib import Path

from busy import in_processor_time
from symrender.errors import SceneError
from symrender.scene import gallery
from symrender.scene.dump import to_yaml
from symrender.scene.load import load, parse

FILES = 300
LIMIT = 0.2
SNIPPETS = (
    *(b"&a ", b"*a ", b"<<: ", b"!!int ", b"---\n", b"\n\n", b"  ", b"\t", b": ", b"- ", b"[", b"]", b"{", b"}", b"'"),
    *(b'"', b"#", b"|", b">", b"\0", b"\xff", b"\xed\xa0\x80", b"1e400", b"-1", b"0", b".nan", b"null", b"true"),
    *(b"9" * 500, b"\xe2\x80\xae", b"\x1b[31m", b"[[", b"]]", b'"""', b"= ", b"\\", b"\\ud800", b"radius", b"type"),
)


def toml(value: object) -> str:
    """The one-line TOML of a scene's plain data."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {toml(entry)}" for key, entry in value.items() if entry is not None) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(toml, value)) + "]"
    return json.dumps(value)


def mutated(data: bytes, random_: random.Random) -> bytes:
    for _ in range(random_.randint(1, 3)):
        at, span = random_.randrange(len(data) + 1), random_.randint(0, 8)
        match random_.randrange(5):
            case 0:
                data = data[:at] + data[at + span :]
            case 1:
                data = data[:at] + random_.choice(SNIPPETS) + data[at:]
            case 2:
                data = data[:at] + bytes([random_.randrange(256)]) + data[at + 1 :]
            case 3:
                data = data[:at] + data[at : at + span] * random_.randint(2, 5) + data[at + span :]
            case _:
                other = random_.randrange(len(data) + 1)
                data = data[:at] + data[other : other + span] + data[at:]
    return data


def test_mutated_files(tmp_path: Path) -> None:
    random_ = random.Random(20240607)
    originals = []
    for name in gallery.names():
        plain = load(name).model_dump()
        originals.append((".yaml", gallery.text(name).encode()))
        originals.append((".json", json.dumps(plain, indent=1).encode()))
        originals.append((".toml", "\n".join(f"{k} = {toml(v)}" for k, v in plain.items() if v is not None).encode()))
    for suffix, data in originals:
        assert parse(data.decode(), "original", suffix).spheres
    loaded = refused = 0
    for count in range(FILES):
        suffix, data = originals[count % len(originals)]
        path = tmp_path / f"{count}{suffix}"
        path.write_bytes(mutated(data, random_))
        start = time.process_time()
        try:
            scene = load(path)
        except SceneError as error:
            refused += 1
            assert all(line.isprintable() for line in str(error).split("\n"))
            assert str(error).startswith(f"{path}"[:90])
        else:
            loaded += 1
            assert parse(to_yaml(scene), "again") == scene
        assert in_processor_time(time.process_time() - start, LIMIT)
    assert loaded >= FILES // 20
    assert refused >= FILES // 2
