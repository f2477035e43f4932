"""Real contact area over load

Steel on aluminium: the area that carries the load is at most 1.5 thousandths of the nominal area, and grows
almost in proportion to the load. The laws of the single asperity differ by how the plastic ones carry on.
"""

import matplotlib.pyplot as plt
import numpy as np

import sonolube.models.contact as contact
from sonolube.figure import LINES, publication_style
from sonolube.models.surfaces import Roughness

steel = contact.ElasticBody(youngs_modulus=200e9, poisson_ratio=0.29)
aluminium = contact.ElasticBody(youngs_modulus=73e9, poisson_ratio=0.33)
pair = contact.contact_pair(softer=aluminium, harder=steel, yield_strength=410e6)
roughness = Roughness(rms_height=0.6e-6, summit_radius=10e-6, summit_density=8e9)
load = np.geomspace(1, 100, 30)  # N

with publication_style():
    figure, axes = plt.subplots(figsize=(4.4, 3.2))
    for style, name in zip(LINES, ("elastic", "chang_etsion_bogy", "kogut_etsion", "jackson_green"), strict=False):
        rough = contact.RoughContact(
            roughness=roughness,
            pair=pair,
            nominal_area=1e-4,
            heights=contact.GaussianHeights(),
            asperity=contact.ASPERITY_LAWS[name],
        )
        gap = contact.separation(rough, normal_load=load)
        area = contact.real_contact_area(rough, separation=gap)
        axes.loglog(load, area / 1e-4, linestyle=style, label=name.replace("_", " "))
    axes.set(xlabel="Normal load on 1 cm² [N]", ylabel="Real over nominal area [-]")
    axes.legend()

if __name__ == "__main__":
    figure.savefig("real-contact-area.png", dpi=150)
