"""Flash temperature over speed

Peak temperature rise of a contact spot of 1 mm under 5 N and a friction coefficient of 0.34, for a steel pin on
three discs. A disc that conducts well takes the heat away.
"""

import matplotlib.pyplot as plt
import numpy as np

from sonolube.figure import LINES, publication_style
from sonolube.models import thermal
from sonolube.rig.contact_temperature import thermal_solid

speed = np.geomspace(0.01, 5, 40)
spot = thermal.EllipticSource(half_length=0.5e-3, half_width=0.5e-3)
pin = thermal_solid("stainless_steel_304")
with publication_style():
    figure, axes = plt.subplots(figsize=(4.4, 3.2))
    for style, name in zip(LINES, ("stainless_steel_304", "brass", "aluminium_2024"), strict=False):
        rise = thermal.contact_rise(pin, thermal_solid(name), spot, heat_rate=0.34 * 5 * speed, sliding_speed=speed)
        axes.loglog(speed, rise.peak_temperature_rise, linestyle=style, label=name.replace("_", " "))
    axes.set(xlabel="Sliding speed [m/s]", ylabel="Peak temperature rise [K]")
    axes.legend(title="Disc")

if __name__ == "__main__":
    figure.savefig("flash-temperature.png", dpi=150)
