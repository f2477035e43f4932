"""Table of the dissertation's transducers by name, and the ring stack of its collar (D Table 4.7)."""

from collections.abc import Callable, Mapping
from types import MappingProxyType

from sonolube.dong2015.cutter import cutter_head
from sonolube.dong2015.tribometer import tribometer_actuator
from sonolube.fem.parts.transducers import Transducer, stack_transducer


def ring_stack(
    *,
    outer_radius: float = 5e-3,
    inner_radius: float = 2.5e-3,
    length: float = 12e-3,
    stack_layers: float = 1.0,
    rod_radius: float = 0.0,
    back_length: float = 0.0,
    front_length: float = 0.0,
    ceramic: str = "pic255",
    metal: str = "stainless_steel_304",
) -> Transducer:
    """Multilayer stack with the size of the collar's ring stack, D Table 4.7, as default.

    Parameters
    ----------
    outer_radius, inner_radius : float
        Radii of the layers; the inner is zero for discs. [m]
    length : float
        Total length of the layers. [m]
    stack_layers : float
        Number of layers. []
    rod_radius : float
        Radius of the rod through the bore, zero for none. [m]
    back_length, front_length : float
        Lengths of the end masses, zero for none; a rod needs both. [m]
    ceramic, metal : str
        Names of the materials.

    Returns
    -------
    Transducer

    Raises
    ------
    InvalidInput
        If a size does not fit.

    See Also
    --------
    sonolube.fem.stack_transducer : The same without default sizes.

    References
    ----------
    .. [1] D Table 4.7.
    """
    return stack_transducer(
        outer_radius=outer_radius,
        inner_radius=inner_radius,
        length=length,
        stack_layers=stack_layers,
        rod_radius=rod_radius,
        back_length=back_length,
        front_length=front_length,
        ceramic=ceramic,
        metal=metal,
    )


DONG_2015_TRANSDUCERS: Mapping[str, Callable[..., Transducer]] = MappingProxyType(
    {"cutter_head": cutter_head, "stack": ring_stack, "tribometer_actuator": tribometer_actuator}
)
"""The dissertation's transducers by name, each with default sizes; `sonolube.fem.TRANSDUCERS` has the general ones."""
