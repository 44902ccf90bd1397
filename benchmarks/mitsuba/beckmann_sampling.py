"""Directions Mitsuba draws for a Beckmann conductor do not have the density that they are weighed by.

    pip install mitsuba
    python beckmann_sampling.py [--quick]

The albedo of a rough conductor that reflects all there is (material `none`) in one direction of view, twice: the BSDF
as Mitsuba evaluates it, integrated over the hemisphere by a product of Gauss rules, and the mean of the weights that
come with the directions it draws. Both are one number if what is drawn has the density that it is weighed by. Normals
are drawn by the inverse of the distribution of those that are seen, which holds the exact masking of the view; density
and weight have the rational fit of it (Walter et al. 2007). So the mean should be off by exact over fitted masking,
which is the prediction. GGX, whose masking needs no fit, is asked beside it. Nothing of symrender is used.
DRJIT_LIBLLVM_PATH may have to name LLVM's library.
"""

from __future__ import annotations

import argparse
import math
import sys
from typing import Any, Final

import numpy as np
from numpy.polynomial.legendre import leggauss

ALPHAS: Final = (0.1, 0.3, 0.6)
COSINES: Final = (0.9, 0.5, 0.2, 0.1, 0.05, 0.02)
BATCH: Final = 1 << 20
SINGLE: Final = 3e-7
"""What single precision leaves of a number near 1."""
NODES: Final = (1000, 1400)
"""Of each of the two angles; what they differ by is what the integral may be off."""
AGREE: Final = 4.0
"""Standard errors beyond which two numbers of 36 are not the same: 1 of 400 such tables has one by chance."""


def material(mi: Any, distribution: str, alpha: float) -> Any:
    return mi.load_dict({"type": "roughconductor", "distribution": distribution, "alpha": alpha, "material": "none"})


def interaction(mi: Any, cosine: float) -> Any:
    """A place of which the view makes this cosine with the normal."""
    met = mi.SurfaceInteraction3f()
    met.wi = mi.Vector3f(math.sqrt(1.0 - cosine * cosine), 0.0, cosine)
    met.sh_frame = mi.Frame3f(mi.Vector3f(0.0, 0.0, 1.0))
    return met


def fitted_off(alpha: float, cosine: float) -> float:
    """Exact masking of Beckmann's distribution over its rational fit, less 1."""
    a = cosine / math.sqrt(1.0 - cosine * cosine) / alpha
    exact = 2.0 / (1.0 + math.erf(a) + math.exp(-a * a) / (a * math.sqrt(math.pi)))
    fit = 1.0 if a >= 1.6 else (3.535 * a + 2.181 * a * a) / (1.0 + 2.276 * a + 2.577 * a * a)
    return exact / fit - 1.0


def integrated(mi: Any, bsdf: Any, cosine: float, nodes: int) -> float:
    """Integral of the BSDF over the hemisphere; it is even in the azimuth."""
    u, weight = leggauss(nodes)
    theta, phi = 0.25 * math.pi * (u + 1.0), 0.5 * math.pi * (u + 1.0)
    sine = np.sin(theta)
    x, y = np.outer(sine, np.cos(math.pi - phi)), np.outer(sine, np.sin(math.pi - phi))
    z = np.outer(np.cos(theta), np.ones(nodes))
    to = mi.Vector3f(*(mi.Float(each.ravel().astype(np.float32)) for each in (x, y, z)))
    found = np.array(bsdf.eval(mi.BSDFContext(), interaction(mi, cosine), to).x, dtype=np.float64).reshape(z.shape)
    return float(2.0 * np.einsum("i,j,ij", 0.25 * math.pi * weight * sine, 0.5 * math.pi * weight, found))


def drawn(mi: Any, bsdf: Any, cosine: float, seeds: range) -> tuple[float, float]:
    """Mean of the weights of directions that are drawn, and its standard error."""
    import drjit as dr

    sampler = mi.load_dict({"type": "independent"})
    total, square = 0.0, 0.0
    for seed in seeds:
        sampler.seed(seed, BATCH)
        sample, weight = bsdf.sample(mi.BSDFContext(), interaction(mi, cosine), sampler.next_1d(), sampler.next_2d())
        found = np.array(dr.select(sample.pdf > 0, weight.x, 0.0), dtype=np.float64)
        total += found.sum()
        square += (found**2).sum()
    count = len(seeds) * BATCH
    mean = total / count
    return mean, math.sqrt((square / count - mean * mean) / count)


def main() -> None:
    import mitsuba as mi

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="four million directions in place of 17")
    batches = 4 if parser.parse_args().quick else 16
    mi.set_variant("llvm_ad_rgb")
    print("## beckmann_sampling\n")
    print(f"Mitsuba {mi.__version__}, {batches * BATCH:.2g} directions each; z is of what is predicted.\n")
    print("| distribution | alpha | cosine of the view | integral | mean of weights | off by | predicted | z |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    apart, unlike, first = {"beckmann": 0, "ggx": 0}, 0, 0
    for distribution in apart:
        for alpha in ALPHAS:
            bsdf = material(mi, distribution, alpha)
            for cosine in COSINES:
                coarse, fine = (integrated(mi, bsdf, cosine, nodes) for nodes in NODES)
                mean, error = drawn(mi, bsdf, cosine, range(first, first + batches))
                first += batches
                doubt = math.hypot(error, SINGLE, fine - coarse)
                predicted = fitted_off(alpha, cosine) if distribution == "beckmann" else 0.0
                z = (mean - fine * (1.0 + predicted)) / doubt
                apart[distribution] += abs(mean - fine) > AGREE * doubt
                unlike += abs(z) > AGREE
                print(
                    f"| {distribution} | {alpha} | {cosine} | {fine:.6f} | {mean:.6f} +- {error:.1g} "
                    f"| {mean / fine - 1.0:+.2e} | {predicted:+.2e} | {z:+.1f} |",
                    flush=True,
                )
    told = ", ".join(f"{count} of {distribution}" for distribution, count in apart.items())
    print(
        f"\nMean and integral apart by more than {AGREE:g} standard errors: {told}; unlike what is predicted: {unlike}"
    )
    print("\nheld" if unlike == 0 and apart["beckmann"] > 0 == apart["ggx"] else "\nNOT HELD")
    sys.exit(0 if unlike == 0 and apart["beckmann"] > 0 == apart["ggx"] else 1)


if __name__ == "__main__":
    main()
