from __future__ import annotations

import numpy as np
import pytest

from symrender.numeric.random import philox, pixel_key, uniforms

# known answers of philox4x32-10 published with Random123: counter, key, result
KNOWN = [
    ((0, 0, 0, 0), (0, 0), (0x6627E8D5, 0xE169C58D, 0xBC57AC4C, 0x9B00DBD8)),
    ((0xFFFFFFFF,) * 4, (0xFFFFFFFF,) * 2, (0x408F276D, 0x41C83B0E, 0xA20BC7C6, 0x6D5451FD)),
    (
        (0x243F6A88, 0x85A308D3, 0x13198A2E, 0x03707344),
        (0xA4093822, 0x299F31D0),
        (0xD16CFE09, 0x94FDCCEB, 0x5001E420, 0x24126EA1),
    ),
]


@pytest.mark.parametrize("counter,key,answer", KNOWN)
def test_known_answers(counter: tuple[int, ...], key: tuple[int, ...], answer: tuple[int, ...]) -> None:
    words = philox(*(np.uint64(x) for x in counter), *(np.uint64(x) for x in key))
    assert tuple(int(word) for word in words) == answer


def test_every_part_of_the_counter_counts() -> None:
    base = (7, 3, 4, 5, 0)
    seen = {uniforms(pixel_key(*base[:3]), *base[3:])}
    for place in range(5):
        for step in (1, 1 << 20):
            moved = list(base)
            moved[place] += step
            seen.add(uniforms(pixel_key(*moved[:3]), *moved[3:]))
    seen.add(uniforms(pixel_key(7 + (1 << 40), 3, 4), 5, 0))
    assert len(seen) == 12
    assert all(0 <= x < 1 for pair in seen for x in pair)


def test_moments_of_neighbouring_pixels() -> None:
    """Mean and pair correlation over 20000 keys, each within 4.5 standard errors: false alarm 3e-5."""
    draws = np.array([uniforms(pixel_key(1, i % 200, i // 200), 0, 0) for i in range(20_000)])
    error = 4.5 / np.sqrt(12 * len(draws))
    assert np.abs(draws.mean(axis=0) - 0.5).max() < error
    assert abs(np.corrcoef(draws.T)[0, 1]) < 4.5 / np.sqrt(len(draws))
    assert abs(np.corrcoef(draws[:-1, 0], draws[1:, 0])[0, 1]) < 4.5 / np.sqrt(len(draws))
