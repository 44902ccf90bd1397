# %% [markdown]
# # The normaliser in closed form, stratum weights, units
#
# Three quantities of the lobe have closed forms: its integral W (the normaliser), the integral of its weight over one
# stratum (one cell of the cone), and its widths. SymPy derives them here, and each is checked against a quadrature that
# knows none of them. Then the cell asks what the closed forms buy: where the integrand is smooth a great deal, where a
# silhouette crosses the lobe nothing. Last it compares the two conventions in which a reflection may be written down.

# %%
import matplotlib.pyplot as plt
import numpy as np
import sympy as sp

import symrender as sr

theta, a_, b_, rim, n_, c_ = sp.symbols("theta a b theta_max n c", positive=True)
# with c = cos(theta), dc = -sin(theta) dtheta, the weight of a ring per radian of azimuth
ring = sp.integrate(c_**n_, (c_, sp.cos(b_), sp.cos(a_)))
normaliser = 2 * sp.pi * ring.subs({a_: 0, b_: rim})
moment = sp.integrate(c_ ** (n_ + 1), (c_, sp.cos(b_), sp.cos(a_)))
print("weight of a ring, over dphi:", sp.simplify(ring))
print("normaliser:", sp.simplify(normaliser))
print("mean cosine of a ring:", sp.simplify(moment / ring))
slope = sp.simplify(sp.diff(ring, b_) - sp.cos(b_) ** n_ * sp.sin(b_))
print("derivative by the outer angle, less the weight there:", slope)
by_sympy = sp.lambdify((n_, rim), normaliser, "numpy")

held = sr.expression("gloss", surface="floor")
print("weight     ", held.weight)
print("normaliser ", held.normaliser)
theta_max, n = (float(held.table.values[f"floor.lobe.{key}"]) for key in ("theta_max", "exponent"))


x_gauss, w_gauss = np.polynomial.legendre.leggauss(400)


def gauss(lower, upper):
    """Nodes and weights of Gauss-Legendre quadrature between two numbers."""
    x, w = x_gauss, w_gauss
    return lower + (upper - lower) * (x + 1) / 2, w * (upper - lower) / 2


def power_of_cosine(theta, exponent):
    """cos^n theta without the loss that a cosine near one brings to a high power."""
    return np.exp(exponent * np.log1p(-2 * np.sin(theta / 2) ** 2))


worst = 0.0
for exponent in (0, 1, 2.5, 16, 64, n, 1024):
    u = exponent + 1
    closed = -2 * np.pi * np.expm1(u * np.log1p(-2 * np.sin(theta_max / 2) ** 2)) / u
    angle, weight = gauss(0, theta_max)
    quadrature = 2 * np.pi * (weight * power_of_cosine(angle, exponent) * np.sin(angle)).sum()
    worst = max(worst, abs(closed / quadrature - 1), abs(by_sympy(exponent, theta_max) / quadrature - 1))
    print(f"n = {exponent:6g}: W = {closed:.15g}, quadrature {quadrature:.15g}")

# %% [markdown]
# ## Stratum weights
#
# On a stratum from polar angle a to b the weight integrates to `dphi (cos^u a - cos^u b) / u` with u = n + 1. Written
# like that it subtracts two numbers that may be nearly equal; written with `expm1` it never does. Both, on random thin
# strata, against Gauss quadrature of the weight itself.


# %%
def log_cosine(t):
    return np.log1p(-2 * np.sin(t / 2) ** 2)


rng = np.random.default_rng(1)
count = 20_000
u = 1 + 10 ** rng.uniform(0, 6, count)
a = rng.uniform(0, 1, count) * np.minimum(theta_max, 6 / np.sqrt(u))
b = a * (1 + 10 ** rng.uniform(-9, -1, count))
naive = (np.cos(a) ** u - np.cos(b) ** u) / u
ratio = np.log1p(-2 * np.sin((a + b) / 2) * np.sin((b - a) / 2) / np.cos(a))
stable = -np.exp(u * log_cosine(a)) * np.expm1(u * ratio) / u
x, w = np.polynomial.legendre.leggauss(24)
angle = a[:, None] + (b - a)[:, None] * (x + 1) / 2
fine = (w * np.exp((u - 1)[:, None] * log_cosine(angle)) * np.sin(angle)).sum(axis=1) * (b - a) / 2
lost = int((naive <= 0).sum())
wrong = [np.abs(form / fine - 1).max() for form in (naive, stable)]
print(f"{count} strata: the subtraction gives {lost} weights not above zero, worst relative error {wrong[0]:.2g}")
print(f"the form without it: {int((stable <= 0).sum())} such weights, worst relative error {wrong[1]:.2g}")

# %% [markdown]
# ## What exact weights buy
#
# The mean of f over the lobe by K rings, f read at the middle of each. Weights: the one at the middle times the ring's
# width, as it is or with the sum of weights divided out, or the exact one; and exact weights with f read where the
# ring's mean cosine is, its *barycentre*. Once for a smooth f, the cosine squared, and once for a disk that ends at a
# silhouette inside the lobe: one or zero. Both means have closed forms. The source chapter expects exact weights to
# beat midpoint weights, both with their sums divided out; the figure shows when they do.

# %%
exponent, silhouette = 16, 0.23
c = np.cos(theta_max)


def mass(lower, upper, power):
    """Integral of cos^power theta sin theta between two angles."""
    return (np.cos(lower) ** (power + 1) - np.cos(upper) ** (power + 1)) / (power + 1)


