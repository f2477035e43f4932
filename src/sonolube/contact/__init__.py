"""Contact: from the bodies and their roughness to separation, real area and stiffness."""

from sonolube.contact.asperity import (
    ASPERITY_LAWS,
    AsperityLaw,
    ChangEtsionBogy,
    ElasticAsperity,
    JacksonGreen,
    KogutEtsion,
    PublishedChangEtsionBogy,
    asperity_area,
    asperity_force,
    critical_interference,
)
from sonolube.contact.cube import axial_stiffness, mindlin_stiffness, tangential_stiffness
from sonolube.contact.height_distribution import (
    HEIGHT_DISTRIBUTIONS,
    ExponentialHeights,
    GaussianHeights,
    HeightDistribution,
    height_density,
)
from sonolube.contact.motion import GapMotion, harmonic_motion, load_balanced_motion
from sonolube.contact.pair import ContactPair, ElasticBody, contact_pair, like_bodies_mindlin_ratio
from sonolube.contact.rough import (
    RoughContact,
    contact_count,
    decay_length,
    elastic_area,
    elastic_load_share,
    normal_force,
    normal_stiffness,
    plastic_area,
    plasticity_index,
    real_contact_area,
    separation,
)
from sonolube.contact.validity import contact_doubts, exponential_window

__all__ = [
    "ASPERITY_LAWS",
    "HEIGHT_DISTRIBUTIONS",
    "AsperityLaw",
    "ChangEtsionBogy",
    "ContactPair",
    "ElasticAsperity",
    "ElasticBody",
    "ExponentialHeights",
    "GapMotion",
    "GaussianHeights",
    "HeightDistribution",
    "JacksonGreen",
    "KogutEtsion",
    "PublishedChangEtsionBogy",
    "RoughContact",
    "asperity_area",
    "asperity_force",
    "axial_stiffness",
    "contact_count",
    "contact_doubts",
    "contact_pair",
    "critical_interference",
    "decay_length",
    "elastic_area",
    "elastic_load_share",
    "exponential_window",
    "harmonic_motion",
    "height_density",
    "like_bodies_mindlin_ratio",
    "load_balanced_motion",
    "mindlin_stiffness",
    "normal_force",
    "normal_stiffness",
    "plastic_area",
    "plasticity_index",
    "real_contact_area",
    "separation",
    "tangential_stiffness",
]
