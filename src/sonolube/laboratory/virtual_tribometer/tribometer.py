"""Virtual tribometer: acquisition, drive source and motor that share one clock and one virtual rig."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Final

from sonolube.facts.protocol import Protocol
from sonolube.laboratory.block import Block, Channel
from sonolube.laboratory.devices import DeviceError, Devices, DriveSetting
from sonolube.laboratory.heating_assumptions import HeatingAssumptions
from sonolube.laboratory.virtual_tribometer.disturbances import Disturbances
from sonolube.laboratory.virtual_tribometer.pace import ExpectedTime, expected_time
from sonolube.laboratory.virtual_tribometer.simulation import CHANNELS, VOLTAGE_MAXIMUM, VirtualRig
from sonolube.prediction.evidence_posterior import EvidencePosterior
from sonolube.rig import Rig
from sonolube.text.units import format_si

if TYPE_CHECKING:
    import xarray as xr

GROOVE_DIAMETER: Final = 0.05
"""Of the circle under the pin, where none is given. [m]"""

_TURNS: Final = 20.0  # 1/s, of the motor
_FASTEST: Final = 10e6  # Hz, of acquisition and generator


def virtual_tribometer(
    rig: Rig,
    *,
    seed: int,
    real_time: bool = False,
    disturbances: Disturbances | None = None,
    groove_diameter: float = GROOVE_DIAMETER,
    heating: HeatingAssumptions | None = None,
    evidence: EvidencePosterior | None = None,
) -> "VirtualTribometer":
    """Virtual tribometer of a rig.

    Parameters
    ----------
    rig : Rig
        With a drive.
    seed : int
        Of everything that is drawn: the same seed gives the same samples, whatever the size of the blocks.
    real_time : bool
        Whether blocks come when the clock on the wall says; else as fast as they can be computed.
    disturbances : Disturbances, optional
        Of tests with the rig; those of this test scatter about them. The usual ones by default.
    groove_diameter : float
        Of the circle under the pin. [m]
    heating : HeatingAssumptions, optional
        Thermal properties that a rig file does not hold; as in a dry run by default.
    evidence : EvidencePosterior, optional
        Posterior that friction is drawn from, in place of the shipped one.

    Returns
    -------
    VirtualTribometer

    Raises
    ------
    InvalidInput
        If the rig does not slide, does not vibrate or has no drive.
    """
    sizes, assumed = disturbances or Disturbances(), heating or HeatingAssumptions()
    virtual = VirtualRig(rig, seed, sizes, assumed, groove_diameter, real_time, evidence=evidence)
    described = {"device": "virtual tribometer", "rig": rig.title, "seed": str(seed)}
    return VirtualTribometer(virtual, described, groove_diameter)


class VirtualTribometer:
    """A virtual rig with its devices; made by `virtual_tribometer`."""

    def __init__(self, virtual: VirtualRig, description: Mapping[str, str], groove_diameter: float) -> None:
        self._virtual, self._diameter = virtual, groove_diameter
        self.devices = Devices(
            acquisition=_Acquisition(virtual),
            drive=_Drive(virtual),
            motor=_Motor(virtual),
            description=description,
            groove_diameter=groove_diameter,
            simulated=True,
            prepare=virtual.prepare,
            attend=virtual.attend,
            clock=virtual.clock,
        )

    def expected_time(self, protocol: Protocol) -> ExpectedTime:
        """Time that a protocol is expected to take, by a few blocks and set points.

        Parameters
        ----------
        protocol : Protocol

        Returns
        -------
        ExpectedTime
        """
        return expected_time(self._virtual, protocol, channels=CHANNELS, groove_diameter=self._diameter)

    def truth(self) -> "xr.Dataset":
        """Truth of the recording: friction of each setting, worn in, and every size that was drawn.

        Returns
        -------
        xarray.Dataset
            Over `setting`: start time, speed, drive, amplitude, friction force and ratio, wear rate and flash rise; as
            numbers the wear volume, the sliding distance, temperatures and every size of the disturbances. All in SI,
            with their units.
        """
        return self._virtual.truth()


class _Connected:
    """A device of the virtual rig, which does nothing before it is connected."""

    name = ""

    def __init__(self, rig: VirtualRig) -> None:
        self._rig, self._is_connected = rig, False

    def connect(self) -> None:
        """Connect with everything off."""
        self._is_connected = True
        self.off()

    def off(self) -> None:
        """Switch off motor or drive of the device."""

    def close(self) -> None:
        """Switch off and disconnect."""
        self.off()
        self._is_connected = False

    def _require_connected(self) -> None:
        """Refuse to act before `connect`."""
        if not self._is_connected:
            raise DeviceError(f"{self.name}: is not connected; call connect first")


class _Acquisition(_Connected):
    """Inputs of the virtual tribometer."""

    name = "virtual acquisition"

    @property
    def channels(self) -> Mapping[str, Channel]:
        """Channels that can be recorded."""
        return self._rig.channels

    def start(self, channels: Sequence[str], *, sample_rate: float) -> float:
        """Start to sample."""
        self._require_connected()
        unknown = [name for name in channels if name not in self.channels]
        if unknown or not channels:
            raise DeviceError(f"{self.name}: no channel {', '.join(unknown) or 'named'}; known: {', '.join(CHANNELS)}")
        if not 0 < sample_rate <= _FASTEST:
            most = format_si(_FASTEST, "Hz")
            raise DeviceError(
                f"{self.name}: sample_rate of {sample_rate:g} Hz is refused; it must be above 0 and up to {most}"
            )
        self._rig.start(channels, sample_rate)
        return sample_rate

    def read(self, samples: int) -> Block:
        """Next samples."""
        return self._rig.read(samples)

    def stop(self) -> None:
        """Stop to sample."""
        self._rig.stop()

    def off(self) -> None:
        """Stop to sample."""
        self._rig.stop()


class _Drive(_Connected):
    """Generator and amplifier of the virtual tribometer."""

    name = "virtual amplifier"
    voltage_maximum = VOLTAGE_MAXIMUM

    def drive(self, setting: DriveSetting) -> None:
        """Set the output."""
        self._require_connected()
        reached = setting.voltage_maximum
        if not (setting.voltage_peak_to_peak >= 0 and reached <= VOLTAGE_MAXIMUM):
            wanted, most = format_si(reached, "V"), format_si(VOLTAGE_MAXIMUM, "V")
            raise DeviceError(f"{self.name}: {wanted} is refused; it gives 0 to {most}, the offset included")
        if not 0 < setting.frequency <= _FASTEST:
            raise DeviceError(f"{self.name}: a frequency of {setting.frequency:g} Hz is refused")
        self._rig.drive(setting if setting.voltage_peak_to_peak > 0 else None)

    def off(self) -> None:
        """Switch the output off."""
        self._rig.drive(None)


class _Motor(_Connected):
    """Motor of the virtual tribometer."""

    name = "virtual motor"
    rotation_speed_maximum = _TURNS

    def turn(self, rotation_speed: float) -> None:
        """Set the speed."""
        self._require_connected()
        if not 0 <= rotation_speed <= _TURNS:
            raise DeviceError(f"{self.name}: {rotation_speed:.4g} 1/s is refused; it turns at 0 to {_TURNS:g} 1/s")
        self._rig.turn(rotation_speed)

    def off(self) -> None:
        """Stop."""
        self._rig.turn(0.0)
