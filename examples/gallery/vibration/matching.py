"""Matching the amplifier

Power factor of a transducer about its resonance, alone and with the inductor that cancels its capacitance. The
inductor brings the power factor to one at resonance, in a narrow band.
"""

import matplotlib.pyplot as plt
import numpy as np

from sonolube.figure import publication_style
from sonolube.models import actuator

branch = actuator.MotionalBranch(resistance=400.0, inductance=60e-3, capacitance=1.05e-9)
circuit = actuator.ButterworthVanDyke(parallel_capacitance=20e-9, branches=(branch,))
resonance = actuator.circuit_resonances(circuit).series_frequency[0]
frequency = np.linspace(0.95, 1.05, 600) * resonance
at_resonance = actuator.circuit_admittance(circuit, frequency=resonance)
network = actuator.parallel_inductor(admittance=at_resonance, frequency=resonance)
admittance = actuator.circuit_admittance(circuit, frequency=frequency)
alone = np.cos(np.angle(admittance))
matched = actuator.matched_power_factor(network, admittance=admittance, frequency=frequency)
with publication_style():
    figure, axes = plt.subplots(figsize=(4.4, 3.2))
    axes.plot(1e-3 * frequency, alone, "--", label="alone")
    axes.plot(1e-3 * frequency, matched, label="with parallel inductor")
    axes.set(xlabel="Frequency [kHz]", ylabel="Power factor [-]", ylim=(0, 1.05))
    axes.legend()

if __name__ == "__main__":
    figure.savefig("matching.png", dpi=150)
