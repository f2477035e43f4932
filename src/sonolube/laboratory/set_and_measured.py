"""Voltage of the drive as a channel measures it, beside the one that was set: before a run, and at every block."""

from collections.abc import Container, Sequence
from dataclasses import replace
from math import sqrt
from typing import Final

import numpy as np

from sonolube.laboratory.block import Block
from sonolube.laboratory.devices import RATE_ERROR, DriveSetting
from sonolube.laboratory.interlocks import SAMPLES_PER_PERIOD
from sonolube.text.units import format_si

DIFFERENCE: Final = 0.15
"""Share of the voltage by which set and measured may differ: errors of gains, droop of the amplifier."""

LEAST: Final = 1.0
"""Difference that counts at least, for the offset and noise of monitors. [V]"""

SELF_TEST_SHARE: Final = 0.1
"""Voltage of the test before a run, of the first of its protocol."""

SELF_TEST_TIME: Final = 0.3
"""Time for which the test drives before it measures. [s]"""

SETTLING: Final = 0.2
"""Time after a setting from which on it is compared. [s]"""

_SWINGS: Final = {"sine": 2 * sqrt(2), "square": 2.0, "triangle": 2 * sqrt(3), "sawtooth": 2 * sqrt(3)}
"""Peak-to-peak value over the standard deviation, by waveform."""


_NEAR: Final = 0.05  # share of the voltage by which settings differ that follow each other closely


def is_near(former: DriveSetting | None, setting: DriveSetting | None) -> bool:
    """Whether a setting changes the voltage alone, and by so little that what is measured needs no time to follow."""
    if (
        former is None
        or setting is None
        or replace(former, voltage_peak_to_peak=0.0) != replace(setting, voltage_peak_to_peak=0.0)
    ):
        return former is setting
    swing = setting.voltage_peak_to_peak
    return abs(swing - former.voltage_peak_to_peak) <= _NEAR * swing


def self_test_setting(first: DriveSetting | None) -> DriveSetting | None:
    """Setting of the test before a run from the first of its protocol; None where its difference could not be seen."""
    if first is None or SELF_TEST_SHARE * first.voltage_peak_to_peak < 2 * LEAST:
        return None
    return replace(first, voltage_peak_to_peak=SELF_TEST_SHARE * first.voltage_peak_to_peak, voltage_offset=0.0)


def monitor_of(channels: Container[str], *, sample_rate: float, frequency: float) -> str:
    """Channel that shows the voltage of the drive at a sample rate and frequency, in Hz; empty without one."""
    if "voltage_peak_to_peak" in channels:
        return "voltage_peak_to_peak"
    resolves = sample_rate >= SAMPLES_PER_PERIOD * frequency * (1 - RATE_ERROR)  # hardware may give that much less
    return "voltage" if "voltage" in channels and resolves else ""


def difference(block: Block, names: Sequence[str], setting: DriveSetting) -> str:
    """Why a block shows another voltage than the one that was set; empty where it does not, or shows none.

    Parameters
    ----------
    block : Block
    names : sequence of str
        Of its channels.
    setting : DriveSetting

    Returns
    -------
    str
    """
    name = monitor_of(names, sample_rate=block.sample_rate, frequency=setting.frequency)
    if not name:
        return ""
    values = block.values[:, list(names).index(name)]
    spread = float(np.mean(values)) if name != "voltage" else _SWINGS[setting.waveform] * float(np.std(values))
    wanted = setting.voltage_peak_to_peak
    if abs(spread - wanted) <= max(DIFFERENCE * wanted, LEAST):
        return ""
    found, was = format_si(spread, "V", digits=3), format_si(wanted, "V", digits=3)
    return f"channel {name} measures {found} peak to peak where {was} was set; look at load, unit and amplifier"
