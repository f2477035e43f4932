"""Plan of a hold: the channels that are recorded, and the speeds over time as a protocol for the record."""

from collections.abc import Mapping
from itertools import pairwise
from typing import Any, Final

from sonolube.facts.protocol import Protocol, exact_text, protocol_from
from sonolube.laboratory.block import Channel
from sonolube.laboratory.closed_loop.record import FrictionHold
from sonolube.laboratory.interlocks import interlocks_for
from sonolube.text.units import format_si

_RECORDED: Final = ("friction_force", "normal_load", "voltage_peak_to_peak", "voltage", "temperature", "gaussmeter")
_MIN_WAIT: Final = 1e-6  # s


def recorded_channels(hold: FrictionHold, channels: Mapping[str, Channel]) -> tuple[str, ...]:
    """Channels that are recorded while friction is held: those of its analysis, and those that limits watch.

    Parameters
    ----------
    hold : FrictionHold
    channels : mapping of str to Channel
        Of the acquisition, by name.

    Returns
    -------
    tuple of str
    """
    watched = (lock.channel.name for lock in interlocks_for(hold.limits, channels, hold.drive_sampling))
    return tuple(dict.fromkeys([*(name for name in _RECORDED if name in channels), *watched]))


def hold_protocol(hold: FrictionHold, channels: Mapping[str, Channel]) -> Protocol:
    """Speeds and recording of a hold as a protocol; the voltage, which the controller sets, is not in it.

    Parameters
    ----------
    hold : FrictionHold
    channels : mapping of str to Channel
        Of the acquisition, by name.

    Returns
    -------
    Protocol
    """
    names = recorded_channels(hold, channels)
    total = hold.run_in + hold.duration
    rate, lasts = exact_text(hold.sample_rate, unit="Hz"), exact_text(total, unit="s")
    steps: list[dict[str, Any]] = [{"kind": "acquire", "channels": list(names), "sample_rate": rate, "duration": lasts}]
    begins = [0.0, *(hold.run_in + step.time for step in hold.speeds[1:]), total]
    for step, (begin, end) in zip(hold.speeds, pairwise(begins), strict=True):
        steps.append({"kind": "motor_speed", "sliding_speed": exact_text(step.sliding_speed, unit="m/s")})
        if end - begin >= _MIN_WAIT:
            steps.append({"kind": "wait", "duration": exact_text(end - begin, unit="s")})
    return protocol_from(
        {
            "title": f"Friction held at {format_si(hold.friction_force, 'N')}",
            "source": "sonolube lab hold: the drive voltage is that of the controller",
            "limits": hold.limits.model_dump(mode="json", exclude_none=True),
            "steps": steps,
        }
    )
