"""Units are read by a grammar of bounded size: known ones as ever, all else is refused at once."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import given, strategies as st

from sonolube.errors import InvalidInput
from sonolube.text.unit_grammar import LONGEST_UNIT, canonical_unit
from sonolube.text.units import convert, to_si
from sonolube.vocabulary import quantities

ROOT = Path(__file__).parents[2]

# Forms that a reader of recordings, surfaces or rig files has met, with the same unit in the simplest notation.
SAME = {
    "N·s/m": "N s/m",
    "N⋅s/m": "N s/m",
    "N*s / m": "N s/m",
    "m²": "m2",
    "s⁻¹": "1/s",
    "m-1": "1/m",
    "m^-1": "1/m",
    "m ** -1": "1/m",
    "/m2": "1/m2",
    "m per s": "m/s",
    "metre squared": "m2",
    "square metre": "m2",
    "cubic mm": "mm3",
    "(m/s)^2": "m2/s2",
    "V/Hz**0.5": "V/Hz^(1/2)",
    "kg·m⁻³": "kg/m3",
    "J/kg K": "J K/kg",
    "µm": "um",
    "μm": "um",
    "Ω": "ohm",
    "\N{NO-BREAK SPACE}mm\N{NO-BREAK SPACE}": "mm",
}


@pytest.mark.parametrize("written", SAME)
def test_a_unit_has_one_meaning_in_all_its_notations(written: str) -> None:
    assert convert(1.0, from_unit=written, to_unit=SAME[written]) == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize("written", ["°C", "degC", "celsius", "degree_Celsius", "% ", "‰", "Å", "dB", "inch_Hg_0C"])
def test_units_with_signs_and_joined_words_are_known(written: str) -> None:
    convert(1.0, from_unit=written, to_unit=written)


def test_the_units_of_the_vocabulary_and_of_every_example_are_known() -> None:
    units = {quantity.unit for quantity in quantities().values()}
    for path in (ROOT / "examples").rglob("*.toml"):
        units |= set(re.findall(r'"[-+]?\d[\d.]*(?:e[-+]?\d+)? ?([^\s\d"][^"]{0,12})"', path.read_text("utf-8")))
    units -= {unit for unit in units if re.search(r"[a-z]{5}|_|\+-", unit)}  # words, file names, scatters
    assert len(units) > 60
    for unit in units:
        convert(1.0, from_unit=unit, to_unit=unit)


REFUSED = [
    "N**9**9**9",
    "9**9**9 N",
    "N?",
    "N #x",
    "m,m",
    "m//s",
    "m's",
    "1 N",
    "10 um",
    "m/",
    "*m",
    "m**",
    "m**(1/0)",
    "(m",
    "m)",
    "m^10",
    "m99999999999999999999",
    "((m^3)^3)^3",
    "square square square cubic m",
    "m\nm",
    "m\0",
    "__import__",
    "x" * 100_000,
    "(" * 100_000,
    " ".join("m" * 13),
    "N" + " " * 100_000 + "N",
]


@pytest.mark.parametrize("unit", REFUSED, ids=lambda unit: repr(unit)[:24])
def test_what_is_no_unit_is_refused_in_a_short_line(unit: str) -> None:
    with pytest.raises(InvalidInput, match="unknown unit") as refusal:
        to_si(f"3 x {unit}" if unit[0].isdigit() else f"3 {unit}", unit="N", name="--load")
    assert len(str(refusal.value)) < 400


HOSTILE = """
from sonolube.errors import InvalidInput
from sonolube.text.units import to_si
for text in ("3 N**9**9**9", "3 9**9**9 N", "3 " + "x" * 10**6, "3 N" + " " * 10**6 + "x", "3" * 10**6 + " N",
             "3 min**9**9**9", "3 (((min**9)**9)**9)**9", "3 " + "(" * 10**6, "3 " + "m*" * 10**6, " " * 10**6):
    try:
        to_si(text, unit="N", name="x")
    except InvalidInput:
        pass
    else:
        raise SystemExit(text[:20])
"""


def test_no_unit_takes_long_to_refuse() -> None:
    subprocess.run([sys.executable, "-c", HOSTILE], check=True, timeout=300)


@given(st.text(alphabet="Nmsk/* ^()·²⁻19-.°%µΩ", max_size=80))
def test_what_the_grammar_spells_is_of_bounded_size_whatever_the_text(text: str) -> None:
    try:
        spelled = canonical_unit(text)
    except InvalidInput:
        return
    assert len(text.strip()) <= LONGEST_UNIT
    assert len(spelled) < 20 * LONGEST_UNIT
    powers = [abs(float(power)) for power in re.findall(r"\*\*(-?[\d.]+(?:e-\d+)?)", spelled)]
    assert all(power <= 9 for power in powers)


@given(st.text(max_size=30), st.sampled_from(["N", "m", "K", "1/s", "", "W"]))
def test_a_quantity_of_any_text_is_a_number_or_refused(text: str, unit: str) -> None:
    try:
        value = to_si(f"3 {text}", unit=unit, name="x")
    except InvalidInput as refusal:
        assert str(refusal).startswith("x ")  # noqa: PT017
    else:
        assert isinstance(value, float)


@pytest.mark.parametrize(("text", "unit"), [("3 degC m", "N"), ("1e5 dBm", "W"), ("1e308 km", "m"), ("3 dB", "m")])
def test_what_no_scale_can_express_is_refused(text: str, unit: str) -> None:
    with pytest.raises(InvalidInput, match=f"^x {text} "):
        to_si(text, unit=unit, name="x")


def test_a_product_with_a_logarithmic_unit_has_no_value() -> None:
    with pytest.raises(InvalidInput, match="1e3%dB has no value in m"):
        to_si("1e3%dB", unit="m", name="x")
