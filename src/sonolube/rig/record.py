"""Rig: two bodies in sliding contact, and the actuator that vibrates one of them."""

from collections.abc import Callable, Mapping
from copy import deepcopy
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final, Literal, Protocol, get_args

from sonolube.checks import require_non_negative, require_positive
from sonolube.errors import InvalidInput, UnknownName
from sonolube.models.actuator import PiezoStack
from sonolube.models.actuator.drive import Drive
from sonolube.models.contact import ExponentialHeights, RoughContact, decay_length
from sonolube.models.dynamics import Structure
from sonolube.models.friction.models import FRICTION_MODELS, FrictionModel
from sonolube.rig.distribution import Distribution
from sonolube.rig.vibration_direction import NORMAL, VibrationDirection
from sonolube.text.units import format_si

STATED = "as stated"
"""Beginning of the assumption about an amplitude that was stated before a test, not measured."""

AmplitudeSource = Literal["measured", "computed", "waveguide", "per-volt"]
"""Where the amplitude of a vibration comes from."""

AMPLITUDE_SOURCES: Final[tuple[AmplitudeSource, ...]] = get_args(AmplitudeSource)
"""Sources of an amplitude, the one taken first where a rig has several first."""

DecayLengthOrigin = Literal["own_runs", "normal_stiffness", "worn_scan", "published_tests", "stated"]
"""Origins of a decay length other than R_q/lambda."""

DECAY_LENGTH_ORIGINS: Final[Mapping[DecayLengthOrigin, str]] = MappingProxyType(
    {
        "own_runs": "from own friction tests",
        "normal_stiffness": "from the measured normal stiffness",
        "worn_scan": "from a scan of the worn track",
        "published_tests": "of worn contacts in published tests",
        "stated": "as stated",
    }
)
"""Origins of a decay length, each in words."""


def check_stated(check: Callable[..., object], record: object, *names: str) -> None:
    """Check those numbers of a record that are not None, each by its name."""
    for name in names:
        if (value := getattr(record, name)) is not None:
            check(**{name: value})


@dataclass(frozen=True, kw_only=True, slots=True)
class MeasuredUnder:
    """Drive and load under which an amplitude was measured; None where they are the rig's own.

    Parameters
    ----------
    voltage_peak_to_peak : float or None
        Difference of the highest and the lowest voltage. [V]
    frequency : float or None
        Frequency of the drive. [Hz]
    normal_load : float or None
        Force pressing the bodies together. [N]
    """

    voltage_peak_to_peak: float | None = None
    frequency: float | None = None
    normal_load: float | None = None

    def __post_init__(self) -> None:
        check_stated(require_positive, self, "voltage_peak_to_peak", "frequency", "normal_load")


class RigEntries(Protocol):
    """Entries of the file that a rig was read from."""

    @property
    def content(self) -> Mapping[str, Any]:
        """Tables and values as they are written."""

    @property
    def path(self) -> str:
        """Path of the file; empty where there is none."""

    @property
    def changes(self) -> tuple[str, ...]:
        """Entries that were replaced when it was read."""

    def replaced(self, key: str, value: str | float) -> "Rig":
        """Rig of the file with one entry replaced."""

    def write(self, path: str | Path) -> Path:
        """Write the file with its entries."""


