"""Finite elements: bodies, their meshes, natural modes, and piezoelectric response."""

from sonolube.fem.classification import Motion, mode_names, participation
from sonolube.fem.convergence import ConvergedModes, converged_modes, extrapolated
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
from sonolube.fem.mesh import Mesh, box_mesh
from sonolube.fem.meshing import mesh_of
from sonolube.fem.model import Electrodes, FaceSpring, Fixed, Model
from sonolube.fem.modes import NaturalModes, NotConverged, natural_modes, rigid_motions
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
from sonolube.fem.reduction import contact_structure
from sonolube.fem.ritz import Section, annulus, rectangle, ritz_frequencies

__all__ = [
    "PARTS",
    "ConvergedModes",
    "Electrodes",
    "FaceSpring",
    "Fixed",
    "Geometry",
    "HarmonicResponse",
    "Medium",
    "Mesh",
    "MissingPart",
    "Model",
    "Motion",
    "NaturalModes",
    "NotConverged",
    "Output",
    "ReducedModel",
    "Section",
    "Slot",
    "annulus",
    "assembled",
    "block",
    "booster",
    "box_mesh",
    "conical_horn",
    "contact_structure",
    "converged_modes",
    "cylinder",
    "direct_response",
    "exponential_horn",
    "extrapolated",
    "harmonic_response",
    "hexagon",
    "isotropic",
    "medium_of",
    "mesh_of",
    "mode_names",
    "moved",
    "natural_modes",
    "participation",
    "poled",
    "read_step",
    "rectangle",
    "reduced",
    "resonances_of",
    "rigid_motions",
    "ring",
    "ritz_frequencies",
    "stepped_horn",
]
