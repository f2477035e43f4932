from .collar import (
    ASSUMED_RANGES as ASSUMED_RANGES,
    COLLAR_DIMENSION_SOURCES as COLLAR_DIMENSION_SOURCES,
    FINAL_COLLAR as FINAL_COLLAR,
    FIRST_COLLAR as FIRST_COLLAR,
    NOMINAL_COLLAR as NOMINAL_COLLAR,
    THIN_HEXAGON_COLLAR as THIN_HEXAGON_COLLAR,
    THIN_RING_COLLAR as THIN_RING_COLLAR,
    Collar as Collar,
    Outline as Outline,
    collar_geometry as collar_geometry,
    dimension_names as dimension_names,
)
from .collar_analysis import (
    BoreMotion as BoreMotion,
    CollarModes as CollarModes,
    Parity as Parity,
    bore_motion as bore_motion,
    collar_media as collar_media,
    collar_model as collar_model,
    collar_modes as collar_modes,
    reduced_collar_model as reduced_collar_model,
)
from .collar_tuning import (
    Resonance as Resonance,
    main_resonance as main_resonance,
    resonances_in_range as resonances_in_range,
    spurious_coupling_ratio as spurious_coupling_ratio,
    tuned_collar as tuned_collar,
)
from .horn import (
    POISSON_HORN_DIMENSIONS as POISSON_HORN_DIMENSIONS,
    POISSON_HORN_SOLIDS as POISSON_HORN_SOLIDS,
    poisson_horn as poisson_horn,
)
from .transducers import (
    COLLAR_DIMENSIONS as COLLAR_DIMENSIONS,
    CUTTER_HEAD_DIMENSIONS as CUTTER_HEAD_DIMENSIONS,
    DONG_2015_TRANSDUCERS as DONG_2015_TRANSDUCERS,
    TRIBOMETER_ACTUATOR_DIMENSIONS as TRIBOMETER_ACTUATOR_DIMENSIONS,
    collar_element as collar_element,
    cutter_head as cutter_head,
    tribometer_actuator as tribometer_actuator,
)
