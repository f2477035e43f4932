"""Three friction models, one rig

Friction ratio of the reference rig over the sliding speed by models that differ in what one asperity does
within a period. Measurements at several speeds tell them apart.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import sonolube as sl
from sonolube.figure import LINES, publication_style

rig = sl.read_rig(Path(__file__).parents[2] / "rigs" / "power_map.toml")
models = ("asperity_stick_slip", "bristle_with_holder", "kinematic")
speed = np.geomspace(5e-3, 0.5, 25)
over = {"friction.model": list(models), "sliding.sliding_speed": speed}
swept = sl.sweep(rig, over=over)

with publication_style():
    figure, axes = plt.subplots(figsize=(4.4, 3.2))
    for style, model, ratio in zip(LINES, models, swept["friction_ratio"].values, strict=False):
        axes.semilogx(1e3 * speed, ratio, linestyle=style, label=model.replace("_", " "))
    axes.set(xlabel="Sliding speed [mm/s]", ylabel="Friction ratio [-]", ylim=(0, 1.02))
    axes.legend()

if __name__ == "__main__":
    figure.savefig("models-of-friction.png", dpi=150)