def rules(k):
    """Angles and weights of four rules of k rings."""
    edge = np.linspace(0, theta_max, k + 1)
    middle = (edge[1:] + edge[:-1]) / 2
    at_middle = power_of_cosine(middle, exponent) * np.sin(middle) * theta_max / k
    exact = mass(edge[:-1], edge[1:], exponent)
    barycentre = np.arccos(mass(edge[:-1], edge[1:], exponent + 1) / exact)
    whole = mass(0, theta_max, exponent)
    return {
        "midpoint weights": (middle, at_middle / whole),
        "midpoint weights over their sum": (middle, at_middle / at_middle.sum()),
        "exact weights": (middle, exact / whole),
        "exact weights, barycentres": (barycentre, exact / whole),
    }


ks = (2, 3, 5, 8, 13, 21, 34, 55, 89, 144, 233, 377)
true = {
    "smooth": mass(0, theta_max, exponent + 2) / mass(0, theta_max, exponent),
    "silhouette": mass(0, silhouette, exponent) / mass(0, theta_max, exponent),
}
integrands = {"smooth": lambda angle: np.cos(angle) ** 2, "silhouette": lambda angle: (angle < silhouette) * 1.0}
errors = {
    case: {name: [abs(rules(k)[name][1] @ f(rules(k)[name][0]) - true[case]) for k in ks] for name in rules(2)}
    for case, f in integrands.items()
}
figure, axes = plt.subplots(1, 2, figsize=(9, 3.8), sharey=True, layout="constrained")
for axis, (case, curves) in zip(axes, errors.items()):
    for (name, error), style in zip(curves.items(), ("v:", "o--", "s-", "D-")):
        axis.loglog(ks, error, style, label=name, markersize=4)
    axis.set(xlabel="rings K", title=case)
axes[0].set_ylabel("error of the mean")
axes[0].legend(fontsize=8)
gain = {
    case: {name: float(np.median(np.array(c["midpoint weights over their sum"]) / c[name])) for name in c}
    for case, c in errors.items()
}
print("error of midpoint weights over their sum, in units of the error of ... (median over K)")
for name in ("exact weights", "exact weights, barycentres"):
    print(
        f"{name:28} {gain['smooth'][name]:8.2f} for the smooth f, {gain['silhouette'][name]:6.2f} across the silhouette"
    )

# %% [markdown]
# ## Widths and units
#
# The source chapter's ruler 1/sqrt(2n) is no standard width of this lobe: per axis it spreads by 1/sqrt(n), and the
# RMS angle from its middle is sqrt(2/n). And its average over the lobe is not the BRDF integral in other units: that
# one keeps the surface cosine inside. The factor (n + 2)/(2 pi) makes them agree at normal incidence, and only there.

# %%
print(f"{'n':>6} {'RMS angle':>10} {'sqrt(2/n)':>10} {'per axis':>10} {'1/sqrt n':>10} {'1/sqrt 2n':>10}")
for exponent in (16, 256, 4096):
    angle, weight = gauss(0, np.pi / 2)
    mass = weight * power_of_cosine(angle, exponent) * np.sin(angle)
    rms = np.sqrt((mass * angle**2).sum() / mass.sum())
    axis_width = np.sqrt((mass * np.sin(angle) ** 2).sum() / mass.sum() / 2)
    limits = np.sqrt(2 / exponent), 1 / np.sqrt(exponent), 1 / np.sqrt(2 * exponent)
    print(f"{exponent:6} {rms:10.5f} {limits[0]:10.5f} {axis_width:10.5f} {limits[1]:10.5f} {limits[2]:10.5f}")


def albedo(exponent, degrees):
    """Integral of (n+2)/(2 pi) cos^n theta max(0, w.N) about a mirror direction that far from the normal."""
    height, weight = gauss(0, 1)
    phi = 2 * np.pi * (np.arange(720) + 0.5) / 720
    tilt = np.radians(degrees)
    above = height[:, None] * np.cos(tilt) + np.sqrt(1 - height**2)[:, None] * np.sin(tilt) * np.cos(phi)
    return (exponent + 2) * (weight * height**exponent * np.maximum(above, 0).mean(axis=1)).sum()


shares = {degrees: albedo(64, degrees) for degrees in (0, 30, 60, 80)}
print("\nwhat a white world returns through the BRDF, n = 64:")
for degrees, share in shares.items():
    print(f"  mirror direction {degrees:2} degrees from the normal: {share:.4f}   (the average over the lobe: 1)")

# %%
assert slope == 0, f"the weight is an antiderivative, left {slope}"
assert worst < 1e-12, f"the normaliser agrees with quadrature, off by {worst:.2g}"
assert lost > 0 and wrong[1] < 1e-10 < wrong[0], f"{lost} lost, errors {wrong}"
assert gain["smooth"]["exact weights, barycentres"] > 3, f"barycentres pay where f is smooth, {gain}"
assert all(value < 1.5 for value in gain["silhouette"].values()), f"nothing pays across a wall, {gain}"
assert abs(rms / np.sqrt(2 / exponent) - 1) < 1e-3, f"RMS angle {rms}"
assert abs(shares[0] - 1) < 1e-9 and shares[80] < shares[60] < shares[30] < 0.9, f"albedo {shares}"
alone, with_barycentres = gain["smooth"]["exact weights"], gain["smooth"]["exact weights, barycentres"]
print(
    f"Expect: W agrees with quadrature to {worst:.0e}; subtraction loses {lost} of {count} thin strata, the other form "
    f"none; exact weights alone gain {alone:.2f}-fold, with barycentres {with_barycentres:.1f}-fold, and across a wall "
    f"{gain['silhouette']['exact weights, barycentres']:.1f}-fold; in BRDF units a white world fades from "
    f"{shares[0]:.3f} to {shares[80]:.3f}, where an average stays 1."
)
