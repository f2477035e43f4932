"""Part of the time in which a drill cuts that vibrates along its axis, over amplitude and turns, as a figure.

Run: python examples/vibrated_drilling.py [FOLDER]

Two edges, 0.05 mm each per turn, 10 mm, clearance angle 10 degrees: chosen. Motion alone, compared with no experiment.
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from sonolube.facts.metrics import peak_vibration_velocity
from sonolube.figure import LINES, publication_style, write_figure
from sonolube.models.friction import feed_contact_fraction

feed, edges, turns, frequency = 50e-6, 2, 1000 / 60, 50.0  # m, -, 1/s, Hz: 1.5 waves per edge
speed = np.pi * 10e-3 * turns
for name, f, a in (("slow", frequency, 40e-6), ("ultrasonic", 20e3, 10e-6)):
    part = feed_contact_fraction(feed_per_edge=feed, vibration_amplitude=a, phase_per_edge=np.pi)
    slope = np.degrees(np.arctan(peak_vibration_velocity(frequency=f, vibration_amplitude=a) / speed))
    flank = "clear" if slope < 10 else "presses on the work"
    print(f"{name:10} {1e6 * a:2.0f} um at {f:5.0f} Hz  cuts for {100 * part:3.0f} %  {slope:4.1f} deg, flank {flank}")

with publication_style():
    figure, (left, right) = plt.subplots(1, 2, figsize=(6.6, 2.9), layout="constrained")
    amplitude = np.linspace(0, 2, 400)
    for line, waves in zip(LINES, (1.5, 1.25, 1.1), strict=False):
        phase = 2 * np.pi * waves
        part = feed_contact_fraction(feed_per_edge=1.0, vibration_amplitude=amplitude, phase_per_edge=phase)
        left.plot(amplitude, part, linestyle=line, label=f"{waves} waves per edge")
    left.set(xlabel="Amplitude over feed per edge [-]", ylabel="Part of the time in contact [-]", ylim=(0, 1.05))
    left.legend(loc="lower left")
    waves = frequency / (edges * np.linspace(600, 1500, 2000) / 60)
    for line, size in zip(LINES, (30e-6, 50e-6, 100e-6), strict=False):
        part = feed_contact_fraction(feed_per_edge=feed, vibration_amplitude=size, phase_per_edge=2 * np.pi * waves)
        right.plot(60 * frequency / (edges * waves), part, linestyle=line, label=f"{1e6 * size:.0f} µm")
    right.set(xlabel="Turns per minute", ylim=(0, 1.05), title="50 Hz, 0.05 mm per edge")
    right.legend(loc="lower left")
folder = Path(sys.argv[1] if len(sys.argv) > 1 else "out")
print(*write_figure(figure, folder=folder, name="vibrated_drilling"), sep="\n")
