"""The program beside an export: its file is what an audit reads, and no two of its seeds draw the same numbers."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np

import symrender as sr
from symrender.audit.measured import measured

STUB = '''
"""As much of Mitsuba as the program asks for: light is the number that the sampler was seeded with, over 2^20."""
import sys
from types import ModuleType, SimpleNamespace

import numpy as np

__version__ = "0"
UInt32 = None
ALL = []


class Point2f:
    def __init__(self, x, y):
        self.x, self.y = x, y

    def __truediv__(self, other):
        return Point2f(self.x / other.x, self.y / other.y)


class Sampler:
    def seed(self, seed, count):
        ALL.append(seed)
        self.number, self.count = seed, count

    def sample_count(self):
        return 16

    def next_2d(self):
        return Point2f(np.full(self.count, 0.5), np.full(self.count, 0.5))


class Bitmap:
    PixelFormat = SimpleNamespace(MultiChannel=0)

    def __init__(self, *_):
        pass

    def metadata(self):
        return {}

    def write(self, name):
        open(name + ".seeds", "w").write(" ".join(map(str, ALL)))


def sample(scene, sampler, ray):
    return (np.full((3, sampler.count), sampler.number / 2**20),)


def load_file(name):
    sensor = SimpleNamespace(sampler=Sampler, sample_ray_differential=lambda *_: (None, None))
    return SimpleNamespace(sensors=lambda: [sensor], integrator=lambda: SimpleNamespace(sample=sample))


def load_dict(_):
    return Sampler()


def set_variant(_):
    pass
'''


def drawn(folder: Path, seed: int, samples: int) -> list[int]:
    """What Mitsuba's sampler was seeded with, round by round."""
    words = ["--samples", str(samples), "--seed", str(seed), "--out", f"seeds/{seed}"]
    done = subprocess.run(
        [sys.executable, str(folder / "out" / "run.py"), *words],
        env=os.environ | {"PYTHONPATH": str(folder)}, capture_output=True, text=True, timeout=120, cwd=folder,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return [int(word) for word in (folder / "seeds" / f"{seed}.exr.seeds").read_text().split()]


def test_seeds_share_no_random_numbers(tmp_path: Path) -> None:
    """Of 70,000 samples a pixel the sixth round of one seed was once the first of the next."""
    made = sr.export("interreflection", "mitsuba", tmp_path / "out", size=8)
    (tmp_path / "mitsuba.py").write_text(STUB)
    (tmp_path / "drjit.py").write_text("import numpy as np\n\n\ndef arange(_, n):\n    return np.arange(n)\n")
    rounds = [drawn(tmp_path, seed, 70_000) for seed in (0, 1, 2)]
    assert {len(each) for each in rounds} == {5}
    assert len({number for each in rounds for number in each}) == 15
    found = measured([tmp_path / "seeds" / "1.npz"])
    shares = np.array([16_384] * 4 + [70_000 - 4 * 16_384])
    assert found.samples == 70_000 and found.receipts == (made.receipt["scene_hash"],)
    assert np.allclose(found.mean, (shares * rounds[1]).sum() / 70_000 / 2**20)
