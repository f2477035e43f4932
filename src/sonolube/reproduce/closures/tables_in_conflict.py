"""Table 2.3 against Table 4.2: of friction 0.71 is left at 87 mm/s and 2.5 um, 0.04 at 65.5 mm/s and 2.3 um.

Every mechanism is fitted to both tables at once, eight ratios, and priced by what it leaves free.

Normal vibration alone cannot: with Mindlin's memory length the ratio is exactly 1 above v_c = mu omega a k_n/k_t, at
most 71 mm/s in Table 4.2, and with any memory length it stays above exp(-beta)/I0(beta), 0.23 at 2.31 um. Motion along
the sliding gives Table 4.2 to a few hundredths, but only one nearly as large as the normal motion, and one that the
same rig does not have in Table 2.3. A zero error of the string that explains it is as large as the whole friction read.
Within bounds that a rig could keep, none gives both tables within their scatter.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from math import pi
from typing import Final

from sonolube.checks import Floats
from sonolube.contact import decay_length, separation
from sonolube.friction import mindlin_memory_length
from sonolube.reproduce.row import Row, compare
from sonolube.validation.closures import ClosureVariant, mindlin_stick_slip, stick_slip_in_plane
from sonolube.validation.fit import Errors, Fit, Information, errors_of, fitted, information, measured_in
from sonolube.validation.friction_tests import FrictionTest
from sonolube.validation.parameters import IN_PLANE, MEMORY, RIGS, Parameter, of_rigs

BOTH: Final = "AB"
"""The sets of Tables 2.3 and 4.2."""

REPORTED: Final = ("normal-mindlin", "in-plane-unbounded", "zero-error-unbounded")
"""Mechanisms whose predictions stand in the report point by point; a figure shows more."""

SLACK: Final = 0.35
"""Zero error of a slack string that would bring the lowest reading above what normal vibration leaves at least. [N]"""

_ZERO: Final = Parameter(
    name="zero_error",
    unit="N",
    rest=0.0,
    start=(0.1, 0.3),
    low=0.0,
    high=SLACK,
    reason="About what static friction reads above sliding friction, 1.2 N over 0.89 N: a slip of the string by more "
    "would show at every start.",
)
_ANY_ZERO: Final = replace(_ZERO, high=5.0, start=(0.3, 1.0), reason="None: to see what is needed.")
_FRACTION, _PHASE = IN_PLANE
_ANY_IN_PLANE: Final = (replace(_FRACTION, high=3.0, start=(0.3, 0.8), reason="None: to see what is needed."), _PHASE)


@dataclass(frozen=True, kw_only=True, slots=True)
class Mechanism:
    """One mechanism on both tables.

    Parameters
    ----------
    fit : Fit
        To both.
    normal_tables, power_map : Errors
        Of Table 2.3, and of Table 4.2.
    information : Information or None
        Over both.
    """

    fit: Fit
    normal_tables: Errors
    power_map: Errors
    information: Information | None


@cache
def mechanisms() -> tuple[Mechanism, ...]:
    """Return every mechanism, fitted to both tables."""
    found = []
    for variant in MECHANISMS:
        fit = fitted(variant, BOTH)
        found.append(
            Mechanism(
                fit=fit,
                normal_tables=errors_of(fit, measured_in("A")),
                power_map=errors_of(fit, measured_in("B")),
                information=information(fit, measured_in(BOTH)),
            )
        )
    return tuple(found)


def speeds_of_no_reduction() -> Floats:
    """Return for each test of Table 4.2 the sliding speed from which on normal vibration changes nothing. [m/s]

    Notes
    -----
    v_c = mu omega a k_n/k_t after Mindlin, the same as omega a D_c/l with his memory length.
    """
    import numpy as np

    return np.array([_speed_of_no_reduction(test) for test in measured_in("B")])


def rows() -> Iterator[Row]:
    """Yield one row for each reduction of Table 4.2 and each mechanism reported."""
    for fit in (mechanism.fit for mechanism in mechanisms() if mechanism.fit.variant.name in REPORTED):
        told = ", ".join(
            f"{one.name} {value:.3g} {one.unit}".rstrip()
            for one, value in zip(fit.variant.parameters, fit.values, strict=True)
        )
        for test in measured_in("B"):
            ratio = fit.predict(test)
            assert ratio is not None
            assert test.published is not None
            yield compare(
                replace(test.published, id=f"dispute-{fit.variant.name}-{test.label}"),
                1 - ratio,
                f"{fit.variant.meaning[0].upper()}{fit.variant.meaning[1:]}; Tables 2.3 and 4.2 fitted together: "
                f"{told or 'nothing free'}. Ratio {ratio:.3f}, measured {test.friction_ratio:.3f}.",
            )


def _speed_of_no_reduction(test: FrictionTest) -> float:
    length = decay_length(test.contact, separation=separation(test.contact, normal_load=test.normal_load))
    memory = mindlin_memory_length(
        test.contact, friction_coefficient=test.friction_coefficient, normal_load=test.normal_load
    )
    return float(2 * pi * test.frequency * test.vibration_amplitude * memory / length)


def _read_with_zero_error(
    test: FrictionTest,
    memory_length: float,
    zero_error: float = 0.0,
    in_plane_fraction: float = 0.0,
    phase: float = 0.0,
) -> float:
    """Return the ratio of two readings that both miss the same force."""
    ratio = stick_slip_in_plane(test, memory_length=memory_length, in_plane_fraction=in_plane_fraction, phase=phase)
    read = test.friction_coefficient * test.normal_load
    return (ratio * (read + zero_error) - zero_error) / read


def _read_with_slack(test: FrictionTest, memory_length: float) -> float:
    return _read_with_zero_error(test, memory_length, SLACK if test.set_name in RIGS["power map"] else 0.0)


_OF_MAP: Final = "power map"

MECHANISMS: Final = tuple(
    ClosureVariant(name=name, meaning=meaning, parameters=parameters, ratio=ratio)
    for name, meaning, parameters, ratio in (
        ("normal-mindlin", "normal vibration, Mindlin's memory length", (), mindlin_stick_slip),
        ("normal", "normal vibration, one memory length", (MEMORY,), stick_slip_in_plane),
        (
            "normal-own-memory",
            "normal vibration, each table its own memory length",
            of_rigs((MEMORY,), "tribometer", _OF_MAP),
            stick_slip_in_plane,
        ),
        (
            "in-plane",
            "in-plane motion up to half the normal one in Table 4.2",
            (MEMORY, *of_rigs(IN_PLANE, _OF_MAP)),
            stick_slip_in_plane,
        ),
        (
            "in-plane-unbounded",
            "in-plane motion of any size in Table 4.2",
            (MEMORY, *of_rigs(_ANY_IN_PLANE, _OF_MAP)),
            stick_slip_in_plane,
        ),
        (
            "in-plane-in-both",
            "the same in-plane motion of any size in both tables",
            (MEMORY, *_ANY_IN_PLANE),
            stick_slip_in_plane,
        ),
        ("slack-string", f"a zero error of {SLACK:g} N in Table 4.2", (MEMORY,), _read_with_slack),
        (
            "zero-error-unbounded",
            "a zero error of any size in Table 4.2",
            (MEMORY, *of_rigs((_ANY_ZERO,), _OF_MAP)),
            _read_with_zero_error,
        ),
        (
            "in-plane-and-slack",
            f"in-plane motion up to half the normal one and a zero error up to {SLACK:g} N in Table 4.2",
            (MEMORY, *of_rigs((_ZERO, *IN_PLANE), _OF_MAP)),
            _read_with_zero_error,
        ),
    )
)
"""What could explain both tables."""
