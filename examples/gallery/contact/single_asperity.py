"""Force on one asperity

Mean pressure over the yield strength as one asperity is pressed flat. At first yield the law of Chang, Etsion
and Bogy jumps to a constant pressure; those of Kogut and Etsion and of Jackson and Green follow the growth of
the plastic zone.
"""

import matplotlib.pyplot as plt
import numpy as np

import sonolube.models.contact as contact
from sonolube.figure import LINES, publication_style

pair = contact.ContactPair(effective_modulus=59.6e9, poisson_ratio=0.33, yield_strength=410e6, mindlin_ratio=0.8)
radius = 10e-6  # m
onset = contact.critical_interference(contact.KogutEtsion(), pair, summit_radius=radius)
interference = np.geomspace(0.1, 100, 300)  # over that of first yield

with publication_style():
    figure, axes = plt.subplots(figsize=(4.4, 3.2))
    for style, name in zip(LINES, ("elastic", "chang_etsion_bogy", "kogut_etsion", "jackson_green"), strict=False):
        law = contact.ASPERITY_LAWS[name]
        force = contact.asperity_force(law, pair, summit_radius=radius, interference=interference * onset)
        area = contact.asperity_area(law, pair, summit_radius=radius, interference=interference * onset)
        axes.loglog(interference, force / area / 410e6, linestyle=style, label=name.replace("_", " "))
    axes.set(xlabel="Interference over that of first yield [-]", ylabel="Mean pressure over yield strength [-]")
    axes.set_yticks([0.5, 1, 2, 5, 10], ["0.5", "1", "2", "5", "10"])
    axes.legend()

if __name__ == "__main__":
    figure.savefig("single-asperity.png", dpi=150)
