"""Notebook of a designer: a titanium horn, its stress, impedance and friction."""

# %% [markdown]
# # A 20 kHz titanium horn of gain 3
#
# For the designer of a horn: its length by finite elements, its peak stress at 20 µm,
# the impedance of the horn on a transducer, and the friction of its tip on steel.
# Needs `pip install netgen-mesher`.

# %%
import matplotlib.pyplot as plt
import numpy as np

import sonolube as sl
from sonolube.charts import draw_chart
from sonolube.design.horns.shapes import horn_body
from sonolube.design.horns.tuning import amplitude_limits, horn_axis_chart, tuned_horn
from sonolube.facts.materials import material
from sonolube.figure import publication_style, shown_in_notebooks
from sonolube.models import fem

titanium = material("titanium_6al4v")
amplitude = 20e-6

# %% [markdown]
# ## Length, gain and stress
#
# An exponential horn has the gain of the ratio of its end diameters. Its length is
# tuned until the first axial mode is at 20 kHz, to 1 %.

# %%
wave_speed = np.sqrt(titanium.value("youngs_modulus") / titanium.value("density"))
body = horn_body(
    "exponential_horn",
    frequency=20e3,
    wave_speed=wave_speed,
    sizes={"radius": 20e-3, "end_radius": 6.6e-3},
)
horn = tuned_horn(
    body,
    medium=fem.medium_from_material(titanium),
    frequency=20e3,
    relative_tolerance=0.01,
)
print(f"length             {1e3 * horn.tuned.length:.1f} mm")
print(f"gain               {horn.displacement_gain:.2f}")
print(
    f"peak stress        {1e-6 * horn.stress_per_displacement * amplitude:.0f} MPa at 20 um"
)
for strength, limit in amplitude_limits(horn, material=titanium).items():
    print(f"{strength:18s} {1e6 * limit:.0f} um")

# %%
with publication_style():
    figure = draw_chart(horn_axis_chart(horn))
shown_in_notebooks(figure)

# %% [markdown]
# The node is where a flange may hold the horn. The peak stress lies beyond it, and
# far below the fatigue strength.
#
# ## Impedance
#
# The horn on a half-wave transducer of four rings of PZT-4 between titanium masses,
# from a reduced model of 16 modes.

# %%
tip = fem.exponential_horn(radius=20e-3, end_radius=6.6e-3, length=horn.tuned.length)
bodies = fem.stack_bodies(
    outer_radius=20e-3,
    inner_radius=7e-3,
    length=20e-3,
    rod_radius=5e-3,
    back_length=46e-3,
    front_length=45e-3,
    tip=tip,
)
transducer = fem.stack_from_bodies(
    bodies, stack_layers=4, ceramic="pzt4", metal="titanium_6al4v"
)
mesh = fem.generate_mesh(transducer.geometry, element_size=15e-3)
model = fem.reduce_model(transducer.model(mesh), count=16, outputs=transducer.outputs)
frequency = np.linspace(17e3, 24e3, 2001)
response = fem.harmonic_response(model, frequency=frequency)
impedance = 1 / response.admittance
per_volt = np.abs(response.displacement_per_volt[model.outputs.index("tip")])
best = per_volt.argmax()
voltage = amplitude / per_volt[best]
print(
    f"resonance          {1e-3 * frequency[best]:.2f} kHz, {abs(impedance[best]):.0f} ohm"
)
print(
    f"20 um take         {voltage:.0f} V and {voltage**2 / 2 * response.admittance[best].real:.0f} W"
)

# %%
with publication_style():
    figure, (above, below) = plt.subplots(2, 1, figsize=(4.4, 3.8), sharex=True)
    above.semilogy(1e-3 * frequency, np.abs(impedance))
    above.set(ylabel="Impedance [Ω]")
    below.semilogy(1e-3 * frequency, 1e6 * per_volt)
    below.set(xlabel="Frequency [kHz]", ylabel="Tip [µm/V]")
shown_in_notebooks(figure)

# %% [markdown]
# The losses are those assumed of the materials; joints add to them, so that the
# voltage is a lower bound.
#
# ## Friction of the tip
#
# The tip as a flat pin of 6 mm on stainless steel. An amplitude of 20 µm lies beyond
# every published test, and the answer says so.

# %%
rig = sl.new(
    pin="titanium_6al4v",
    disc="304",
    load="50 N",
    speed="0.5 m/s",
    frequency="20 kHz",
    amplitude="20 um",
    shape="flat 6mm",
).rig
sl.predict(rig)
