"""Disturbances of a friction test with their sizes: wobble, run-in, stick-slip, noise, drift, lags."""

from dataclasses import dataclass, replace
from math import pi, sqrt
from typing import Final

import numpy as np

from sonolube.checks import require_non_negative, require_positive


@dataclass(frozen=True, kw_only=True, slots=True)
class Disturbances:
    """Disturbances of a test. Zero switches one off. All sizes are assumed; the text says after what.

    Parameters
    ----------
    wobble_1, wobble_2 : float
        Amplitude of the first and second harmonic of the rotation in the friction force, over its mean, by run-out of
        the disc: a few per cent in the recordings of D 4.1.
    run_in_share : float
        Friction at first contact over that of the worn-in track, less one.
    run_in_distance : float
        Sliding distance over which that falls by a factor e, in m.
    stick_slip_share : float
        Fall of the force at a slip without vibration, over its mean; zero for steady sliding.
    holder_stiffness : float
        Of the holder of the pin, by which force rises while the pin sticks, as in the design of controllers. [N/m]
    holder_mass : float
        Mass that swings on it. [kg]
    holder_damping_ratio : float
        Of that motion.
    friction_noise : float
        Standard deviation of slow fluctuations of friction, over its mean.
    noise_time : float
        Correlation time of these, in s.
    ringing : float
        Standard deviation of the force at the natural frequency of the holder, over mean friction.
    sensor_noise : float
        Standard deviation of white noise of the force gauge, in N.
    drift_rate : float
        Standard deviation over tests of the drift of the force gauge, in N/s: about 1 mN in a minute.
    hysteresis : float
        Half the width of the play of the force gauge, in N.
    magnets : int
        At the rim of the disc, each a pulse of the Hall probe.
    flux_noise : float
        Of the Hall probe, over the height of a pulse.
    motor_time : float
        Time constant of the motor, in s.
    vibration_time : float
        Time constant with which the vibration follows the drive, in s.
    ambient_temperature : float
        [K]
    heat_share : float
        Share of the power drawn by the actuator that heats it: losses of hard ceramics of several per cent.
    thermal_resistance : float
        From the actuator to the room, in K/W.
    thermal_time : float
        Time constant of its warming, the thermocouple included, in s.
    temperature_noise : float
        Of the thermocouple, in K.
    voltage_noise : float
        Of the monitor of the amplifier, over the voltage.
    clock_error : float
        Relative deviation of the generator's clock from that of the acquisition.

    Raises
    ------
    InvalidInput
        If a size is negative, or a time constant is not positive.
    """

    wobble_1: float = 0.03
    wobble_2: float = 0.01
    run_in_share: float = 0.08
    run_in_distance: float = 0.15
    stick_slip_share: float = 0.0
    holder_stiffness: float = 20e3
    holder_mass: float = 0.05
    holder_damping_ratio: float = 0.05
    friction_noise: float = 0.01
    noise_time: float = 0.02
    ringing: float = 0.005
    sensor_noise: float = 2e-3
    drift_rate: float = 2e-5
    hysteresis: float = 2e-4
    magnets: int = 4
    flux_noise: float = 0.02
    motor_time: float = 0.02
    vibration_time: float = 2e-3
    ambient_temperature: float = 295.0
    heat_share: float = 0.05
    thermal_resistance: float = 20.0
    thermal_time: float = 20.0
    temperature_noise: float = 0.05
    voltage_noise: float = 2e-3
    clock_error: float = 1e-5

    def __post_init__(self) -> None:
        times = ("run_in_distance", "noise_time", "motor_time", "vibration_time", "thermal_time")
        stiff = ("holder_stiffness", "holder_mass")
        require_positive(**{name: getattr(self, name) for name in (*times, *stiff)})
        others = [name for name in self.__slots__ if name not in (*times, *stiff)]
        require_non_negative(**{name: getattr(self, name) for name in others})

    @property
    def natural_frequency(self) -> float:
        """Natural frequency of the holder. [Hz]"""
        return sqrt(self.holder_stiffness / self.holder_mass) / (2 * pi)

    def drawn(self, rng: np.random.Generator) -> "Disturbances":
        """Return the disturbances of one test: sizes scattered about those given.

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


_DRAWN: Final = ("wobble_1", "wobble_2", "run_in_share", "run_in_distance", "stick_slip_share", "ringing")
_SPREAD: Final = 0.3  # of the logarithm of a size, from test to test

UNDISTURBED: Final = Disturbances(
    wobble_1=0.0,
    wobble_2=0.0,
    run_in_share=0.0,
    friction_noise=0.0,
    ringing=0.0,
    sensor_noise=0.0,
    drift_rate=0.0,
    hysteresis=0.0,
    flux_noise=0.0,
    temperature_noise=0.0,
    voltage_noise=0.0,
    clock_error=0.0,
)
"""No disturbance but the lags of motor, vibration and temperature."""
