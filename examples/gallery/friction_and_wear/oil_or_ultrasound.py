"""Oil or ultrasound

Friction over pressure, dry and with a boundary lubricant, still and vibrated, for assumed coefficients. The
lubricant helps where asperities carry little of the load; vibration helps at every pressure.
"""

import matplotlib.pyplot as plt
import numpy as np

from sonolube.figure import LINES, publication_style
from sonolube.models import friction

oil = friction.BoundaryLubricant(film_coefficient=0.08, full_asperity_pressure=10e6)
pressure = np.geomspace(0.1e6, 50e6, 200)
found = friction.lubrication_coefficients(oil, friction_coefficient=0.34, friction_ratio=0.4, nominal_pressure=pressure)
labels = {"dry": "dry", "ultrasonic": "vibration", "lubricant": "lubricant", "combined": "both"}

with publication_style():
    figure, axes = plt.subplots(figsize=(4.4, 3.2))
    for style, (name, label) in zip(LINES, labels.items(), strict=False):
        axes.semilogx(
            1e-6 * pressure, np.broadcast_to(getattr(found, name), pressure.shape), linestyle=style, label=label
        )
    axes.set(xlabel="Nominal pressure [MPa]", ylabel="Coefficient of friction [-]", ylim=(0, None))
    axes.legend(ncols=2)

if __name__ == "__main__":
    figure.savefig("oil-or-ultrasound.png", dpi=150)
