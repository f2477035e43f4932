"""Impedance of a transducer

A spectrum with 0.5 % of noise and the equivalent circuit fitted to it: resonance, coupling and quality with
their intervals from one measurement of the analyser.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import sonolube as sl
from sonolube.models.actuator import ButterworthVanDyke, MotionalBranch, circuit_admittance

branch = MotionalBranch(resistance=22.0, inductance=1.67e-3, capacitance=636e-12)
frequency = np.linspace(120e3, 220e3, 401)
z = 1 / circuit_admittance(ButterworthVanDyke(parallel_capacitance=1.6e-9, branches=(branch,)), frequency=frequency)
z *= np.exp(0.005 * np.random.default_rng(1).standard_normal(z.size))
with TemporaryDirectory() as folder:
    path = Path(folder) / "transducer.csv"
    table = np.stack([frequency, np.abs(z), np.degrees(np.angle(z))], 1)
    np.savetxt(path, table, delimiter=",", header="frequency (Hz),|Z| (ohm),phase (deg)", comments="")
    figure = sl.measure.impedance(path).plot()

if __name__ == "__main__":
    figure.savefig("impedance-spectrum.png", dpi=150)
