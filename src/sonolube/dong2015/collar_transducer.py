"""Collar element of D 4.5 as a transducer: a quarter of the final design, with its electrodes and outputs."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Final

from sonolube.dong2015.collar import collar_geometry, dimension_names
from sonolube.dong2015.collar_analysis import collar_media
from sonolube.dong2015.collar_designs import COLLAR_DIMENSION_SOURCES, FINAL_COLLAR
from sonolube.dong2015.sizes import sized
from sonolube.models.fem.parts.transducers import SourcedDimension, Transducer
from sonolube.models.fem.solver.model import Electrodes, FixedSupport
from sonolube.models.fem.solver.reduction import Output

COLLAR_DIMENSIONS: Final = tuple(
    SourcedDimension(
        name=name,
        value=getattr(FINAL_COLLAR, name),
        source=COLLAR_DIMENSION_SOURCES[name],
        printed=COLLAR_DIMENSION_SOURCES[name].startswith("printed") and name != "ring_width",
    )
    for name in dimension_names()
)
"""Dimensions of the final collar and their sources; those assumed are fitted to the two measured resonances."""


@sized(COLLAR_DIMENSIONS[:10])  # those of the stack are printed
def collar_element(sizes: Mapping[str, Any]) -> Transducer:
    """Collar element of D 4.5, final design with the dimensions given.

    Parameters
    ----------
    frame_length, frame_width, frame_thickness : float
        Extent of the outer ring along the stack, across it, and along the rod. [m]
    base_thickness, top_thickness, pillar_width : float
        Walls of the outer ring under the stack, opposite to it, and beside the inner ring. [m]
    ring_width, ring_thickness : float
        Inner ring across its flats and along the rod. [m]
    bore_diameter, bolt_diameter : float
        Bore of the inner ring, and bolt through the stack. [m]

    Returns
    -------
    Transducer
        A quarter of the whole, of positive x and z. Outputs along y: "crown", the flat of the inner ring that faces the
        top; "saddle", the sector of the bore on which a rod rests; "base", the wall under the stack.

    Raises
    ------
    InvalidInput
        If parts do not fit into each other.

    See Also
    --------
    sonolube.dong2015.reduced_collar_model : The same with other designs and supports.
    """
    collar = replace(FINAL_COLLAR, **sizes)
    geometry, media = collar_geometry(collar), collar_media(collar)
    faces = {"crown": "ring.+y", "saddle": "saddle.bore", "base": "frame|stack"}
    return Transducer(
        geometry=geometry,
        media={region: media[region] for region in geometry.regions},
        electrodes=Electrodes(driven=("frame|stack",), grounded=("saddle|stack",)),
        outputs={name: Output(face=face, along="y") for name, face in faces.items()},
        fixed=tuple(
            FixedSupport(face=f"{region}.-{plane}", along=plane) for region in geometry.regions for plane in "xz"
        ),
        copies=4,
        dimensions=COLLAR_DIMENSIONS,
    )
