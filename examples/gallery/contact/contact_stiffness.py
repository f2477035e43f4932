"""Stiffness of a rough contact

Normal and tangential stiffness of the reference tribometer's contact over the load. The normal stiffness of a
rough contact with exponential heights is the load over a length, so that the contact stiffens as it is loaded.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import sonolube as sl
from sonolube.figure import publication_style
from sonolube.models import contact

rig = sl.read_rig(Path(__file__).parents[2] / "rigs" / "tribometer.toml")
load = np.geomspace(0.3, 30, 40)
gap = contact.separation(rig.contact, normal_load=load)
normal = contact.normal_stiffness(rig.contact, separation=gap)
tangential = contact.mindlin_tangential_stiffness(rig.contact, separation=gap)

with publication_style():
    figure, axes = plt.subplots(figsize=(4.4, 3.2))
    axes.loglog(load, 1e-6 * normal, label="normal")
    axes.loglog(load, 1e-6 * tangential, linestyle="--", label="tangential (Mindlin)")
    axes.axvline(rig.normal_load, color="0.5", linestyle=":")
    axes.annotate("load of the tests", (rig.normal_load, 1e-6 * normal[0]), xytext=(4, 0), textcoords="offset points")
    axes.set(xlabel="Normal load [N]", ylabel="Contact stiffness [N/µm]")
    axes.legend()

if __name__ == "__main__":
    figure.savefig("contact-stiffness.png", dpi=150)
