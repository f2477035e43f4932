"""How far apart two rough surfaces stand under load, by each asperity law and height distribution.

Run: python examples/contact_of_two_surfaces.py
"""

from sonolube.models.contact import (
    ASPERITY_LAWS,
    HEIGHT_DISTRIBUTIONS,
    ElasticBody,
    RoughContact,
    contact_pair,
    real_contact_area,
    separation,
)
from sonolube.models.surfaces import Roughness
from sonolube.text.units import format_si

steel = ElasticBody(youngs_modulus=200e9, poisson_ratio=0.29)
aluminium = ElasticBody(youngs_modulus=73e9, poisson_ratio=0.33)
pair = contact_pair(softer=aluminium, harder=steel, yield_strength=410e6)
roughness = Roughness(rms_height=0.6e-6, summit_radius=10e-6, summit_density=8e9)

lines = [f"{'asperities':<14}{'heights':<14}{'separation':<14}real area under 10 N on 1 cm2"]
for law in ASPERITY_LAWS.values():
    for heights in HEIGHT_DISTRIBUTIONS.values():
        contact = RoughContact(roughness=roughness, pair=pair, nominal_area=1e-4, heights=heights, asperity=law)
        gap = float(separation(contact, normal_load=10.0))
        area = float(real_contact_area(contact, separation=gap))
        lines.append(f"{law.name:<14}{heights.name:<14}{format_si(gap, 'm'):<14}{format_si(area, 'm2')}")
print("\n".join(lines))
