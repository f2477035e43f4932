"""True values behind a virtual test, as a dataset with units."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from sonolube.laboratory.devices import DriveSetting
from sonolube.laboratory.virtual_tribometer.disturbances import DISTURBANCE_UNITS, Disturbances
from sonolube.laboratory.virtual_tribometer.friction_draw import FrictionLevel
from sonolube.laboratory.virtual_tribometer.stick_slip import Bursts, StickSlip

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True, slots=True)
class TruthSetting:
    """Setting of motor and drive with what it gives.

    Parameters
    ----------
    start_time : float
        [s]
    sliding_speed : float
        [m/s]
    drive : DriveSetting or None
        None for off.
    level : FrictionLevel
    flash_temperature_rise : float
        Mean of the contact, steady, in K; NaN where materials are unknown.
    normal_load : float
        [N]
    stick_slip : StickSlip
        Of sliding without vibration at this speed and load.
    """

    start_time: float
    sliding_speed: float
    drive: DriveSetting | None
    level: FrictionLevel
    flash_temperature_rise: float
    normal_load: float
    stick_slip: StickSlip

    @property
    def sticks(self) -> bool:
        """Whether there is stick-slip."""
        return self.drive is None and self.stick_slip.occurs

    def sticking_share(self, bursts: Bursts, end_time: float) -> float:
        """Share of the time with stick-slip, where this setting lasts to a time. []"""
        if not (self.sticks and self.stick_slip.comes_in_bursts):
            return float(self.sticks)
        return bursts.share(self.start_time, end_time)


def truth_dataset(
    settings: Sequence[TruthSetting],
    *,
    end_time: float,
    bursts: Bursts,
    sizes: Disturbances,
    single: Mapping[str, tuple[float, str]],
    title: str,
) -> "xr.Dataset":
    """True values behind a virtual test.

    Values of each setting over `setting`, and the others as numbers, each with its unit.
    """
    import xarray as xr

    ends = [*(each.start_time for each in settings), end_time][1:]
    shares = [each.sticking_share(bursts, end) for each, end in zip(settings, ends, strict=True)]
    columns = {
        "start_time": ([each.start_time for each in settings], "s"),
        "sliding_speed": ([each.sliding_speed for each in settings], "m/s"),
        "voltage_peak_to_peak": ([each.drive.voltage_peak_to_peak if each.drive else 0.0 for each in settings], "V"),
        "voltage_offset": ([each.drive.voltage_offset if each.drive else 0.0 for each in settings], "V"),
        "frequency": ([each.drive.frequency if each.drive else 0.0 for each in settings], "Hz"),
        "vibration_amplitude": ([each.level.vibration_amplitude for each in settings], "m"),
        "friction_force": ([each.level.friction_force for each in settings], "N"),
        "friction_ratio": ([each.level.friction_ratio for each in settings], "1"),
        "wear_rate": ([each.level.wear_rate for each in settings], "m2"),
        "flash_temperature_rise": ([each.flash_temperature_rise for each in settings], "K"),
        "normal_load": ([each.normal_load for each in settings], "N"),
        "stick_slip_frequency": ([1 / each.stick_slip.period if each.sticks else 0.0 for each in settings], "Hz"),
        "stick_slip_fall": ([each.stick_slip.fall if each.sticks else 0.0 for each in settings], "N"),
        "stick_slip_fraction": (shares, "1"),
    }
    numbers = {**single, **{name: (getattr(sizes, name), unit) for name, unit in DISTURBANCE_UNITS.items()}}
    return xr.Dataset(
        {
            **{name: ("setting", values, {"units": unit}) for name, (values, unit) in columns.items()},
            **{name: ((), value, {"units": unit}) for name, (value, unit) in numbers.items()},
        },
        attrs={"title": title},
    )