@dataclass(frozen=True, kw_only=True, slots=True, repr=False)
class Rig:
    """One experiment or device: contact, load, sliding, friction and, where known, its drive and structure.

    Parameters
    ----------
    title : str
        What it is.
    source : str
        Where its numbers come from.
    contact : RoughContact
        The two rough surfaces.
    normal_load : float
        Force pressing the bodies together. [N]
    friction_coefficient : float
        Intrinsic coefficient of friction, measured without vibration. []
    sliding_speed : float
        Macroscopic relative speed. [m/s]
    vibration_amplitude : float or None
        Measured vibration in its direction, zero to peak. [m]
    measured_under : MeasuredUnder or None
        Drive and load of that measurement, where they are not the rig's own.
    amplitude_per_volt : float or None
        Amplitude per volt peak to peak, where it is known. [m/V]
    waveguide_amplitude : float or None
        Amplitude computed from the waveguide, where the rig has one, in m.
    amplitude_source : {"measured", "computed", "waveguide", "per-volt"} or None
        Source of the amplitude; the first of these that the rig has where None.
    direction : VibrationDirection
        Direction of the vibration, along the normal of the contact where nothing is said, and its second component.
    calibration : float or None
        Factor by which the drive of the structure was scaled to the measured amplitude, where it was.
    drive : Drive or None
        Electrical drive of the actuator, where it is known.
    capacitance : float or None
        Capacitance of the actuator, where it is known. [F]
    stack : PiezoStack or None
        Piezoelectric stack, where the structure is known.
    structure : Structure or None
        What the stack drives, where it is known.
    friction_model : FrictionModel
        Model of friction under vibration, with its parameters.
    pin_material, disc_material : str or None
        Name in the catalogue of materials, where the rig states it.
    decay_length_origin : {"own_runs", "normal_stiffness", "worn_scan", "published_tests", "stated"} or None
        How the decay length of the contact is known; None where its file has none, so that it is R_q/lambda.
    assumptions : mapping of str to str
        Which entries no source gives, and what was assumed instead and why.
    uncertainty : mapping of str to Distribution
        How uncertain entries are spread, by dotted key of the file.

    Examples
    --------
    >>> import sonolube as sl
    >>> rig = sl.read_rig("examples/rigs/tribometer.toml")
    >>> round(rig.friction_coefficient * rig.normal_load, 3)  # friction force without vibration, in N
    1.023
    """

    title: str
    source: str
    contact: RoughContact
    normal_load: float
    friction_coefficient: float
    sliding_speed: float
    vibration_amplitude: float | None = None
    measured_under: MeasuredUnder | None = None
    amplitude_per_volt: float | None = None
    waveguide_amplitude: float | None = None
    amplitude_source: AmplitudeSource | None = None
    direction: VibrationDirection = NORMAL
    calibration: float | None = None
    drive: Drive | None = None
    capacitance: float | None = None
    stack: PiezoStack | None = None
    structure: Structure | None = None
    friction_model: FrictionModel = field(default_factory=lambda: FRICTION_MODELS["asperity_stick_slip"]())
    pin_material: str | None = None
    disc_material: str | None = None
    decay_length_origin: DecayLengthOrigin | None = None
    assumptions: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    uncertainty: Mapping[str, Distribution] = field(default_factory=lambda: MappingProxyType({}))
    _entries: RigEntries | None = field(init=False, default=None, compare=False)

    def __post_init__(self) -> None:
        require_positive(normal_load=self.normal_load, friction_coefficient=self.friction_coefficient)
        require_non_negative(sliding_speed=self.sliding_speed)
        check_stated(require_non_negative, self, "vibration_amplitude", "amplitude_per_volt", "waveguide_amplitude")
        if self.amplitude_source is not None and self.amplitude_source not in AMPLITUDE_SOURCES:
            raise UnknownName.among(list(AMPLITUDE_SOURCES), kind="source of the amplitude", name=self.amplitude_source)
        if self.decay_length_origin is not None and self.decay_length_origin not in DECAY_LENGTH_ORIGINS:
            known = list(DECAY_LENGTH_ORIGINS)
            raise UnknownName.among(known, kind="origin of the decay length", name=self.decay_length_origin)
        check_stated(require_positive, self, "capacitance")
        if self.vibration_amplitude is not None:
            self.direction.require_amplitude(self.vibration_amplitude)
        if not self.title.strip():
            raise InvalidInput("title must not be empty")
        if len(self.title.splitlines()) > 1:
            raise InvalidInput(f"title must be one line, got {self.title[:60]!r}")

    def replace(self, key: str, value: str | float) -> "Rig":
        """Rig with one entry of its file replaced.

        Parameters
        ----------
        key : str
            Dotted key of the rig file, such as "drive.voltage_peak_to_peak".
        value : str or float
            As in the file: text with a unit, such as "14 V", or a pure number.

        Returns
        -------
        Rig

        Raises
        ------
        InvalidInput
            If the key is unknown or the value is not of its kind, or the rig was not read from a file.

        See Also
        --------
        to_toml

        Examples
        --------
        >>> import sonolube as sl
        >>> rig = sl.read_rig("examples/rigs/tribometer.toml")
        >>> rig.normal_load, rig.replace("contact.normal_load", "5 N").normal_load
        (3.0, 5.0)
        """
        return self._file().replaced(key, value)

    def to_toml(self, path: str | Path) -> Path:
        """Write the rig as a file that `read_rig` reads.

        Parameters
        ----------
        path : str or Path

        Returns
        -------
        Path
            Of the file; its comments are kept of a rig by `new_rig` only.

        Raises
        ------
        InvalidInput
            If it cannot be written, or the rig was not read from a file.
        """
        return self._file().write(path)

    def content(self) -> dict[str, Any]:
        """Content of the rig's file, its entries as they are written.

        Raises
        ------
        InvalidInput
            If the rig was not read from a file.
        """
        return deepcopy(dict(self._file().content))

    @property
    def file(self) -> Path | None:
        """Path of the file, or of the folder, that the rig was read from; None where there is none."""
        return Path(self._entries.path) if self._entries is not None and self._entries.path else None

    @property
    def changes(self) -> tuple[str, ...]:
        """Entries of the file that were replaced when it was read, such as "drive.frequency=22kHz"."""
        return () if self._entries is None else self._entries.changes

    @property
    def name(self) -> str:
        """Name for the rig's files: that of its own without ending, or its title in plain characters."""
        if self.file is not None:
            return self.file.resolve().name if self.file.is_dir() else self.file.stem
        return "-".join("".join(each if each.isalnum() else " " for each in self.title.lower()).split()) or "rig"

    def table(self) -> list[tuple[str, str]]:
        """Main quantities of the rig with their units, as rows of name and text."""
        pair, roughness = self.contact.pair, self.contact.roughness
        rows = [
            ("normal load", format_si(self.normal_load, "N")),
            ("sliding speed", format_si(self.sliding_speed, "m/s")),
            ("friction without vibration", f"coefficient {self.friction_coefficient:.3g}"),
            ("friction model", self.friction_model.name),
            ("nominal area", format_si(self.contact.nominal_area, "m2")),
            ("roughness", f"Rq {format_si(roughness.rms_height, 'm')}"),
            *self._decay_length_rows(),
            ("effective modulus", format_si(pair.effective_modulus, "Pa")),
            ("yield strength", format_si(pair.yield_strength, "Pa")),
            ("vibration amplitude", self._amplitude_text()),
        ]
        if not self.direction.is_normal:
            rows.append(("vibration direction", self.direction.text))
        if self.drive is not None:
            voltage = self.drive.voltage_peak_to_peak
            volts = [] if voltage is None else [f"{format_si(voltage, 'V')} peak to peak"]
            rows.append(("drive", ", ".join([*volts, format_si(self.drive.frequency, "Hz"), self.drive.waveform])))
        counts = [f"{len(self.assumptions)} assumptions", f"{len(self.uncertainty)} uncertain entries"]
        return [*rows, ("stated", ", ".join(counts))]

    def __repr__(self) -> str:
        width = max(len(name) for name, _ in self.table())
        return "\n".join([self.title, *(f"  {name:<{width}}  {text}" for name, text in self.table())])

    def _repr_html_(self) -> str:
        """Table for notebooks."""
        rows = "".join(f"<tr><th>{escape(name)}</th><td>{escape(text)}</td></tr>" for name, text in self.table())
        return f"<table><caption>{escape(self.title)}</caption><tbody>{rows}</tbody></table>"

    @property
    def has_stated_amplitude(self) -> bool:
        """Whether the amplitude was stated before a test, and its uncertainty still stands in the file."""
        key = "vibration.vibration_amplitude"
        return key in self.uncertainty and self.assumptions.get(key, "").startswith(STATED)

    def _decay_length_rows(self) -> list[tuple[str, str]]:
        """Decay length of the contact and where it is from; none for heights whose decay length varies."""
        heights, own = self.contact.heights, self.contact.decay_length
        if own is not None:
            return [
                ("decay length", f"{format_si(own, 'm')} {DECAY_LENGTH_ORIGINS[self.decay_length_origin or 'stated']}")
            ]
        if not isinstance(heights, ExponentialHeights):
            return []
        by_roughness = format_si(float(decay_length(self.contact)), "m")
        return [("decay length", f"{by_roughness} by roughness, Rq/{heights.decay:g}")]

    def _amplitude_text(self) -> str:
        """Every source that the rig has for its amplitude."""
        origin = "stated" if self.has_stated_amplitude else "measured"
        sources = [
            None if self.vibration_amplitude is None else f"{format_si(self.vibration_amplitude, 'm')} {origin}",
            None if self.structure is None else "computed from stack and structure",
            None if self.amplitude_per_volt is None else f"{format_si(self.amplitude_per_volt, 'm/V')}",
            None
            if self.waveguide_amplitude is None
            else f"{format_si(self.waveguide_amplitude, 'm')} by the waveguide",
        ]
        return "; ".join(text for text in sources if text)

    def _file(self) -> RigEntries:
        """Entries of the file."""
        if self._entries is None:
            raise InvalidInput(
                f"{self.title}: changed in Python since it was read, so that no file describes it; replace entries of"
                " the rig that read_rig returns"
            )
        return self._entries
