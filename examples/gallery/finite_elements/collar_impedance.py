"""Impedance of the collar

The collar with variable friction (D 5) by finite elements: impedance with its top closed and open, from a
reduced model of twelve modes. Opening the top lowers the resonance.
"""

import matplotlib.pyplot as plt
import numpy as np

from dong2015.hardware.collar import FINAL_COLLAR
from dong2015.hardware.collar_analysis import reduced_collar_model
from sonolube.figure import publication_style
from sonolube.models.fem import harmonic_response

frequency = np.linspace(15e3, 45e3, 1500)
with publication_style():
    figure, axes = plt.subplots(figsize=(4.4, 3.2))
    for style, label, is_open in (("-", "top closed", False), ("--", "top open", True)):
        model = reduced_collar_model(FINAL_COLLAR, open_top=is_open)
        admittance = harmonic_response(model, frequency=frequency).admittance
        axes.semilogy(1e-3 * frequency, np.abs(1 / admittance), style, label=label)
    axes.set(xlabel="Frequency [kHz]", ylabel="Impedance [Ω]")
    axes.legend()

if __name__ == "__main__":
    figure.savefig("collar-impedance.png", dpi=150)
