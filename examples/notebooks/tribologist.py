"""Notebook of a tribologist: from recordings to a prediction."""

# %% [markdown]
# # From recordings to a prediction
#
# For a tribologist with a pin-on-disc rig: what to expect before the first test, what
# two recordings say, and what to expect after three runs. The recordings are made by
# a formula here; with your own, change the paths.

# %%
from pathlib import Path
from tempfile import mkdtemp

import numpy as np

import sonolube as sl

folder = Path(mkdtemp())

# %% [markdown]
# ## Before the first test
#
# Materials, load, speed, vibration and finish are enough for a rig. What nobody
# measured has a distribution.

# %%
rig = sl.new(
    pin="brass",
    disc="304",
    load="5 N",
    speed="0.2 m/s",
    frequency="20 kHz",
    amplitude="3 um",
    finish="ground N6",
).rig
before = sl.predict(rig)
before

# %%
sl.plot(before)

# %% [markdown]
# The bands hold what the published tests make credible. They are wide, because rigs
# differ.
#
# ## Two recordings
#
# Friction without and with vibration, a minute each.

# %%
rng = np.random.default_rng(1)
time = np.arange(0, 60, 0.02)


def record(name: str, level: float) -> Path:
    """Write a recording with running-in, wobble of the disc and noise."""
    force = level * (1 + 0.4 * np.exp(-time / 8)) + 0.04 * np.sin(2 * np.pi * time)
    table = np.stack([time, force + 0.03 * rng.standard_normal(time.size)], 1)
    np.savetxt(
        folder / name,
        table,
        delimiter=",",
        header="time (s),friction_force (N)",
        comments="",
    )
    return folder / name


still = sl.measure.friction(record("off.csv", 1.75), sliding_speed=0.2)
vibrated = sl.measure.friction(record("on.csv", 0.95), sliding_speed=0.2)
vibrated

# %%
sl.plot(vibrated)

# %% [markdown]
# ## After three runs
#
# A table of runs holds one line a run; the page Commands of the documentation lists
# its columns. `predict` narrows its intervals by it.

# %%
(folder / "runs.csv").write_text(
    """vibration_amplitude [um],sliding_speed [mm/s],friction_force [N],intrinsic_friction_force [N]
3,200,0.95,1.75
2,200,1.22,1.74
3,400,1.31,1.72
"""
)
after = sl.predict(rig, runs=sl.read_runs(folder / "runs.csv"))
for label, each in (("before", before), ("after", after)):
    low, high = each["friction_ratio"].quantile([0.1, 0.9]).values
    print(f"{label:7s} friction ratio {low:.2f} to {high:.2f} (80 %)")

# %%
sl.plot(after)
