"""Self-checks of an installation: results of the package beside closed forms written out here."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from io import BytesIO
from typing import Any

import numpy as np

from sonolube.models.contact import SphereOnFlat, hertz_contact_radius
from sonolube.models.dynamics import LinearGap, Status, Structure, modes, steady_state
from sonolube.models.friction import oblique_vibration_ratio, parallel_vibration_ratio
from sonolube.text.units import to_si


@dataclass(frozen=True, kw_only=True, slots=True)
class SelfCheck:
    """One computation of the package beside its closed form.

    Parameters
    ----------
    title : str
        What is computed.
    expected : float
        Value of the closed form.
    compute : callable
        Returns the value of the package.
    tolerance : float
        Largest relative deviation.
    """

    title: str
    expected: float
    compute: Callable[[], float]
    tolerance: float = 1e-9

    def outcome(self) -> dict[str, Any]:
        """Title, expected and computed value, relative deviation and whether it passed; an error is its reason."""
        found: dict[str, Any] = {"title": self.title, "expected": self.expected}
        try:
            computed = float(self.compute())
        except Exception as failure:  # whatever a broken installation raises is what the check is for
            reason = f"{type(failure).__name__}: {failure}".splitlines()[0]
            return found | {"computed": None, "deviation": None, "passed": False, "reason": reason}
        deviation = abs(computed / self.expected - 1) if math.isfinite(computed) else None
        passed = deviation is not None and deviation <= self.tolerance
        reason = "" if passed else f"off by more than {self.tolerance:g}"
        return found | {"computed": computed, "deviation": deviation, "passed": passed, "reason": reason}


def _oscillator() -> Structure:
    """Mass of 0.2 kg on a spring of 4 GN/m, with a stack of 5 N/V."""
    matrices = {"mass_matrix": 0.2, "damping_matrix": 400.0, "stiffness_matrix": 4e9}
    vectors = {"drive_vector": np.array([5.0]), "contact_vector": np.ones(1)}
    return Structure(
        **{name: np.array([[value]]) for name, value in matrices.items()}, **vectors, clamped_capacitance=1e-7
    )


def _vibration() -> float:
    """Amplitude of the mass on a contact spring that it never leaves, by the compiled harmonic balance."""
    contact = LinearGap(normal_stiffness=1e9)
    states = steady_state(_oscillator(), contact, normal_load=1000.0, frequency=22e3, voltage_amplitude=10.0)
    if states.status != Status.PERIODIC:
        raise ArithmeticError(f"status {Status(int(states.status)).name.lower()}")
    return float(abs(states.harmonics[0]))


def _netcdf() -> float:
    """Number read from a netCDF file in memory."""
    import xarray as xr

    written = bytes(xr.Dataset({"friction_force": ("point", [0.25])}).to_netcdf(engine="h5netcdf"))
    with xr.open_dataset(BytesIO(written), engine="h5netcdf") as read:
        return float(read["friction_force"].values[0])


def _picture() -> float:
    """Width in pixels of a figure of one inch at 200 dots per inch, from its PNG."""
    from matplotlib.figure import Figure

    from sonolube.figure import render_figure

    return float(int.from_bytes(render_figure(Figure(figsize=(1.0, 1.0)), "png", resolution=200)[16:20], "big"))


_OMEGA = 2 * math.pi * 22e3
SELF_CHECKS = (
    SelfCheck(title="22 kHz in hertz", expected=22000.0, compute=lambda: to_si("22kHz", unit="Hz", name="frequency")),
    SelfCheck(
        title="contact radius of a sphere by Hertz, (3 F R/(4 E*))^(1/3)",
        expected=(0.75 * 10.0 * 5e-3 / 100e9) ** (1 / 3),
        compute=lambda: float(
            hertz_contact_radius(SphereOnFlat(tip_radius=5e-3, effective_modulus=100e9), normal_load=10.0)
        ),
    ),
    SelfCheck(
        title="Coulomb friction with vibration along the sliding, 2/pi asin(1/2)",
        expected=1 / 3,
        compute=lambda: float(parallel_vibration_ratio(sliding_speed=0.5, vibration_velocity=1.0)),
    ),
    SelfCheck(
        title="the same at a small angle, by compiled code",
        expected=1 / 3,
        compute=lambda: float(
            oblique_vibration_ratio(sliding_speed=0.5, vibration_velocity=1.0, vibration_direction=0.0)
        ),
    ),
    SelfCheck(
        title="natural frequency of a mass on a spring, sqrt(k/m)/(2 pi)",
        expected=math.sqrt(4e9 / 0.2) / (2 * math.pi),
        compute=lambda: float(modes(_oscillator()).natural_frequency[0]),
        tolerance=1e-6,  # with damping ratio 0.007 the poles lie beside it by its square at most
    ),
    SelfCheck(
        title="vibration on a contact spring, F/|k + k_c - m w^2 + i c w|, by compiled code",
        expected=50.0 / abs(5e9 - 0.2 * _OMEGA**2 + 400j * _OMEGA),
        compute=_vibration,
        tolerance=1e-6,
    ),
    SelfCheck(title="a number written as netCDF and read again", expected=0.25, compute=_netcdf),
    SelfCheck(title="width of a figure of 200 pixels", expected=200.0, compute=_picture),
)
"""Checks in the order in which they run; the compiled ones take some 20 s of processor time at the first call."""
