"""Friction of an example rig against the amplitude of its vibration, as a figure.

Run: python examples/friction_against_amplitude.py [FOLDER]
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from sonolube.figure import publication_style, write_figure
from sonolube.models.contact import separation
from sonolube.models.friction import dong_2015_half_period_ratio
from sonolube.rig import read_rig
from sonolube.vocabulary import quantity

rig = read_rig(Path(__file__).parent / "rigs" / "tribometer.toml")
gap = separation(rig.contact, normal_load=rig.normal_load)
amplitudes = np.linspace(0, 0.5 * gap, 200)
ratios = dong_2015_half_period_ratio(rig.contact, normal_load=rig.normal_load, vibration_amplitude=amplitudes)

with publication_style():
    figure, axes = plt.subplots(figsize=(4.5, 3))
    axes.plot(1e6 * amplitudes, ratios, label=f"{rig.title}\n{rig.normal_load:g} N, cube, D 3.15")
    axes.set(xlabel=quantity("vibration_amplitude").meaning + " [um]", ylabel=quantity("friction_ratio").axis_label)
    axes.set_ylim(0, 1)
    axes.legend()

folder = Path(sys.argv[1] if len(sys.argv) > 1 else "out")
print(*write_figure(figure, folder=folder, name="friction_against_amplitude"), sep="\n")
