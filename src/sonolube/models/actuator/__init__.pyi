from .catalogue import (
    ACTUATOR_KINDS as ACTUATOR_KINDS,
    CatalogueActuator as CatalogueActuator,
    catalogue_actuator as catalogue_actuator,
    catalogue_names as catalogue_names,
    catalogue_stack as catalogue_stack,
    read_catalogue as read_catalogue,
)
from .derived_stacks import (
    BoltStresses as BoltStresses,
    FlextensionalActuator as FlextensionalActuator,
    PreloadBolt as PreloadBolt,
    bolt_stresses as bolt_stresses,
    bolted_stack as bolted_stack,
    equivalent_stack as equivalent_stack,
    lever_amplified_stack as lever_amplified_stack,
    tightening_preload as tightening_preload,
)
from .drive import (
    AmplifierRequirements as AmplifierRequirements,
    Drive as Drive,
    amplifier_requirements as amplifier_requirements,
    dissipated_power as dissipated_power,
    linear_amplifier_power as linear_amplifier_power,
    peak_current as peak_current,
    power_factor as power_factor,
)
from .equivalent_circuit import (
    ButterworthVanDyke as ButterworthVanDyke,
    CircuitResonances as CircuitResonances,
    MotionalBranch as MotionalBranch,
    circuit_admittance as circuit_admittance,
    circuit_resonances as circuit_resonances,
)
from .matching import (
    AdmittanceFunction as AdmittanceFunction,
    MatchingNetwork as MatchingNetwork,
    input_admittance as input_admittance,
    l_match as l_match,
    matched_band as matched_band,
    matched_power_factor as matched_power_factor,
    parallel_inductor as parallel_inductor,
    series_inductor as series_inductor,
    voltage_gain as voltage_gain,
)
from .stack import (
    PiezoStack as PiezoStack,
    require_allowed_voltage as require_allowed_voltage,
    stack_caveats as stack_caveats,
    stack_force as stack_force,
)
from .thin_horn import (
    ThinHorn as ThinHorn,
    thin_conical_horn as thin_conical_horn,
    thin_exponential_horn as thin_exponential_horn,
    thin_stepped_horn as thin_stepped_horn,
)
from .waveguide import (
    BarWaveguide as BarWaveguide,
    SurfaceTrajectory as SurfaceTrajectory,
    axial_displacement as axial_displacement,
    free_bar_frequency as free_bar_frequency,
    in_plane_amplitude as in_plane_amplitude,
    normal_amplitude as normal_amplitude,
    normal_displacement as normal_displacement,
    surface_trajectory as surface_trajectory,
)
