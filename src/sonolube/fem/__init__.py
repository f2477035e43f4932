"""Finite elements: bodies, their meshes, natural modes, and piezoelectric response."""

from sonolube.fem.actuators import (
    CUTTER_HEAD,
    TRANSDUCERS,
    TRIBOMETER_ACTUATOR,
    acorn_nut,
    cutter_disc,
    cutter_head,
    tribometer_actuator,
)
from sonolube.fem.classification import Motion, mode_names, participation
from sonolube.fem.convergence import ConvergedModes, converged_modes, extrapolated
from sonolube.fem.fields import at_points, equivalent_stress, stresses
from sonolube.fem.forced import forced_motion
from sonolube.fem.geometry import Geometry, assembled, moved, read_step
from sonolube.fem.harmonic import (
    HarmonicResponse,
    Output,
    ReducedModel,
    direct_response,
    harmonic_response,
    reduced,
    resonances_of,
)
from sonolube.fem.kernel import MissingPart
from sonolube.fem.medium import Medium, isotropic, medium_of, poled
from sonolube.fem.mesh import Mesh, box_mesh, flat_triangles
from sonolube.fem.meshing import mesh_of
from sonolube.fem.model import Electrodes, FaceSpring, Fixed, Model
from sonolube.fem.modes import NaturalModes, NotConverged, natural_modes, rigid_motions
from sonolube.fem.orders import carried, of_order
from sonolube.fem.parts import (
    PARTS,
    Slot,
    block,
    booster,
    conical_horn,
    cylinder,
    exponential_horn,
    hexagon,
    ring,
    stepped_horn,
)
from sonolube.fem.patches import edge_nodes, reshaped, with_patch
from sonolube.fem.port import ElectricalMode, Port, converged_port, coupled_resonances
from sonolube.fem.reduction import contact_structure, under_free_body
from sonolube.fem.ritz import Section, annulus, rectangle, ritz_frequencies
from sonolube.fem.stack import layered, stack_ceramic
from sonolube.fem.surface_loci import LocusEllipse, locus_ellipse
from sonolube.fem.transducers import Dimension, Transducer, poled_part, stack
from sonolube.fem.trimming import trimmed
from sonolube.fem.tuning import NamedMode, TunedMode, loaded_frequencies, named_mode, tuned_mode
from sonolube.fem.vtu import vtu

__all__ = [
    "CUTTER_HEAD",
    "PARTS",
    "TRANSDUCERS",
    "TRIBOMETER_ACTUATOR",
    "ConvergedModes",
    "Dimension",
    "ElectricalMode",
    "Electrodes",
    "FaceSpring",
    "Fixed",
    "Geometry",
    "HarmonicResponse",
    "LocusEllipse",
    "Medium",
    "Mesh",
    "MissingPart",
    "Model",
    "Motion",
    "NamedMode",
    "NaturalModes",
    "NotConverged",
    "Output",
    "Port",
    "ReducedModel",
    "Section",
    "Slot",
    "Transducer",
    "TunedMode",
    "acorn_nut",
    "annulus",
    "assembled",
    "at_points",
    "block",
    "booster",
    "box_mesh",
    "carried",
    "conical_horn",
    "contact_structure",
    "converged_modes",
    "converged_port",
    "coupled_resonances",
    "cutter_disc",
    "cutter_head",
    "cylinder",
    "direct_response",
    "edge_nodes",
    "equivalent_stress",
    "exponential_horn",
    "extrapolated",
    "flat_triangles",
    "forced_motion",
    "harmonic_response",
    "hexagon",
    "isotropic",
    "layered",
    "loaded_frequencies",
    "locus_ellipse",
    "medium_of",
    "mesh_of",
    "mode_names",
    "moved",
    "named_mode",
    "natural_modes",
    "of_order",
    "participation",
    "poled",
    "poled_part",
    "read_step",
    "rectangle",
    "reduced",
    "reshaped",
    "resonances_of",
    "rigid_motions",
    "ring",
    "ritz_frequencies",
    "stack",
    "stack_ceramic",
    "stepped_horn",
    "stresses",
    "tribometer_actuator",
    "trimmed",
    "tuned_mode",
    "under_free_body",
    "vtu",
    "with_patch",
]
