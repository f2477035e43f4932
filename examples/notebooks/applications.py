"""Notebook of applications: die, turning tool, drill, bronze bush, guide, belt and fingertip."""

# %% [markdown]
# # Forming, machining, bearings, guides, belts and fingertips
#
# Machines in which something slides and may be vibrated. Die, turning tool and drill
# vibrate within the plane or along the feed and have closed forms; bush, guide, belt and
# fingertip vibrate along the normal and are rig files. None is compared with an
# experiment of its own here: the page *Applications* says how far each was tested.

# %%
import matplotlib.pyplot as plt
import numpy as np

import sonolube as sl
from sonolube.facts.materials import material
from sonolube.facts.metrics import peak_vibration_velocity
from sonolube.figure import LINES, publication_style, shown_in_notebooks
from sonolube.models import friction
from sonolube.rig import friction_point

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
# ## A drill that vibrates along its axis
#
# An edge leaves the work only where an edge before it has cut deeper, which takes an
# amplitude above half of the feed per edge, and depends on how many waves lie between
# one edge and the next.

# %%
amplitudes = np.linspace(0, 2, 401)
with publication_style():
    figure, axes = plt.subplots(figsize=(4.4, 3))
    for line, waves in zip(LINES, (1.5, 1.25, 1.1), strict=False):
        part = friction.feed_contact_fraction(
            feed_per_edge=1.0,
            vibration_amplitude=amplitudes,
            phase_per_edge=2 * np.pi * waves,
        )
        axes.plot(amplitudes, part, linestyle=line, label=f"{waves}")
        print(
            f"{waves:4} waves per edge   {part[100]:4.0%} at half of the feed per edge"
        )
        print(f"                      {part[200]:4.0%} at one, {part[-1]:4.0%} at two")
    axes.set(xlabel="Amplitude over feed per edge [-]", ylim=(0, 1.05))
    axes.set_ylabel("Part of the time in contact [-]")
    axes.legend(title="Waves per edge")
shown_in_notebooks(figure)

# %% [markdown]
# The chip is on average as thick as without vibration. An ultrasonic drill mostly does
# not do this at all: its flank presses on the work.

# %%
drill = np.pi * 10e-3 * 1000 / 60
for frequency, amplitude in ((50, 40e-6), (20e3, 10e-6)):
    upward = peak_vibration_velocity(frequency=frequency, vibration_amplitude=amplitude)
    steepest = np.degrees(np.arctan(upward / drill))
    print(f"{frequency:5.0f} Hz   the edge moves up to {steepest:4.1f}° off its cut")

# %% [markdown]
# A clearance angle is about 10°.
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

# %% [markdown]
# ## A plastic pad of a guide
#
# A pad of POM on a steel rail, as of a seat rail or a linear guide. The plastic is the
# spring: it bounces on its own elasticity, and slow sliding gains most.


# %%
def ratio(name, **changes):
    """Friction ratio of a rig with some of its entries changed."""
    keys = {
        "speed": "sliding.sliding_speed",
        "amplitude": "vibration.vibration_amplitude",
        "modulus": "contact.softer.youngs_modulus",
        "following": "friction.following_fraction",
    }
    changed = [f"{keys[key]}={value}" for key, value in changes.items()]
    return friction_point(
        sl.read_rig(f"../rigs/{name}.toml", changes=changed)
    ).friction_ratio


def line_over(name, key, values, unit, **changes):
    """Friction ratio over one entry."""
    return [ratio(name, **{key: f"{each}{unit}"}, **changes) for each in values]


speeds, sizes = np.geomspace(1, 200, 40), np.linspace(0.005, 1, 40)
with publication_style():
    figure, (left, right) = plt.subplots(
        1, 2, figsize=(6.6, 2.9), sharey=True, layout="constrained"
    )
    for line, size in zip(LINES, (0.1, 0.2, 0.5), strict=False):
        over = line_over("pom_on_steel", "speed", speeds, "mm/s", amplitude=f"{size}um")
        left.semilogx(speeds, over, linestyle=line, label=f"{size} µm")
    for line, speed in zip(LINES, (1, 20, 50), strict=False):
        over = line_over("pom_on_steel", "amplitude", sizes, "um", speed=f"{speed}mm/s")
        right.plot(sizes, over, linestyle=line, label=f"{speed} mm/s")
    left.set(xlabel="Sliding speed [mm/s]", ylabel="Friction ratio [-]", ylim=(0, 1.05))
    right.set(xlabel="Vibration amplitude [µm]")
    left.legend(title="20 kHz")
    right.legend(title="20 kHz", loc="lower right", bbox_to_anchor=(1, 0.05))
shown_in_notebooks(figure)

# %%
sl.friction("../rigs/pom_on_steel.toml")

# %% [markdown]
# ## A belt over a ring
#
# Polyester webbing over a ring that vibrates as the collar of the dissertation does. Its
# stiffness across the thickness is hardly known, and the answer hangs on it.

# %%
moduli, sizes = np.geomspace(1, 100, 60), np.linspace(0.05, 6, 40)
with publication_style():
    figure, (left, right) = plt.subplots(
        1, 2, figsize=(6.6, 2.9), sharey=True, layout="constrained"
    )
    for line, speed in zip(LINES, (5, 50, 200), strict=False):
        over = line_over(
            "webbing_on_ring", "modulus", moduli, "MPa", speed=f"{speed}mm/s"
        )
        left.semilogx(moduli, over, linestyle=line, label=f"{speed} mm/s")
    for line, modulus in zip(LINES, (10, 30, 100), strict=False):
        over = line_over(
            "webbing_on_ring", "amplitude", sizes, "um", modulus=f"{modulus}MPa"
        )
        right.plot(sizes, over, linestyle=line, label=f"{modulus} MPa")
    left.set(xlabel="Modulus across the webbing [MPa]", ylim=(0, 1.05))
    left.set_ylabel("Friction ratio [-]")
    right.set(xlabel="Vibration amplitude [µm]")
    left.legend(title="2.17 µm")
    right.legend(title="50 mm/s")
shown_in_notebooks(figure)

# %% [markdown]
# ## A finger on a vibrating plate
#
# Film of air and asperities of the skin share the load, and friction is that of the
# asperities. What the finger follows of the motion makes no film.

# %%
sizes = np.linspace(0.02, 4, 60)
with publication_style():
    figure, axes = plt.subplots(figsize=(4.4, 3))
    for line, part in zip(LINES, (0, 0.5, 0.8), strict=False):
        over = line_over("finger_on_glass", "amplitude", sizes, "um", following=part)
        axes.plot(sizes, over, linestyle=line, label=f"{part:.0%}")
    axes.set(xlabel="Vibration amplitude [µm]", ylim=(0, 1.05))
    axes.set_ylabel("Friction ratio, share of asperities [-]")
    axes.legend(title="Followed by the finger")
shown_in_notebooks(figure)

# %%
sl.friction("../rigs/finger_on_glass.toml")
