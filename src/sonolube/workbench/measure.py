"""Measurement of files: friction, surfaces, wear grooves, impedance, vibration and the stiffness of a contact."""

from pathlib import Path

from sonolube.report.measured.contact_stiffness import StiffnessSettings, contact_stiffness_sheet
from sonolube.report.measured.friction import FrictionSettings, friction_sheet
from sonolube.report.measured.groove import groove_sheet
from sonolube.report.measured.impedance import ImpedanceSettings, impedance_sheet
from sonolube.report.measured.sheet import Sheet
from sonolube.report.measured.surface import SurfaceSettings, spacings, surface_sheet
from sonolube.report.measured.vibration import VibrationSettings, vibration_sheet
from sonolube.rig import Rig

__all__ = ["friction", "groove", "impedance", "stiffness", "surface", "vibration"]


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


def surface(path: str | Path, *, spacing: str | None = None, length_unit: str | None = None) -> Sheet:
    """Roughness of a scan or of a line profile: areal parameters, summits and spectrum.

    Parameters
    ----------
    path : str or Path
        In any format of `sonolube.measurement.read_surface_file`.
    spacing : str, optional
        Distance of pixels as text, for files that lack it: "0.5 um", or of columns and rows "0.5 um, 0.6 um". [m]
    length_unit : str, optional
        Unit of the lengths, for files that lack it, such as "um".

    Returns
    -------
    Sheet
        The same values as `sonolube measure surface` prints.

    Raises
    ------
    InvalidInput
        If the file cannot be read, or a spacing is no length.
    """
    return surface_sheet(Path(path), settings=_lateral(spacing, length_unit))


def groove(
    path: str | Path, *, track: int | None = None, spacing: str | None = None, length_unit: str | None = None
) -> Sheet:
    """Wear groove in a scan: width, depth, volumes and pile-up.

    Parameters
    ----------
    path : str or Path
        In any format of `sonolube.measurement.read_surface_file`.
    track : int, optional
        Which of several tracks, from 1.
    spacing : str, optional
        Distance of pixels, as for `surface`. [m]
    length_unit : str, optional
        Unit of the lengths, as for `surface`.

    Returns
    -------
    Sheet
        The same values as `sonolube measure groove` prints.

    Raises
    ------
    InvalidInput
        If the file cannot be read, holds no groove, or several and no track is named, or a spacing is no length.
    """
    return groove_sheet(Path(path), settings=_lateral(spacing, length_unit), track_number=track)[0]


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


def stiffness(
    free: str | Path,
    pressed: str | Path,
    *,
    rig: Rig,
    again: str | Path | None = None,
    mode_near: float | None = None,
    modal_mass: float | None = None,
    large: str | Path | None = None,
    vibration_amplitude: float | None = None,
) -> Sheet:
    """Normal stiffness of a contact and its decay length, by the shift of a resonance from free to pressed.

    Parameters
    ----------
    free : str or Path
        Spectrum with the contact lifted: impedance, or vibration over frequency.
    pressed : str or Path
        Under the load of the rig.
    rig : Rig
        For its load and its structure.
    again : str or Path, optional
        Lifted again, after the pressed one; the drift then is part of the interval.
    mode_near : float, optional
        Frequency of the free resonance to take, in Hz; zero for a mode that floats, the strongest where absent.
    modal_mass : float, optional
        Of the mode at the contact, instead of the rig's structure. [kg]
    large : str or Path, optional
        Under the load at large drive, of constant amplitude.
    vibration_amplitude : float, optional
        That amplitude at the contact, zero to peak. [m]

    Returns
    -------
    Sheet
        The same values as `sonolube measure stiffness` prints.

    Raises
    ------
    InvalidInput
        If a file cannot be read or shows no resonance, or the rig has no structure and no modal mass is given.
    """
    settings = StiffnessSettings(
        normal_load=rig.normal_load,
        structure=None if modal_mass is not None else rig.structure,
        modal_mass=modal_mass,
        mode_near=mode_near,
        vibration_amplitude=vibration_amplitude,
    )
    second, loud = (None if path is None else Path(path) for path in (again, large))
    return contact_stiffness_sheet(Path(free), Path(pressed), settings=settings, again=second, large=loud)[0]


def _lateral(spacing: str | None, length_unit: str | None) -> SurfaceSettings:
    """Settings of a file that may lack spacing and unit."""
    along_x, along_y = spacings(spacing, name="spacing")
    return SurfaceSettings(spacing_x=along_x, spacing_y=along_y, length_unit=length_unit)
