"""Table of the dissertation's transducers by name; its stack has the size of the ring stack of D Table 4.7."""

from collections.abc import Callable, Mapping
from functools import partial
from types import MappingProxyType

from sonolube.dong2015.collar_transducer import collar_element
from sonolube.dong2015.cutter import cutter_head
from sonolube.dong2015.horn import poisson_horn
from sonolube.dong2015.tribometer import tribometer_actuator
from sonolube.models.fem.parts.transducers import Transducer, stack_transducer

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
