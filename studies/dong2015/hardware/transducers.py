"""Transducers of the dissertation by name: actuator of the tribometer, cutter head and collar element.

Few of its sizes are printed. The assumed ones are those of common hardware about a rod of 1/4 in, chosen for the mass
and capacitance of D Table 3.5.

Its sizes are not printed. With the assumed ones the mode in which the rim of the disc moves against its centre is at
20 kHz.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from types import MappingProxyType
from typing import Any, Final

from dong2015.hardware.collar import COLLAR_DIMENSION_SOURCES, FINAL_COLLAR, collar_geometry, dimension_names
from dong2015.hardware.collar_analysis import collar_media
from dong2015.hardware.horn import poisson_horn
from dong2015.hardware.sizes import sized, sourced_dimensions
from sonolube.models.fem import (
    Electrodes,
    FixedSupport,
    Geometry,
    Output,
    SourcedDimension,
    Transducer,
    acorn_nut,
    bond,
    cad_kernel,
    hub_disc,
    single_body,
    stack_bodies,
    stack_from_bodies,
    stack_transducer,
)

_OF_STACK = ("outer_radius", "inner_radius", "length", "rod_radius", "back_length", "front_length", "washer_radius")
TRIBOMETER_ACTUATOR_DIMENSIONS = sourced_dimensions("tribometer_actuator")
"""Dimensions of the tribometer's actuator (D 2.3.1, appendix A) and their sources; the text prints few of them."""


@sized(TRIBOMETER_ACTUATOR_DIMENSIONS)
def tribometer_actuator(
    sizes: Mapping[str, Any], *, ceramic: str = "pic255", metal: str = "stainless_steel_316"
) -> Transducer:
    """Actuator of the modified pin-on-disc tribometer, D 2.3.1: a bolted stack with an acorn nut as its pin.

    Parameters
    ----------
    outer_radius, inner_radius : float
        Radii of the layers. [m]
    length : float
        Total length of the layers. [m]
    stack_layers : float
        Number of layers. []
    rod_radius : float
        Radius of the rod through the stack. [m]
    washer_radius : float
        Radius of the end masses, each of washer and nut in one. [m]
    back_length, front_length : float
        Lengths of the end masses. [m]
    width : float
        Width of the acorn nut across flats. [m]
    nut_length : float
        Length of the hexagon of the nut. [m]
    tip_radius : float
        Radius of the dome of the nut. [m]
    contact_radius : float
        Radius of the flat on the dome. [m]
    ceramic, metal : str
        Names of the materials.

    Returns
    -------
    Transducer

    Raises
    ------
    InvalidInput
        If a size does not fit.

    Notes
    -----
    `TRIBOMETER_ACTUATOR_DIMENSIONS` lists which sizes are printed. The gimbal's arm is neglected, except for the mass
    bolted to it.

    References
    ----------
    .. [1] D 2.3.1, Table 3.5, A.1.3.
    """
    nut = acorn_nut(
        width=sizes["width"],
        length=sizes["nut_length"],
        tip_radius=sizes["tip_radius"],
        contact_radius=sizes["contact_radius"],
    )
    made = stack_with_tip(nut, sizes, ceramic=ceramic, metal=metal)
    return replace(made, dimensions=TRIBOMETER_ACTUATOR_DIMENSIONS)


def stack_with_tip(tip: Geometry, sizes: Mapping[str, Any], *, ceramic: str, metal: str) -> Transducer:
    """Bolted stack between end masses of washer and nut in one, with a tip."""
    bodies = stack_bodies(**{name: sizes[name] for name in _OF_STACK}, tip=tip)
    return stack_from_bodies(bodies, stack_layers=sizes["stack_layers"], ceramic=ceramic, metal=metal)


_FAR: Final = 1e3  # mm, beyond all bodies

CUTTER_HEAD_DIMENSIONS = (
    *TRIBOMETER_ACTUATOR_DIMENSIONS[:6],  # D 4.4.2: the stack is that of the tribometer
    TRIBOMETER_ACTUATOR_DIMENSIONS[7],
    *sourced_dimensions("cutter_head"),
)
"""Dimensions of the cutter head (D 4.4) and their sources; the text prints none but the number of layers."""


@sized((*CUTTER_HEAD_DIMENSIONS[:6], *CUTTER_HEAD_DIMENSIONS[7:5:-1], *CUTTER_HEAD_DIMENSIONS[8:]))  # the back first
def cutter_head(sizes: Mapping[str, Any], *, ceramic: str = "pic255", metal: str = "stainless_steel_304") -> Transducer:
    """Cutter head of D 4.4: a disc glued to the nut of the stack of the tribometer's actuator.

    Parameters
    ----------
    outer_radius, inner_radius : float
        Radii of the layers. [m]
    length : float
        Total length of the layers. [m]
    stack_layers : float
        Number of layers. []
    rod_radius : float
        Radius of the rod through the stack. [m]
    washer_radius : float
        Radius of the end masses, each of washer and nut in one. [m]
    back_length, front_length : float
        Lengths of the end masses. [m]
    hub_radius : float
        Radius of the weld nut. [m]
    hub_length : float
        Length of the weld nut. [m]
    disc_radius : float
        Radius of the cutter disc. [m]
    thickness : float
        Thickness of the cutter disc. [m]
    ceramic, metal : str
        Names of the materials.

    Returns
    -------
    Transducer

    Raises
    ------
    InvalidInput
        If a size does not fit.

    Notes
    -----
    `CUTTER_HEAD_DIMENSIONS` lists what the sizes are inferred from. The disc is plain: its cutting slots are neglected.

    References
    ----------
    .. [1] D 4.4.2 to 4.4.4.
    """
    disc = hub_disc(**{name: sizes[name] for name in ("hub_radius", "hub_length", "disc_radius", "thickness")})
    made = stack_with_tip(disc, sizes, ceramic=ceramic, metal=metal)
    return replace(made, dimensions=CUTTER_HEAD_DIMENSIONS)


def cutter_head_quarter() -> Transducer:
    """Quarter of the cutter head of default sizes, of positive x and y.

    Its modes are those of the head that are even about both planes, among them all axisymmetric ones, in a third of the
    time.
    """
    whole = cutter_head()
    quadrant = cad_kernel().Box((0, 0, -_FAR), (_FAR, _FAR, _FAR))
    solids = zip(whole.geometry.regions, whole.geometry.shape.solids, strict=True)
    return replace(
        whole,
        geometry=bond({name: single_body(solid * quadrant, name) for name, solid in solids}),
        fixed=tuple(
            FixedSupport(face=f"{region}.-{plane}", along=plane) for region in whole.geometry.regions for plane in "xy"
        ),
        copies=4,
    )


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
    dong2015.hardware.reduced_collar_model : The same with other designs and supports.
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


DONG_2015_TRANSDUCERS: Mapping[str, Callable[..., Transducer]] = MappingProxyType(
    {
        "collar": collar_element,
        "cutter_head": cutter_head,
        "poisson_horn_aluminium": partial(poisson_horn, solid="aluminium", front_length=32e-3),
        "poisson_horn_steel": partial(poisson_horn, solid="steel"),
        "stack": partial(
            stack_transducer,
            outer_radius=5e-3,  # D Table 4.7
            inner_radius=2.5e-3,
            length=12e-3,
            ceramic="pic255",
            metal="stainless_steel_304",
        ),
        "tribometer_actuator": tribometer_actuator,
    }
)
"""The dissertation's transducers by name, each with default sizes; `sonolube.models.fem.TRANSDUCERS` has the general
ones."""
