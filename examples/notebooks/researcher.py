"""Notebook of a researcher: own runs against every model, and the test to make next."""

# %% [markdown]
# # Own runs against the models
#
# For a researcher with a table of runs: which models predict runs that they have not
# seen, whether the ranking is decided, and what to measure next.

# %%
import numpy as np

import sonolube as sl

rig = sl.read_rig("../rigs/tribometer.toml")
runs = sl.read_runs("../tribometer-runs.csv")
for volts, speed, force, still in zip(
    runs.voltage_peak_to_peak.values,
    runs.sliding_speed.values,
    runs.friction_force.values,
    runs.intrinsic_friction_force.values,
    strict=True,
):
    print(f"{volts:3.0f} V   {1e3 * speed:3.0f} mm/s   {force:.2f} N of {still:.2f} N")

# %% [markdown]
# ## Ranking
#
# Each model is fitted to all conditions but one and predicts the one left out. A
# model that wins by this has not won by its number of parameters.

# %%
answer = sl.fit(runs, rig=rig)
fit = answer.fit
for model in fit.models[:5]:
    print(
        f"{model.name:38s} rms of the fit {model.rms_fit:.3f}, of unseen conditions {model.rms_unseen:.3f}"
    )
print(f"mean of the other conditions: {fit.rms_of_mean:.3f}")
print(fit.verdict)

# %%
sl.plot(answer)

# %% [markdown]
# ## Next
#
# Where the best models disagree most is where the next run tells most.

# %%
following = fit.next_conditions[0]
print(
    f"{following.first} says {following.first_ratio:.2f}, {following.second} says {following.second_ratio:.2f}"
)
print(following.condition.settings)

# %% [markdown]
# ## Prediction with these runs
#
# The same runs narrow the prediction of the rig.

# %%
for label, known in (("published tests alone", None), ("with these runs", runs)):
    low, high = np.quantile(sl.predict(rig, runs=known)["friction_ratio"], [0.1, 0.9])
    print(f"{label:22s} friction ratio {low:.2f} to {high:.2f} (80 %)")

# %%
sl.plot(sl.predict(rig, runs=runs))
