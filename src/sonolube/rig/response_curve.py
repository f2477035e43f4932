"""Response curve of a rig over drive voltage or frequency through its folds: amplitude, friction, jumps; its figure."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from sonolube import __version__
from sonolube.charts import Axis, Chart, Line, Panel, Part, Points
from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.models.contact import ContactMotion
from sonolube.models.dynamics import force_decay_length, modes
from sonolube.models.dynamics.continuation import ResponseCurve, response_curve
from sonolube.models.dynamics.free_vibration import Backbone, backbone
from sonolube.models.dynamics.structure import with_contact_spring
from sonolube.rig.datasets import LabelledArray, LabelledArrays, labels
from sonolube.rig.driven_rig import DrivenRig
from sonolube.rig.friction_and_wear import friction_at_speeds
from sonolube.rig.record import Rig
from sonolube.rig.resolved_rig import ResolvedRig, resolved_rig

_SAMPLES = 256  # of a period
_BACKBONE = 41  # amplitudes of the backbone
_AXES = {"voltage": ("Drive voltage, peak to peak", "V", 1.0), "frequency": ("Frequency", "kHz", 1e-3)}
_SMALLEST = 1e-3  # amplitude of the backbone, of the largest of the curve


@dataclass(frozen=True, kw_only=True, slots=True)
class Jump:
    """Jump of the vibration at a fold, under a slow ramp of voltage or frequency.

    Parameters
    ----------
    at : float
        Voltage peak to peak, in V, or frequency, in Hz, of the fold.
    is_rising : bool
        Whether the ramp goes up.
    before, after : float
        Amplitude of the vibration on both sides of the jump, in m.
    """

    at: float
    is_rising: bool
    before: float
    after: float


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class RigResponseCurve:
    """Steady vibrations and friction of a rig along a branch, in the order of continuation.

    Parameters
    ----------
    along : {"voltage", "frequency"}
    voltage_peak_to_peak : ndarray, shape (n,)
        Of the drive. [V]
    frequency : ndarray, shape (n,)
        Of the drive. [Hz]
    vibration_amplitude : ndarray, shape (n,)
        Half of the displacement of the tip from peak to peak. [m]
    friction_ratio : ndarray, shape (n,)
        Friction with vibration over friction without; NaN where the friction model has no meaning. []
    stable : ndarray of bool, shape (n,)
        Whether small disturbances of the vibration die out.
    folds : ndarray of int
        Places at which the branch turns back.
    rising, falling : ndarray of int
        Places that a slow ramp up, and one down, passes through, in the order of the branch.
    backbone : Backbone or None
        Natural frequency over the amplitude, without damping and drive; None along the voltage.
    complete : bool
        Whether the branch reached the end of its range.
    """

    along: Literal["voltage", "frequency"]
    voltage_peak_to_peak: Floats
    frequency: Floats
    vibration_amplitude: Floats
    friction_ratio: Floats
    stable: NDArray[np.bool_]
    folds: NDArray[np.intp]
    rising: NDArray[np.intp]
    falling: NDArray[np.intp]
    backbone: Backbone | None
    complete: bool

    @property
    def parameter(self) -> Floats:
        """Voltage peak to peak, in V, or frequency, in Hz."""
        return self.voltage_peak_to_peak if self.along == "voltage" else self.frequency

    @property
    def jumps(self) -> tuple[Jump, ...]:
        """Jumps of slow ramps over the whole range, those up first, each ramp in its own order."""
        up, down = self.rising, self.falling[::-1]
        return (*self._jumps(up, is_rising=True), *self._jumps(down, is_rising=False))

    def _jumps(self, passed: NDArray[np.intp], *, is_rising: bool) -> list[Jump]:
        """Jumps of a ramp, where it leaves out part of the branch."""
        left = np.flatnonzero(np.abs(np.diff(passed)) > 1)
        ends = [(int(passed[i]), int(passed[i + 1])) for i in left]
        x, amplitude = self.parameter, self.vibration_amplitude
        return [
            Jump(at=float(x[a]), is_rising=is_rising, before=float(amplitude[a]), after=float(amplitude[b]))
            for a, b in ends
        ]


def rig_response_curve(
    rig: Rig | ResolvedRig, *, along: Literal["voltage", "frequency"], lowest: float, highest: float
) -> RigResponseCurve:
    """Response curve of a rig over a range of drive voltage or frequency, through its folds.

    Parameters
    ----------
    rig : Rig or ResolvedRig
        With a stack and a structure, and a sinusoidal drive that keeps its other entries.
    along : {"voltage", "frequency"}
    lowest, highest : float
        Ends of the range: voltage peak to peak, in V, or frequency, in Hz.

    Returns
    -------
    RigResponseCurve

    Raises
    ------
    InvalidInput
        If the rig has no structure, the drive no sine, the range is none, or no vibration was found at its begin.

    Notes
    -----
    The branch is followed by `sonolube.models.dynamics.response_curve`. A slow ramp is taken to follow it to a fold
    and to jump there to the next vibration under the same drive.
    """
    if not 0 < lowest < highest:
        raise InvalidInput(f"the range must be positive and rise, got {lowest:g} to {highest:g}")
    resolved = resolved_rig(rig)
    driven = resolved.moved
    drive = driven.drive
    if drive.waveform != "sine":
        raise InvalidInput(f"drive.waveform is {drive.waveform}; a response curve is that of a sine")
    volts = drive.voltage_peak_to_peak or 0.0
    found = response_curve(
        driven.structure,
        resolved.gap_law,
        normal_load=driven.normal_load,
        voltage_amplitude=(lowest / 2, highest / 2) if along == "voltage" else volts / 2,
        frequency=(lowest, highest) if along == "frequency" else drive.frequency,
    )
    parameter = found.parameter
    rising = np.flatnonzero(parameter >= np.maximum.accumulate(parameter))
    falling = np.flatnonzero(parameter <= np.minimum.accumulate(parameter[::-1])[::-1])
    return RigResponseCurve(
        along=along,
        voltage_peak_to_peak=2 * found.voltage_amplitude,
        frequency=found.frequency,
        vibration_amplitude=found.vibration_amplitude,
        friction_ratio=_friction_ratios(resolved, found),
        stable=found.stable,
        folds=found.folds,
        rising=rising,
        falling=falling,
        backbone=_backbone(driven, found) if along == "frequency" else None,
        complete=found.complete,
    )


def _friction_ratios(resolved: ResolvedRig, curve: ResponseCurve) -> Floats:
    """Friction ratio at each point of a curve by the rig's model."""
    rig, law = resolved.rig, resolved.gap_law
    order = np.arange(1, curve.harmonics.shape[1] + 1)
    waves = np.exp(2j * np.pi * order[:, None] * np.arange(_SAMPLES) / _SAMPLES)
    speeds = np.array([rig.sliding_speed])
    ratios = np.empty(curve.frequency.size)
    for place, displacement in enumerate(curve.mean_displacement[:, None] + (curve.harmonics @ waves).real):
        motion = ContactMotion(
            displacement=displacement,
            normal_force=np.asarray(law.force(displacement, np.float64(rig.normal_load))),
            frequency=float(curve.frequency[place]),
            normal_load=rig.normal_load,
        )
        ratios[place] = friction_at_speeds(rig, motion, speeds).friction_ratio[0]
    return ratios


