"""Identification: the parameters of a model from what is known of the system outside, caveats and gaps told."""

from sonolube.identification.compatibility import Compatibility, compatibility
from sonolube.identification.fact import Fact, Observe, Relation, misses
from sonolube.identification.identify import identify
from sonolube.identification.pin_on_disc import PinOnDiscTest, observer
from sonolube.identification.posterior import Posterior, posterior
from sonolube.identification.record import Direction, Estimate, Identification, Reading
from sonolube.identification.rig_tables import rig_tables

__all__ = [
    "Compatibility",
    "Direction",
    "Estimate",
    "Fact",
    "Identification",
    "Observe",
    "PinOnDiscTest",
    "Posterior",
    "Reading",
    "Relation",
    "compatibility",
    "identify",
    "misses",
    "observer",
    "posterior",
    "rig_tables",
]
