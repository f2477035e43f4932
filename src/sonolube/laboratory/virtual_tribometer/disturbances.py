"""Disturbances of a friction test with their sizes: wobble, run-in, stick-slip, noise, drift, lags."""

from dataclasses import dataclass, field, fields, replace
from math import pi, sqrt
from types import MappingProxyType
from typing import Any, Final

import numpy as np

from sonolube.checks import require_non_negative, require_positive
from sonolube.errors import InvalidInput


def _size(default: float, unit: str) -> Any:
    """Field with its unit."""
    return field(default=default, metadata={"units": unit})


@dataclass(frozen=True, kw_only=True, slots=True)
class Disturbances:
    """Disturbances of a test. Zero switches one off. The text says after what a size is; else it is assumed.

    Parameters
    ----------
    wobble_1, wobble_2 : float
        Amplitude of the first and second harmonic of the rotation in load and friction, over their mean, by run-out of
        the disc. D Tables 2.3 and 4.2 have standard deviations of 4 to 11 % with it, the first of windows of 2 s.
    run_in_share : float
        Friction at first contact over that of the worn-in track, less one; negative where friction rises, as D 2.3.3.
    run_in_distance : float
        Sliding distance over which that falls by a factor e, in m. D Table 2.3 has 3 to 12 m until aluminium is steady.
    static_share : float
        Friction at rest over that of sliding, less one: 1.2 N over 0.89 N in D 4.1.2. It is the peak as sliding begins,
        and at low speed the cause of stick-slip, both without vibration.
    holder_stiffness : float
        Of the holder of the pin along the sliding, as in the design of controllers. [N/m]
    holder_mass : float
        Mass that swings on it; both together swing at the 100 Hz of the stick-slip in D 2.3.4. [kg]
    holder_damping_ratio : float
        Of that motion, likewise.
    burst_duration : float
        Mean duration of a burst of stick-slip, and of the pause after it, above half the speed from which sliding is
        steady, in s; 0 where it goes on.
    friction_noise : float
        Standard deviation of slow fluctuations of friction, over its mean.
    noise_time : float
        Correlation time of these, in s.
    ringing : float
        Standard deviation of the force at the natural frequency of the loading arm, over mean friction; frequency and
        damping by the structure of the rig, else those of the holder.
    sensor_noise : float
        Standard deviation of white noise of the force gauge, in N: D Table 4.2 has 0.04 N even where friction is
        0.04 N, of which this is the part without the others.
    drift_rate : float
        Standard deviation over tests of the drift of the force gauge, in N/s: about 1 mN in a minute.
    hysteresis : float
        Half the width of the play of the force gauge, in N.
    deflected_stiffness : float
        Of the holder, or of a waveguide, at the displacement sensor, by the force along the sliding, in N/m.
    deflection_play : float
        Half the width of the play of that deflection, in m.
    displacement_noise : float
        Standard deviation of white noise of the displacement sensor, in m.
    magnets : int
        At the rim of the disc, each a pulse of the Hall probe; one in D 4.1.2.
    flux_noise : float
        Of the Hall probe, over the height of a pulse.
    motor_time : float
        Time constant of the motor, in s.
    vibration_time : float
        Time constant with which the vibration follows the drive, in s.
    contact_share : float
        Place of the thermocouple: 0 on the actuator (D Table 2.2), 1 in the contact (D 4.3).
    thermocouple_time : float
        Time constant of the thermocouple, in s.
    temperature_noise : float
        Of the thermocouple, in K.
    voltage_noise : float
        Of the monitor of the amplifier, over the voltage.
    current_noise : float
        Of the current probe, in A.
    clock_error : float
        Relative deviation of the generator's clock from that of the acquisition.

    Raises
    ------
    InvalidInput
        If a size is negative or above its range, or a time constant is not positive.
    """

    wobble_1: float = _size(0.04, "1")
    wobble_2: float = _size(0.015, "1")
    run_in_share: float = _size(0.08, "1")
    run_in_distance: float = _size(0.15, "m")
    static_share: float = _size(0.35, "1")
    holder_stiffness: float = _size(20e3, "N/m")
    holder_mass: float = _size(0.05, "kg")
    holder_damping_ratio: float = _size(0.01, "1")
    burst_duration: float = _size(1.0, "s")
    friction_noise: float = _size(0.01, "1")
    noise_time: float = _size(0.02, "s")
    ringing: float = _size(0.005, "1")
    sensor_noise: float = _size(0.03, "N")
    drift_rate: float = _size(2e-5, "N/s")
    hysteresis: float = _size(2e-4, "N")
    deflected_stiffness: float = _size(1e6, "N/m")
    deflection_play: float = _size(5e-7, "m")
    displacement_noise: float = _size(1e-7, "m")
    magnets: int = _size(1, "1")
    flux_noise: float = _size(0.02, "1")
    motor_time: float = _size(0.02, "s")
    vibration_time: float = _size(2e-3, "s")
    contact_share: float = _size(0.0, "1")
    thermocouple_time: float = _size(0.5, "s")
    temperature_noise: float = _size(0.05, "K")
    voltage_noise: float = _size(2e-3, "1")
    current_noise: float = _size(1e-4, "A")
    clock_error: float = _size(1e-5, "1")

    def __post_init__(self) -> None:
        times = ("noise_time", "motor_time", "vibration_time", "thermocouple_time")
        positive = (*times, "run_in_distance", "holder_stiffness", "holder_mass", "deflected_stiffness")
        require_positive(**{name: getattr(self, name) for name in positive})
        others = [name for name in DISTURBANCE_UNITS if name not in (*positive, "run_in_share")]
        require_non_negative(**{name: getattr(self, name) for name in others})
        if not self.run_in_share > -1:
            raise InvalidInput(f"run_in_share must be above -1, got {self.run_in_share:g}")
        for name in ("contact_share", "holder_damping_ratio"):
            if getattr(self, name) > 1:
                raise InvalidInput(f"{name} must not be above 1, got {getattr(self, name):g}")

    @property
    def natural_frequency(self) -> float:
        """Natural frequency of the holder. [Hz]"""
        return sqrt(self.holder_stiffness / self.holder_mass) / (2 * pi)

    def drawn(self, rng: np.random.Generator) -> "Disturbances":
        """Disturbances of one test: sizes scattered about those given.

        Parameters
        ----------
        rng : numpy.random.Generator

        Returns
        -------
        Disturbances
        """
        factors = rng.lognormal(0.0, _SPREAD, size=len(_DRAWN))
        return replace(
            self, **{name: getattr(self, name) * factor for name, factor in zip(_DRAWN, factors, strict=True)}
        )


DISTURBANCE_UNITS: Final = MappingProxyType({each.name: str(each.metadata["units"]) for each in fields(Disturbances)})
"""SI unit of each size."""

_DRAWN: Final = ("wobble_1", "wobble_2", "run_in_share", "run_in_distance", "static_share", "ringing")
_SWITCHED_OFF: Final[dict[str, Any]] = dict.fromkeys(
    (
        *("wobble_1", "wobble_2", "run_in_share", "static_share", "burst_duration", "friction_noise", "ringing"),
        *("sensor_noise", "drift_rate", "hysteresis", "deflection_play", "displacement_noise", "flux_noise"),
        *("temperature_noise", "voltage_noise", "current_noise", "clock_error"),
    ),
    0.0,
)
_SPREAD: Final = 0.3  # of the logarithm of a size, from test to test

UNDISTURBED: Final = Disturbances(**_SWITCHED_OFF)
"""No disturbance but the lags of motor, vibration and temperature."""
