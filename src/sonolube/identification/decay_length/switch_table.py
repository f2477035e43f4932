"""Table of the switches of the vibration in one run, from friction to frequency shifts, and its conditions."""

from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.measurement.measured_files import refuse_unreadable
from sonolube.measurement.measured_runs import run_caveats
from sonolube.measurement.recordings.mapping import RecordingMapping
from sonolube.storage.user_files import open_input

if TYPE_CHECKING:
    import xarray as xr

SHORT_DECAY_LENGTH: Final = 0.7e-6
"""Decay length that the published sets B, G and H ask for. [m]"""

LONG_DECAY_LENGTH: Final = 2.0e-6
"""Decay length that the published sets A and C to F ask for. [m]"""


@dataclass(frozen=True, kw_only=True, slots=True)
class SwitchConditions:
    """Settings of the run, constant throughout.

    Parameters
    ----------
    normal_load : float
        Force pressing the bodies together. [N]
    vibration_amplitude : float
        Amplitude along the surface normal at the beginning. [m]
    frequency : float
        Frequency of the vibration. [Hz]
    sliding_speed : float
        Sliding speed. [m/s]
    large_drive_amplitude : float, optional
        Amplitude of the slow mode at the contact at large drive; that of the vibration where absent. [m]
    natural_frequency : float, optional
        Of the slow mode with the pin free; without it shifts are taken as small against it. [Hz]
    modal_mass : float, optional
        Of the slow mode at the contact; with the natural frequency it makes shifts contact stiffnesses. [kg]

    Raises
    ------
    InvalidInput
        If a value is not positive.
    """

    normal_load: float = 5.0
    vibration_amplitude: float = 2.3e-6
    frequency: float = 22e3
    sliding_speed: float = 65e-3
    large_drive_amplitude: float | None = None
    natural_frequency: float | None = None
    modal_mass: float | None = None

    def __post_init__(self) -> None:
        for name, value in asdict(self).items():
            if value is not None:
                require_positive(**{name: value})


MIN_SWITCHES = 8
"""Switches with friction and zero below which nothing is decided."""

_HEAD = 4096  # bytes of a file in which a table names its columns
_UTF_16 = (b"\xff\xfe", b"\xfe\xff")
_DISTANCES = ("sliding_distance", "sliding distance", "gleitweg")
_TIMES = ("time", "zeit")
_MEASURED = ("friction_force", "intrinsic_friction_force", "force_zero")
_OPTIONAL = ("stack_current", "small_drive_shift", "large_drive_shift")


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class SwitchTable:
    """Readings at the switches of the vibration in one run, in the order of the sliding distance.

    Parameters
    ----------
    sliding_distance : ndarray, shape (switches,)
        Slid on the track until the switch. [m]
    friction_force : ndarray, shape (switches,)
        Reading with vibration beside the switch, zero not subtracted. [N]
    intrinsic_friction_force : ndarray, shape (switches,)
        Reading without vibration beside the switch, zero not subtracted. [N]
    force_zero : ndarray, shape (switches,)
        Reading with the pin lifted; NaN where it was not lifted. [N]
    stack_current : ndarray, shape (switches,), optional
        Current into the stack at constant voltage, as amplitude or rms throughout. [A]
    small_drive_shift : ndarray, shape (switches,), optional
        Rise of a slow natural frequency from the free to the pressed pin, at small drive. [Hz]
    large_drive_shift : ndarray, shape (switches,), optional
        The same at large drive. [Hz]
    friction_force_uncertainty : ndarray, shape (switches,), optional
        Standard uncertainty; estimated from the scatter where absent, as all others. [N]
    intrinsic_friction_force_uncertainty : ndarray, shape (switches,), optional
        Of the reading without vibration. [N]
    force_zero_uncertainty : ndarray, shape (switches,), optional
        Of the zero. [N]
    stack_current_uncertainty : ndarray, shape (switches,), optional
        Of the current. [A]
    small_drive_shift_uncertainty : ndarray, shape (switches,), optional
        Of the shift at small drive. [Hz]
    large_drive_shift_uncertainty : ndarray, shape (switches,), optional
        Of the shift at large drive. [Hz]
    title : str
        Name of the run.
    caveats : tuple of str
        Of the reading, a line each.

    Raises
    ------
    InvalidInput
        If there are fewer than eight switches with friction and zero, the distances do not increase, the shapes
        differ, a current or an uncertainty is not positive, or the friction without vibration is not above the zero.
    """

    sliding_distance: Floats
    friction_force: Floats
    intrinsic_friction_force: Floats
    force_zero: Floats
    stack_current: Floats | None = None
    small_drive_shift: Floats | None = None
    large_drive_shift: Floats | None = None
    friction_force_uncertainty: Floats | None = None
    intrinsic_friction_force_uncertainty: Floats | None = None
    force_zero_uncertainty: Floats | None = None
    stack_current_uncertainty: Floats | None = None
    small_drive_shift_uncertainty: Floats | None = None
    large_drive_shift_uncertainty: Floats | None = None
    title: str = "run"
    caveats: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        self._check_shapes()
        known = np.isfinite(self.friction_force + self.intrinsic_friction_force + self.force_zero)
        if np.count_nonzero(known) < MIN_SWITCHES:
            raise InvalidInput(
                f"{self.title}: {np.count_nonzero(known)} switches with friction and zero; at least {MIN_SWITCHES} are"
                " needed: lift the pin at every switch"
            )
        if np.any(np.diff(self.sliding_distance) <= 0) or not np.all(np.isfinite(self.sliding_distance)):
            raise InvalidInput(f"{self.title}: sliding_distance must increase from switch to switch")
        free = self.intrinsic_friction_force - self.force_zero
        if np.any(free[known] <= 0):
            place = int(np.flatnonzero(known)[np.argmax(free[known] <= 0)])
            raise InvalidInput(
                f"{self.title}: intrinsic_friction_force must lie above force_zero, got"
                f" {self.intrinsic_friction_force[place]:g} N over {self.force_zero[place]:g} N at switch {place + 1}:"
                " give friction a positive sign"
            )

    def _check_shapes(self) -> None:
        """Refuse columns of other lengths, and what must be positive and is not."""
        for field in fields(self):
            values = getattr(self, field.name)
            if not isinstance(values, np.ndarray):
                continue
            if values.shape != self.sliding_distance.shape:
                raise InvalidInput(
                    f"{field.name} must have a value for each of the {self.sliding_distance.size} switches, got shape"
                    f" {values.shape}"
                )
            if field.name == "stack_current" or field.name.endswith("_uncertainty"):
                require_positive(**{field.name: values[~np.isnan(values)]})

    @property
    def missing(self) -> tuple[str, ...]:
        """Names of the readings that fewer than eight switches have: current and shifts."""
        return tuple(
            name
            for name in _OPTIONAL
            if (values := getattr(self, name)) is None or np.count_nonzero(np.isfinite(values)) < MIN_SWITCHES
        )


