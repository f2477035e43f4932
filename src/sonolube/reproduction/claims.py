"""Ten claims of the dissertation, and the findings on them."""

from collections.abc import Iterable
from typing import Final

from sonolube.reproduction.claim import Claim, Finding, counts, finding
from sonolube.reproduction.row import Row

_DEFAULT: Final = "friction-model-asperity-stick-slip-fitted"

CLAIMS: Final = (
    Claim(
        id="cube-friction",
        statement="The cube model errs by less than 20 % of friction on average",
        source="D 3.1.4, 3.1.5, 5.1.2",
        judged="Mean error over the loads of each test, at the amplitude of the waveguide in D 2.1.2; at that of D "
        "4.3.5 as the alternative beside each row. Of the tests only the range of the reduction is printed, so that it "
        "is taken to fall in proportion to the load.",
        decisive=("3.1.5-error-1-2", "3.1.5-error-3"),
        supporting=("3.1.4-reduction-1-2", "3.1.4-reduction-3", "3.1.4-error"),
    ),
    Claim(
        id="cube-wear",
        statement="The cube model errs by less than 15 % of wear",
        source="D 3.2.2, 3.2.3, 5.1.2",
        judged="Largest error over Tables 3.3 and 3.4, with the inputs of Table 3.2, nothing fitted.",
        decisive=("3.2.2-error", "3.2.3-error"),
        supporting=(*(f"table-3.3-error-{n}" for n in range(1, 7)), *(f"table-3.4-error-{n}" for n in range(1, 7))),
    ),
    Claim(
        id="multi-scale-friction",
        statement="The multi-scale model errs by less than 10 % of friction",
        source="D 3.3.4, 3.3.6, 5.1.2",
        judged="Largest error over Table 2.3 of D 3.46 to 3.48 as printed, on the computed motion of the tribometer; "
        "about no mean gap is it less than 14 %.",
        decisive=("3.3.4-error", "3.3.6-error"),
        supporting=tuple(f"{_DEFAULT}-A-{n}" for n in (1, 2, 3)),
    ),
    Claim(
        id="friction-over-speed",
        statement="Vibration reduces friction by 62, 36 and 29 % at 20.3, 40.6 and 87 mm/s",
        source="D 2.3.5, Tables 2.3 and 2.5",
        judged="Asperity stick-slip against the test, within the printed scatter of the forces; its memory length is "
        "fitted to the sets of tests that the note of each row names, this one among them.",
        decisive=tuple(f"{_DEFAULT}-A-{n}" for n in (1, 2, 3)),
        supporting=(
            *(f"table-2.5-friction-reduction-{n}" for n in (1, 2, 3)),
            *(f"table-2.3-friction-force-{n}" for n in (2, 4, 6)),
        ),
    ),
    Claim(
        id="wear-reduction",
        statement="Vibration reduces wear by 46 to 49 % at every speed",
        source="D 2.3.5, Table 2.5",
        judged="Arithmetic of the printed wear rates, and the cube model with the inputs of Table 3.2.",
        decisive=("2.3.5-wear-reduction-from", "2.3.5-wear-reduction-to", "2.3.5-wear-reduction-by-the-cube"),
        supporting=tuple(f"table-2.5-wear-reduction-{n}" for n in (1, 2, 3)),
    ),
    Claim(
        id="trends",
        statement="Friction over voltage, speed, frequency and waveform follows Figs. 3.15 to 3.18",
        source="D 3.3.5, 3.3.6",
        judged="Statements of the text on the figures, tested on the multi-scale model with asperity stick-slip and "
        "the structure identified from published facts.",
        decisive=(
            *("3.3.5-voltage-knee", "3.3.5-voltage-order", "3.3.5-voltage-saturation", "3.3.5-hopping-displacement"),
            *("3.3.5-speed-order", "3.3.5-speed-voltage-order"),
            *("3.3.5-resonance-friction", "3.3.5-resonance-voltage-order", "3.3.5-resonance-power"),
            *("3.3.5-waveform-square", "3.3.5-waveform-sine", "3.3.5-waveform-triangle", "3.3.6-waveform-ratio"),
        ),
        summary=counts,
    ),
    Claim(
        id="power-map",
        statement="The example test loses 3 to 100 % of its friction from 5 to 26 V",
        source="D 4.1.2, Table 4.2",
        judged="Asperity stick-slip against the test, within the printed scatter of the forces; its memory length is "
        "fitted to the sets of tests that the note of each row names.",
        decisive=tuple(f"{_DEFAULT}-B-{n}" for n in range(1, 6)),
        supporting=(
            *(f"table-4.2-friction-reduction-{n}" for n in range(2, 7)),
            *(f"table-4.2-friction-force-{n}-by-the-cube" for n in range(2, 7)),
            *(f"table-4.2-friction-force-{n}-by-the-line" for n in range(2, 7)),
        ),
    ),
    Claim(
        id="load",
        statement="The load matters by less than 10 %, most at 6 to 7 N",
        source="D 4.1.2, Fig. 4.7",
        judged="Range of the reduction from 3 to 9 N and the load of its maximum, by the multi-scale model with "
        "asperity stick-slip. Nothing in D 3.31 excites the arm whose resonance the text holds responsible, and at "
        "100 Hz no amplitude below 69 decay lengths reduces friction at this speed.",
        decisive=("4.1.2-arm-extra-reduction", "4.1.2-peak-load-1", "4.1.2-peak-load-2"),
        supporting=("4.1.2-arm-frequency",),
    ),
    Claim(
        id="temperature",
        statement="Contact, waveguide and foil reach 53, 80 and 41 degC",
        source="D 4.3.5, Fig. 4.36",
        judged="Frictional and vibrational heat of the tribometer, from a conducting to an insulating bond of the "
        "thermocouple; the rows on waveguide and foil state bounds, for what warmed the thermocouple there is not "
        "printed.",
        decisive=("4.3.5-tribometer-temperature-peak", "4.3.5-temperature-peak", "4.3.5-foil-temperature-peak"),
    ),
    Claim(
        id="collar",
        statement="The collar saves 48.9 % of the work of friction on a pulled rod",
        source="D 4.5.4, 4.5.6",
        judged="Finite elements of the collar with the contact of Table 3.2 and asperity stick-slip; length, load and "
        "speed of the rod are assumed, the speed over a range.",
        decisive=("4.5.4-work-reduction",),
        supporting=("4.5.4-reduction-from", "4.5.4-reduction-to", "4.5.3-mode-closed-top", "4.5.3-mode-open-top"),
    ),
)
"""Claims in the order of their chapters."""


def findings(rows: Iterable[Row]) -> tuple[Finding, ...]:
    """Findings on all claims whose rows were computed; in the order of `CLAIMS`."""
    by_id = {row.id: row for row in rows}
    return tuple(finding(claim, by_id) for claim in CLAIMS if by_id.keys() >= set(claim.decisive))
