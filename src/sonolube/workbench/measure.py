"""Measurement of one file: friction recordings, surfaces, wear grooves, impedance spectra and vibrometer recordings."""

from pathlib import Path

from sonolube.report.measured.friction import FrictionSettings, friction_sheet
from sonolube.report.measured.groove import groove_sheet
from sonolube.report.measured.impedance import ImpedanceSettings, impedance_sheet
from sonolube.report.measured.sheet import Sheet
from sonolube.report.measured.surface import SurfaceSettings, surface_sheet
from sonolube.report.measured.vibration import VibrationSettings, vibration_sheet

__all__ = ["friction", "groove", "impedance", "surface", "vibration"]


def __dir__() -> list[str]:
    return __all__


def friction(path: str | Path, *, sliding_speed: float | None = None, rotation_speed: float | None = None) -> Sheet:
    """Friction in a recording: level, fluctuation, running-in, voltage steps, stick-slip, work and wobble.

    Parameters
    ----------
    path : str or Path
        In any format of `sonolube.measurement.read_recording`.
    sliding_speed : float, optional
        For the distance to the steady state. [m/s]
    rotation_speed : float, optional
        Of the disc, to remove its wobble. [1/s]

    Returns
    -------
    Sheet
        The same values as `sonolube measure friction` prints.

    Raises
    ------
    InvalidInput
        If the file cannot be read or holds no friction force.
    """
    return friction_sheet(
        Path(path), settings=FrictionSettings(sliding_speed=sliding_speed, rotation_speed=rotation_speed)
    )


def surface(path: str | Path) -> Sheet:
    """Roughness of a scan or of a line profile: areal parameters, summits and spectrum.

    Parameters
    ----------
    path : str or Path
        In any format of `sonolube.measurement.read_surface_file`.

    Returns
    -------
    Sheet
        The same values as `sonolube measure surface` prints.

    Raises
    ------
    InvalidInput
        If the file cannot be read.
    """
    return surface_sheet(Path(path), settings=SurfaceSettings())


def groove(path: str | Path, *, track: int | None = None) -> Sheet:
    """Wear groove in a scan: width, depth, volumes and pile-up.

    Parameters
    ----------
    path : str or Path
        In any format of `sonolube.measurement.read_surface_file`.
    track : int, optional
        Which of several tracks, from 1.

    Returns
    -------
    Sheet
        The same values as `sonolube measure groove` prints.

    Raises
    ------
    InvalidInput
        If the file cannot be read, holds no groove, or several and no track is named.
    """
    return groove_sheet(Path(path), settings=SurfaceSettings(), track_number=track)[0]


def impedance(path: str | Path, *, branches: int | None = None) -> Sheet:
    """Equivalent circuit fitted to a measured impedance spectrum.

    Parameters
    ----------
    path : str or Path
        In any format of `sonolube.measurement.read_impedance`.
    branches : int, optional
        Modes of the circuit; as many as a criterion supports where absent.

    Returns
    -------
    Sheet
        The same values as `sonolube measure impedance` prints.

    Raises
    ------
    InvalidInput
        If the file cannot be read or holds no impedance.
    """
    return impedance_sheet(Path(path), settings=ImpedanceSettings(branches=branches))


def vibration(path: str | Path, *, frequency: float) -> Sheet:
    """Amplitudes and phases at the drive frequency in a vibrometer recording.

    Parameters
    ----------
    path : str or Path
        In any format of `sonolube.measurement.read_recording`.
    frequency : float
        Of the drive. [Hz]

    Returns
    -------
    Sheet
        The same values as `sonolube measure vibration` prints.

    Raises
    ------
    InvalidInput
        If the file cannot be read or holds no vibration.
    """
    return vibration_sheet(Path(path), settings=VibrationSettings(frequency=frequency))
