"""Preload bolt by the text of its thread, such as M6x40mm."""

import re

from sonolube.errors import InvalidInput
from sonolube.models.actuator import PreloadBolt
from sonolube.text.units import to_si

_THREAD = re.compile(r"M(\d+(?:\.\d+)?)x(.+)")
_STEEL = 205e9  # Pa, Young's modulus of bolts


def preload_bolt(thread: str, *, preload: float, yield_strength: float, name: str) -> PreloadBolt:
    """Steel bolt by its thread and the length that stretches."""
    found = _THREAD.fullmatch(thread.strip())
    if not found:
        raise InvalidInput(f"{name} {thread} must look like M6x40mm: thread and length that stretches")
    return PreloadBolt(
        thread_diameter=1e-3 * float(found[1]),
        length=to_si(found[2], unit="m", name=name),
        youngs_modulus=_STEEL,
        yield_strength=yield_strength,
        preload=preload,
    )
