"""Hardware of the dissertation by finite elements: tribometer actuator, cutter head and collar element."""

from sonolube.dong2015.bore import BoreMotion, bore_motion
from sonolube.dong2015.collar import Collar, Outline, collar_geometry, dimension_names
from sonolube.dong2015.collar_analysis import (
    CollarModes,
    Parity,
    collar_media,
    collar_model,
    collar_modes,
    reduced_collar_model,
)
from sonolube.dong2015.collar_designs import (
    ASSUMED_RANGES,
    COLLAR_DIMENSION_SOURCES,
    FINAL_COLLAR,
    FIRST_COLLAR,
    NOMINAL_COLLAR,
    THIN_HEXAGON_COLLAR,
    THIN_RING_COLLAR,
)
from sonolube.dong2015.collar_tuning import (
    Resonance,
    frequency_sensitivities,
    main_resonance,
    resonances_in_range,
    spurious_coupling_ratio,
    tuned_collar,
)
from sonolube.dong2015.cutter import CUTTER_HEAD_DIMENSIONS, cutter_head
from sonolube.dong2015.transducers import DONG_2015_TRANSDUCERS
from sonolube.dong2015.tribometer import TRIBOMETER_ACTUATOR_DIMENSIONS, tribometer_actuator

__all__ = [
    "ASSUMED_RANGES",
    "COLLAR_DIMENSION_SOURCES",
    "CUTTER_HEAD_DIMENSIONS",
    "DONG_2015_TRANSDUCERS",
    "FINAL_COLLAR",
    "FIRST_COLLAR",
    "NOMINAL_COLLAR",
    "THIN_HEXAGON_COLLAR",
    "THIN_RING_COLLAR",
    "TRIBOMETER_ACTUATOR_DIMENSIONS",
    "BoreMotion",
    "Collar",
    "CollarModes",
    "Outline",
    "Parity",
    "Resonance",
    "bore_motion",
    "collar_geometry",
    "collar_media",
    "collar_model",
    "collar_modes",
    "cutter_head",
    "dimension_names",
    "frequency_sensitivities",
    "main_resonance",
    "reduced_collar_model",
    "resonances_in_range",
    "spurious_coupling_ratio",
    "tribometer_actuator",
    "tuned_collar",
]
