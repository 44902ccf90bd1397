# %% [markdown]
# # Honest timings: what K costs
#
# A lobe of K x K directions multiplies whatever a ray costs, and every ray here runs a loop over the points that stand
# for the lights. So time should grow with K squared in both pipelines, above a share that does not depend on the lobe:
# the primary rays and their direct light.
#
# Timings lie easily. These are processor seconds of one thread, not seconds of a clock that others share; a run that
# compiles is not counted; estimators take turns, so that a busy moment falls on all of them; and the least is kept, for
# what a busy machine adds is never negative.

# %%
import time

import matplotlib.pyplot as plt
import numpy as np

import symrender as sr

scene = sr.load("gloss")
ks = (4, 8, 16, 32)
estimators = {
    "jittered": {"symbolic": "none"},
    "strata, exact weights": {"numeric": "none", "weights": "exact"},
    "strata, midpoint weights": {"numeric": "none", "weights": "midpoint"},
}


def render(options, k):
    return sr.render(scene, size=48, lobe=k, aa="none", threads=1, tile=48, **options)


def seconds(options, k):
    begun = time.process_time()
    pair = render(options, k)
    return time.process_time() - begun, pair.ledger.pipelines[0].timing.evaluations


runs = [(name, k) for k in ks for name in estimators]
for name in estimators:
    render(estimators[name], 2)
taken = {run: [] for run in runs}
for _ in range(5):
    for name, k in runs:
        spent, evaluations = seconds(estimators[name], k)
        taken[name, k].append((spent, evaluations))
spent = {run: min(t for t, _ in times) for run, times in taken.items()}
directions = {run: times[0][1] for run, times in taken.items()}

print(f"{'estimator':26} {'K':>3} {'directions':>11} {'seconds':>9} {'ns each':>8}")
for name in estimators:
    for k in ks:
        t, count = spent[name, k], directions[name, k]
        print(f"{name:26} {k:3} {count:11} {t:9.4f} {1e9 * t / count:8.1f}")

# %% [markdown]
# ## What one more direction costs
#
# From the second largest K to the largest only the lobes grow, so the difference of the two times over the difference
# of the directions is the price of one more direction. The last column is the exponent with which time grows in K
# there: two, once the directions outweigh everything else.

# %%
figure, axis = plt.subplots(figsize=(6.4, 3.8), layout="constrained")
price, growth = {}, {}
print(f"{'estimator':26} {'ns a direction':>15} {'exponent of K':>14}")
for name in estimators:
    t = [spent[name, k] for k in ks]
    price[name] = (t[-1] - t[-2]) / (directions[name, ks[-1]] - directions[name, ks[-2]])
    growth[name] = np.log(t[-1] / t[-2]) / np.log(ks[-1] / ks[-2])
    print(f"{name:26} {1e9 * price[name]:15.1f} {growth[name]:14.2f}")
    axis.loglog(ks, t, "o-", label=name)
axis.set(xlabel="K", ylabel="processor seconds", title="Time of one image against K", xticks=ks, xticklabels=ks)
axis.minorticks_off()
axis.legend(fontsize=8)
exact_over_midpoint = price["strata, exact weights"] / price["strata, midpoint weights"]
print(f"\na direction with exact weights over one with midpoint weights: {exact_over_midpoint:.3f}")

# %%
rays = directions["jittered", ks[-1]]
assert all(directions[name, ks[-1]] == rays for name in estimators), "every estimator weighs the same directions"
assert rays == 4 * directions["jittered", ks[-2]] > 0, "directions grow with K squared"
assert all(1 < value < 3 for value in growth.values()), f"time grows with about K squared, {growth}"
assert 0.5 < exact_over_midpoint < 2, f"exact weights cost what midpoint weights do, ratio {exact_over_midpoint}"
print(
    f"Expect: {rays} directions at K = {ks[-1]}; time grows as K^{growth['jittered']:.2f} (jittered) and "
    f"K^{growth['strata, exact weights']:.2f} (strata); exact weights cost {exact_over_midpoint:.2f} times what "
    "midpoint weights cost: they are computed once an image. Which to take is a question of accuracy alone."
)
