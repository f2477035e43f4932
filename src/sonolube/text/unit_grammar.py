"""Grammar of units as users and instruments write them, read in bounded time before any library sees the text.

.. code-block:: text

    unit     = [ "1" ] "/" product | product | ""
    product  = factor { operator factor }
    operator = " " | "*" | "·" | "⋅" | "×" | "/" | "per"
    factor   = { "square" | "sq" | "cubic" } ( symbol | "(" unit ")" ) [ power ]
    symbol   = letters, also with "°" among them and "_" between them; "%"; "‰"
    power    = ( "^" | "**" ) exponent | integer after a symbol without a space | superscripts | "squared" | "cubed"
    exponent = [ sign ] integer | [ sign ] decimal | "(" [ sign ] integer "/" integer ")"

Operators are taken from left to right, so that "J/kg K" is (J/kg) K. A unit has at most 60 characters and 12 symbols;
no power, nor the product of powers of nested brackets, is beyond 9. Examples: "um", "mm/s", "1/min", "N s/m",
"W/(m2 K)", "kg·m⁻³", "V/Hz^(1/2)", "°C".
"""

import re
from collections import deque

from sonolube.errors import InvalidInput

LONGEST_UNIT = 60
"""Characters of the longest unit that is read."""

_MAX_SYMBOLS = 12
_LARGEST_POWER = 9.0
_SUPERSCRIPTS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻", "0123456789+-")
_LETTER = r"[^\W\d_⁰¹²³⁴⁵⁶⁷⁸⁹]"
_TOKEN = re.compile(
    rf"""
    (?P<symbol>{_LETTER}*°{_LETTER}*|{_LETTER}+(?:_(?:{_LETTER}|\d)+)*|[%‰])(?P<attached>-?\d+(?![\d.]))?
    |(?P<superscript>[⁺⁻]?[⁰¹²³⁴⁵⁶⁷⁸⁹]+)
    |(?P<number>\d+(?:\.\d+)?)
    |(?P<sign>\*\*|[-+*·⋅×/^()])
    |(?P<space>[ \t\u00a0\u2009\u202f]+)
    """,
    re.VERBOSE,
)
_OPERATORS = {"*": "*", "·": "*", "⋅": "*", "×": "*", "/": "/", "per": "/"}
_POWER_BEFORE = {"square": 2, "sq": 2, "cubic": 3}
_POWER_BEHIND = {"squared": "2", "cubed": "3"}
_SPELT_OUT = {"%": "percent", "‰": "permille"}

_Tokens = deque[tuple[str, str]]
_Spelled = tuple[str, float]  # a part of a unit for pint, and the largest power in it


def canonical_unit(text: str) -> str:
    """Spelling for pint of a unit that follows the grammar of this module.

    Symbols with `*`, `/`, `**` and brackets only. Whether the symbols are known is for pint to say.
    """
    text = text.strip()
    if len(text) > LONGEST_UNIT:
        raise InvalidInput(f"a unit has at most {LONGEST_UNIT} characters, got {len(text)}")
    if not text:
        return "dimensionless"
    tokens = _tokens(text)
    if sum(kind == "symbol" for kind, _ in tokens) > _MAX_SYMBOLS:
        raise InvalidInput(f"a unit has at most {_MAX_SYMBOLS} symbols")
    spelled, _ = _unit(tokens)
    if tokens:
        raise InvalidInput(f"a unit does not go on with {tokens[0][1]!r}")
    return spelled


def _tokens(text: str) -> _Tokens:
    """Kind and text of each symbol, power, operator and bracket."""
    tokens: _Tokens = deque()
    place = 0
    while place < len(text):
        found = _TOKEN.match(text, place)
        if found is None:
            raise InvalidInput(f"a unit does not hold {text[place]!r}")
        kind = next(name for name, part in found.groupdict().items() if part)
        if kind != "space":
            tokens.append((kind, found[kind]))
        if found["attached"]:
            tokens.append(("attached", found["attached"]))
        place = found.end()
    return tokens


def _next(tokens: _Tokens) -> str:
    """Text of the next token; empty at the end."""
    return tokens[0][1] if tokens else ""


def _taken(tokens: _Tokens) -> tuple[str, str]:
    """Kind and text of the next token, which is removed."""
    if not tokens:
        raise InvalidInput("a unit is not complete")
    return tokens.popleft()


def _unit(tokens: _Tokens) -> _Spelled:
    """A product, or one over a product."""
    if _next(tokens) == "1" and len(tokens) > 1 and tokens[1][1] in ("/", "per"):
        tokens.popleft()
    parts, largest = ([], 1.0) if _next(tokens) not in ("/", "per") else (["1"], 1.0)
    while tokens and _next(tokens) != ")":
        if parts:
            parts.append(_OPERATORS[tokens.popleft()[1]] if _next(tokens) in _OPERATORS else "*")
        factor, power = _factor(tokens)
        parts.append(factor)
        largest = max(largest, power)
    if not parts:
        raise InvalidInput("a unit is not complete")
    return "".join(parts), largest


def _factor(tokens: _Tokens) -> _Spelled:
    """A symbol or a unit in brackets, with its power."""
    before = 1
    while _next(tokens) in _POWER_BEFORE:
        before *= _POWER_BEFORE[tokens.popleft()[1]]
    kind, text = _taken(tokens)
    largest = 1.0
    if text == "(":
        inner, largest = _unit(tokens)
        if _taken(tokens)[1] != ")":
            raise InvalidInput("a unit has a bracket that is not closed")
        text = f"({inner})"
    elif kind != "symbol" or text in _OPERATORS or text in _POWER_BEHIND:
        raise InvalidInput(f"a unit does not have {text!r} in place of a symbol")
    power = before * _power(tokens)
    largest *= abs(power)
    if largest > _LARGEST_POWER:
        raise InvalidInput(f"a power of a unit is at most {_LARGEST_POWER:g}")
    text = _SPELT_OUT.get(text, text.replace("°", "degree"))
    return (text if power == 1 else f"{text}**{power!r}".removesuffix(".0")), largest


def _power(tokens: _Tokens) -> float:
    """Power behind a symbol or a bracket; one where there is none."""
    kind = tokens[0][0] if tokens else ""
    if kind in ("attached", "superscript"):
        return float(tokens.popleft()[1].translate(_SUPERSCRIPTS))
    if _next(tokens) in _POWER_BEHIND:
        return float(_POWER_BEHIND[tokens.popleft()[1]])
    if _next(tokens) not in ("^", "**"):
        return 1.0
    tokens.popleft()
    if _next(tokens) != "(":
        return _signed(tokens)
    tokens.popleft()
    power = _signed(tokens)
    if _next(tokens) == "/":
        tokens.popleft()
        power = _ratio(power, _signed(tokens))
    if _taken(tokens)[1] != ")":
        raise InvalidInput("a unit has a bracket that is not closed")
    return power


def _signed(tokens: _Tokens) -> float:
    """A number with its sign."""
    sign = -1.0 if _next(tokens) == "-" else 1.0
    if _next(tokens) in ("+", "-"):
        tokens.popleft()
    kind, text = _taken(tokens)
    if kind != "number":
        raise InvalidInput(f"a power of a unit is a number, got {text!r}")
    return sign * float(text)


def _ratio(numerator: float, denominator: float) -> float:
    """Quotient of the parts of a fractional power."""
    if denominator == 0:
        raise InvalidInput("a power of a unit is not a number over zero")
    return numerator / denominator
