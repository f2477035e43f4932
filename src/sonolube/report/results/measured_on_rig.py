"""Published measurements of a rig under its own conditions, to stand beside its prediction."""

from dataclasses import dataclass
from typing import Any

from sonolube.rig import Rig
from sonolube.validation.published_tests import NORMAL_VIBRATION_SETS, FrictionTest, friction_tests

_SAME = 0.02  # relative difference of conditions that were rounded in print


@dataclass(frozen=True, kw_only=True)
class Measurement:
    """Measured friction ratio of a published test.

    Parameters
    ----------
    test : FrictionTest
    """

    test: FrictionTest

    @property
    def label(self) -> str:
        """Name of the test, such as "A-1"."""
        return self.test.label

    @property
    def text(self) -> str:
        """Friction ratio with its uncertainty, and where it was published."""
        error = "" if self.test.uncertainty is None else f" +- {self.test.uncertainty:.2g}"
        return f"friction ratio {self.test.friction_ratio:.3g}{error}: {NORMAL_VIBRATION_SETS[self.test.set_name]}"

    def object(self) -> dict[str, Any]:
        """Test, set, friction ratio and uncertainty for JSON."""
        return {
            "test": self.test.label,
            "set": NORMAL_VIBRATION_SETS[self.test.set_name],
            "friction_ratio": self.test.friction_ratio,
            "uncertainty": self.test.uncertainty,
        }


def measured_on(rig: Rig, *, vibration_amplitude: float) -> tuple[Measurement, ...]:
    """Published friction tests under the contact, load, speed, friction, frequency and amplitude of a rig.

    Roughness and asperity law are not compared: they are assumed for most tests.
    """
    if rig.drive is None:
        return ()
    own = {
        "normal_load": rig.normal_load,
        "sliding_speed": rig.sliding_speed,
        "friction_coefficient": rig.friction_coefficient,
        "frequency": rig.drive.frequency,
        "vibration_amplitude": vibration_amplitude,
    }
    return tuple(Measurement(test=test) for test in friction_tests() if _same_contact(rig, test) and _close(own, test))


def _same_contact(rig: Rig, test: FrictionTest) -> bool:
    pairs = (
        (rig.contact.nominal_area, test.contact.nominal_area),
        (rig.contact.pair.effective_modulus, test.contact.pair.effective_modulus),
        (rig.contact.pair.yield_strength, test.contact.pair.yield_strength),
    )
    return all(_near(own, other) for own, other in pairs)


def _close(own: dict[str, float], test: FrictionTest) -> bool:
    return all(_near(value, getattr(test, name)) for name, value in own.items())


def _near(own: float, other: float) -> bool:
    return abs(own - other) <= _SAME * abs(other)