def _backbone(rig: DrivenRig, curve: ResponseCurve) -> Backbone:
    """Backbone of the mode of a curve's peak, which a softening contact has bent to lower frequencies."""
    peak = int(curve.vibration_amplitude.argmax())
    law, at = curve.equations.gap_law, float(curve.frequency[peak])
    spring = rig.normal_load / float(force_decay_length(law, rig.normal_load))
    small = modes(with_contact_spring(rig.structure, normal_stiffness=spring)).natural_frequency
    higher = small[small >= at]
    return backbone(
        rig.structure,
        law,
        normal_load=rig.normal_load,
        displacement=np.linspace(_SMALLEST, 1.0, _BACKBONE) * abs(complex(curve.harmonics[peak, 0])),
        frequency=float(higher.min() if higher.size else small.max()),
    )


def response_curve_chart(rig: Rig, result: RigResponseCurve) -> Chart:
    """Amplitude and friction ratio along the branch: stable, unstable, jumps of slow ramps, and the backbone."""
    label, unit, scale = _AXES[result.along]
    parameter = scale * result.parameter
    ends = float(parameter.min()), float(parameter.max())
    x = Axis(label=label, unit=unit, lowest=ends[0], highest=ends[1])
    amplitude = 1e6 * result.vibration_amplitude
    above: list[Part] = []
    if result.backbone is not None:
        inside = scale * result.backbone.frequency
        shown = (inside >= ends[0]) & (inside <= ends[1])
        height = 1e6 * result.backbone.vibration_amplitude
        above.append(Line(x=inside[shown], y=height[shown], label="backbone", colour="0.7"))
    above += _branch(parameter, amplitude, result)
    panels = [Panel(x=x, y=Axis(label="Amplitude", unit="µm", lowest=0.0), parts=tuple(above))]
    if not np.isnan(result.friction_ratio).all():
        below = _branch(parameter, result.friction_ratio, result)
        panels.append(Panel(x=x, y=Axis(label="Friction ratio", lowest=0.0), parts=tuple(below)))
    return Chart(panels=tuple(panels), size=(5.2, 5.0), title=rig.title, legend="top", shares_x=True)


