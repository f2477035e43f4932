"""Notebook of three applications: a wire-drawing die, a turning tool and a bronze bush."""

# %% [markdown]
# # Wire drawing, turning and a bronze bush
#
# Three machines in which something slides and may be vibrated. The first two vibrate
# along the sliding and have closed forms; the third vibrates along the normal and is a
# rig file. None is compared with an experiment of its own here: the page *Applications*
# says how far each was tested.

# %%
import matplotlib.pyplot as plt
import numpy as np

import sonolube as sl
from sonolube.facts.materials import material
from sonolube.facts.metrics import peak_vibration_velocity
from sonolube.figure import LINES, publication_style, shown_in_notebooks
from sonolube.models import friction

# %% [markdown]
# ## A die that vibrates along the wire
#
# Dieter's example 19.1: a rod of 10 mm loses 20 % of its section in a die of 12°, with a
# coefficient of friction of 0.09 and a flow stress of 1300 MPa times strain to 0.3.

# %%
flow_stress = 1300e6 * np.log(1 / 0.8) ** 0.3 / 1.3
die = {
    "area_reduction": 0.2,
    "friction_coefficient": 0.09,
    "die_half_angle": np.radians(6),
}
still = friction.drawing_stress(yield_strength=flow_stress, **die)
frictionless = friction.drawing_stress(
    yield_strength=flow_stress, **die | {"friction_coefficient": 0.0}
)
print(f"drawing stress     {1e-6 * still:.1f} MPa; worked solution 240.4 MPa")
print(f"part by friction   {1 - frictionless / still:.0%}")

# %% [markdown]
# A vibration of 10 µm at 20 kHz moves the die faster than the wire for part of each
# period, and friction then pulls the wire along. That is over once the wire is faster
# than the die ever is.

# %%
peak = peak_vibration_velocity(frequency=20e3, vibration_amplitude=10e-6)
speeds = np.array([0.05, 0.2, 0.5, 1.0, 1.2, 3.0])
stresses = friction.vibrated_drawing_stress(
    yield_strength=flow_stress, drawing_speed=speeds, vibration_velocity=peak, **die
)
print(f"critical speed     {peak:.2f} m/s")
for speed, stress in zip(speeds, stresses, strict=True):
    print(f"{speed:4.2f} m/s           {1 - stress / still:4.0%} less")

# %% [markdown]
# The other account of such tests is superposition: a wave in the wire takes its
# amplitude of stress off the mean, while the peak remains. With a travelling wave in
# steel:

# %%
steel = material("steel_1045")
modulus, density = steel.value("youngs_modulus"), steel.value("density")
superposed = friction.superposed_mean_stress(
    yield_strength=still,
    youngs_modulus=modulus,
    strain_amplitude=peak / np.sqrt(modulus / density),
)
print(f"superposition      {1 - superposed / still:4.0%} less, at any speed")

# %% [markdown]
# The two are not added: reversal of friction assumes a rigid wire, superposition a
# frictionless die. Speed tells them apart.
#
# ## A tool that vibrates along the cutting direction
#
# The tool leaves the chip when it moves back faster than the work comes on, and meets
# the chip again where it left it.

# %%
cutting = np.geomspace(0.02, 4, 300)
with publication_style():
    figure, axes = plt.subplots(figsize=(4.4, 3))
    for line, amplitude in zip(LINES, (5e-6, 10e-6, 20e-6), strict=False):
        critical = peak_vibration_velocity(
            frequency=20e3, vibration_amplitude=amplitude
        )
        part = friction.tool_contact_fraction(
            cutting_speed=cutting, vibration_velocity=critical
        )
        label = f"{1e6 * amplitude:.0f} µm"
        axes.semilogx(cutting, part, linestyle=line, label=label)
        print(
            f"{1e6 * amplitude:2.0f} um   cuts always from {60 * critical:.0f} m/min on"
        )
    axes.set(xlabel="Cutting speed [m/s]", ylabel="Part of the time in contact [-]")
    axes.legend(title="20 kHz")
shown_in_notebooks(figure)

# %% [markdown]
# A force that is the same whenever the tool cuts falls on average in this proportion,
# and the spindle's power with it. The rest of the power comes from the actuator: the
# work on a length of chip is what it was.
#
# ## A bronze bush
#
# A bush of 10 mm by 10 mm under 50 N on a ground shaft, vibrated by 2 µm along the load.

# %%
rig = sl.read_rig("../rigs/bronze_bush.toml")
dry = sl.predict(rig)
dry

# %%
sl.plot(dry)

# %% [markdown]
# That is the dry bush. Greased, a coefficient near 0.16 is printed for bronze on steel.
# Whether vibration does anything in the film is not known to this model:
# `sl.predict(rig, lubricant=True)` answers 0 to 100 %. Load sharing alone, with asperities
# that carry all of the load at an assumed 10 MPa:

# %%
sl.regime(rig, film_coefficient=0.16, asperity_pressure="10MPa")
