"""Published measurements of a rig under its own conditions, to stand beside its prediction."""

from collections.abc import Sequence
from dataclasses import dataclass
from operator import attrgetter
from typing import Any

from sonolube.rig import Rig
from sonolube.validation.published_tests import NORMAL_VIBRATION_SETS, FrictionTest, friction_tests

_OF_BOTH = attrgetter(
    *("contact.nominal_area", "contact.pair.effective_modulus", "contact.pair.yield_strength"),
    *("normal_load", "sliding_speed", "friction_coefficient"),
)
_OF_TEST = attrgetter("frequency", "vibration_amplitude")
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
    own = (*_OF_BOTH(rig), rig.drive.frequency, vibration_amplitude)
    return tuple(Measurement(test=test) for test in friction_tests() if _near(own, (*_OF_BOTH(test), *_OF_TEST(test))))


def _near(own: Sequence[float], printed: Sequence[float]) -> bool:
    """Whether conditions are those of a test as far as print rounds them."""
    return all(abs(one - other) <= _SAME * abs(other) for one, other in zip(own, printed, strict=True))