def _branch(x: Floats, y: Floats, result: RigResponseCurve) -> list[Part]:
    """Stable and unstable parts of the branch, and what slow ramps jump over."""
    stable = result.stable
    unstable = ~stable
    unstable[:-1] |= ~stable[1:]  # with its stable neighbours, so that no gap is left
    unstable[1:] |= ~stable[:-1]
    parts: list[Part] = [Line(x=x, y=np.where(stable, y, np.nan), label="stable")]
    if not stable.all():
        parts.append(Line(x=x, y=np.where(unstable, y, np.nan), label="unstable", colour=0, dash=1))
    ramps = (result.rising, "slow ramp up"), (result.falling[::-1], "slow ramp down")
    for place, (passed, label) in enumerate(ramps):
        left = np.flatnonzero(np.abs(np.diff(passed)) > 1)
        if left.size:
            first, last = passed[left], passed[left + 1]
            gaps = np.full(left.size, np.nan)
            parts.append(
                Line(
                    x=np.stack([x[first], x[first], gaps], axis=1).ravel(),
                    y=np.stack([y[first], y[last], gaps], axis=1).ravel(),
                    label=f"jump of a {label}",
                    colour=1 + place,
                    dash=2,
                )
            )
            parts.append(Points(x=x[first], y=y[last], colour=1 + place, marker=place))
    return parts


def response_curve_arrays(rig: Rig, result: RigResponseCurve) -> LabelledArrays:
    """Branch over its points: voltage, frequency, amplitude, friction ratio, and whether each is stable."""
    names = ("voltage_peak_to_peak", "frequency", "vibration_amplitude", "friction_ratio")
    variables = {
        name: LabelledArray(dims=("point",), values=getattr(result, name), attrs=labels(name)) for name in names
    }
    words = np.where(result.stable, "stable", "unstable")
    about = {"long_name": "whether small disturbances of the vibration die out"}
    return LabelledArrays(
        variables=variables | {"stability": LabelledArray(dims=("point",), values=words, attrs=about)},
        coordinates={},
        attrs={"title": f"Response curve of {rig.title}", "source": f"sonolube {__version__}"},
    )