def switch_table(runs: "xr.Dataset") -> SwitchTable:
    """Readings at the switches of one run from a table of runs.

    Parameters
    ----------
    runs : xarray.Dataset
        Over `run`, as `sonolube.measurement.measured_runs.read_runs` returns it, with the variables
        `sliding_distance`, `friction_force`, `intrinsic_friction_force` and `force_zero`, and `stack_current`,
        `small_drive_shift`, `large_drive_shift` and standard uncertainties (`..._uncertainty`) where they are known.

    Returns
    -------
    SwitchTable

    Raises
    ------
    InvalidInput
        If a variable is missing, or as `SwitchTable`.

    See Also
    --------
    recorded_switches : The same from a recording.
    """
    title = str(runs.attrs.get("title", "table")).removesuffix(", in %")
    for name in ("sliding_distance", *_MEASURED):
        if name not in runs:
            remedy = "the reading with the pin lifted" if name == "force_zero" else "a value for each switch"
            raise InvalidInput(f"{title}: has no column {name}: add it, {remedy}")
    names = {field.name for field in fields(SwitchTable)} - {"title", "caveats"}
    order = np.argsort(runs["sliding_distance"].to_numpy(), kind="stable")
    columns = {name: runs[name].to_numpy()[order] for name in names if name in runs}
    needed = ("sliding_distance", *_MEASURED)
    stated = {name: values for name, values in columns.items() if name in needed or np.isfinite(values).any()}
    return SwitchTable(**stated, title=title, caveats=run_caveats(runs))


def is_switch_table(file: Path, mapping: RecordingMapping | None) -> bool:
    """Whether a file is a table of switches: its mapping or its head names the sliding distance and no time."""
    if mapping is not None and "sliding_distance" in mapping.channels:
        return mapping.axis is None
    with refuse_unreadable(file), open_input(file) as stream:
        head = stream.read(_HEAD)
    lines = head.decode("utf-16" if head[:2] in _UTF_16 else "latin-1", errors="ignore").splitlines()
    labels = next((line.lower() for line in lines if line.strip() and not line.startswith("#")), "")
    return any(name in labels for name in _DISTANCES) and not any(name in labels for name in _TIMES)
