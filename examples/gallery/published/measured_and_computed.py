"""Measured and computed, test by test

Every published friction test with vibration normal to the contact, and the ratio that asperity stick-slip gives
for its conditions with one memory length for all.
"""

import matplotlib.pyplot as plt
import numpy as np

from sonolube.figure import publication_style
from sonolube.validation.friction_model_variants import asperity_stick_slip
from sonolube.validation.published_tests import friction_tests

tests = friction_tests()
measured = np.array([test.friction_ratio for test in tests])
predicted = np.array([float(asperity_stick_slip(test, memory_length=1.5e-6)) for test in tests])
places = np.arange(len(tests))
with publication_style():
    figure, axes = plt.subplots(figsize=(5.4, 3.2))
    axes.bar(places - 0.2, measured, width=0.4, label="measured", hatch="//", edgecolor="white")
    axes.bar(places + 0.2, predicted, width=0.4, label="asperity stick-slip, memory length 1.5 µm")
    axes.set(ylabel="Friction ratio [-]", xlabel="Test, letters by rig", ylim=(0, 1.25))
    axes.set_xticks(places, [test.label for test in tests], rotation=90)
    axes.legend()

if __name__ == "__main__":
    figure.savefig("measured-and-computed.png", dpi=150)
