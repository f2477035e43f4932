"""Finite elements: bodies, their meshes, natural modes, and piezoelectric response."""

from sonolube.fem.classification import Motion, mode_names, participation
from sonolube.fem.electromechanical_model import ElectricalMode, Port, converged_port, coupled_resonances
from sonolube.fem.parts.basic import (
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
from sonolube.fem.parts.stack import layered, stack_ceramic
from sonolube.fem.parts.transducers import TRANSDUCERS, Dimension, Transducer, poled_part, stack
from sonolube.fem.parts.trimming import trimmed
from sonolube.fem.ritz import Section, annulus, rectangle, ritz_frequencies
from sonolube.fem.solver.cad import MissingPart
from sonolube.fem.solver.convergence import ConvergedModes, converged_modes, extrapolated
from sonolube.fem.solver.fields import at_points, equivalent_stress, stresses
from sonolube.fem.solver.forced import forced_motion
from sonolube.fem.solver.geometry import Geometry, assembled, moved, read_step
from sonolube.fem.solver.harmonic import (
    HarmonicResponse,
    Output,
    ReducedModel,
    direct_response,
    harmonic_response,
    reduced,
    resonances_of,
)
from sonolube.fem.solver.medium import Medium, isotropic, medium_of, poled
from sonolube.fem.solver.mesh import Mesh, box_mesh, flat_triangles
from sonolube.fem.solver.meshing import mesh_of
from sonolube.fem.solver.model import Electrodes, FaceSpring, Fixed, Model
from sonolube.fem.solver.modes import NaturalModes, NotConverged, natural_modes, rigid_motions
from sonolube.fem.solver.orders import carried, of_order
from sonolube.fem.solver.patches import edge_nodes, reshaped, with_patch
from sonolube.fem.solver.reduction import contact_structure, under_free_body
from sonolube.fem.surface_loci import LocusEllipse, locus_ellipse
from sonolube.fem.tuning import NamedMode, TunedMode, loaded_frequencies, named_mode, tuned_mode
from sonolube.fem.vtu import vtu

__all__ = [
    "PARTS",
    "TRANSDUCERS",
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
    "trimmed",
    "tuned_mode",
    "under_free_body",
    "vtu",
    "with_patch",
]
