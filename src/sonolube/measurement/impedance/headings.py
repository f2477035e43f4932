"""Headings of impedance tables, as instruments, spreadsheets and MATLAB write them: quantity, unit and scale."""

import math
import re
import unicodedata
from collections.abc import Iterator
from functools import lru_cache
from typing import Final, NamedTuple

from sonolube.checks import Floats

_NAMES: Final = {
    "f": ("f", "freq", "frequency", "frequencies", "frequenz", "sweep frequency", "messfrequenz", "hertz", "hz"),
    "omega": ("omega", "ω", "w", "angular frequency", "kreisfrequenz"),
    "R": ("r", "rs", "r s", "resistance", "series resistance", "wirkwiderstand", "resistanz", "serienwiderstand"),
    "X": ("x", "xs", "x s", "reactance", "series reactance", "blindwiderstand", "reaktanz"),
    "G": ("g", "gp", "g p", "conductance", "parallel conductance", "wirkleitwert", "konduktanz"),
    "B": ("b", "bp", "b p", "susceptance", "parallel susceptance", "blindleitwert", "suszeptanz"),
    "Rp": ("rp", "r p", "parallel resistance", "parallelwiderstand"),
    "Xp": ("xp", "x p", "parallel reactance"),
    "Ls": ("ls", "l s", "series inductance", "serieninduktivität"),
    "Lp": ("lp", "l p", "parallel inductance", "parallelinduktivität"),
    "Cs": ("cs", "c s", "series capacitance", "serial capacitance", "serienkapazität"),
    "Cp": ("cp", "c p", "parallel capacitance", "parallelkapazität"),
    "D": (
        *("d", "df", "tan delta", "tandelta", "tan d", "tand", "tanδ", "tan δ", "loss tangent", "loss factor"),
        *("dissipation", "dissipation factor", "verlustfaktor", "dielektrischer verlustfaktor"),
    ),
    "Q": ("q", "quality factor", "q factor", "güte", "gütefaktor"),
}
_SYMBOLS: Final = {name: symbol for symbol, names in _NAMES.items() for name in names}
_CIRCUITS: Final = {  # of which a name alone does not say the one meant
    "capacitance": ("Cs", "Cp"),
    "c": ("Cs", "Cp"),
    "kapazität": ("Cs", "Cp"),
    "inductance": ("Ls", "Lp"),
    "l": ("Ls", "Lp"),
    "induktivität": ("Ls", "Lp"),
}
_KINDS: Final = {
    "Z": ("z", "impedance", "impedanz", "scheinwiderstand"),
    "Y": ("y", "admittance", "admittanz", "scheinleitwert"),
    "S": ("s11", "gamma", "γ", "reflection", "reflexion", "reflexionsfaktor"),
}
_KIND: Final = {word: kind for kind, words in _KINDS.items() for word in words}
_ASPECTS: Final = {
    "abs": ("abs", "absolute", "mag", "magnitude", "mod", "modulus", "betrag", "logmag"),
    "re": ("re", "real", "realteil"),
    "im": ("im", "imag", "imaginary", "imaginärteil", "imaginaerteil"),
    "angle": ("angle", "ang", "arg", "phase", "phas", "ph", "phz", "theta", "θ", "phi", "φ", "winkel", "phasenwinkel"),
}
_ASPECT: Final = {word: aspect for aspect, words in _ASPECTS.items() for word in words}
_FILLERS: Final = frozenset({"of", "von", "der", "des", "part", "value", "val", "complex", "komplex", "coefficient"})
_MEANINGS: Final = {
    **{("Z", "abs"): "|Z|", ("Z", "re"): "R", ("Z", "im"): "X", ("Z", "angle"): "theta_Z"},
    **{("Y", "abs"): "|Y|", ("Y", "re"): "G", ("Y", "im"): "B", ("Y", "angle"): "theta_Y"},
    **{("S", "abs"): "|S|", ("S", "re"): "Re S", ("S", "im"): "Im S", ("S", "angle"): "theta_S"},
    **{("Z", ""): "|Z|", ("Y", ""): "|Y|", ("S", ""): "|S|", ("", "angle"): "theta"},
}
_SIGNED: Final = ("X", "B", "Im S", "theta", "theta_Z", "theta_Y", "theta_S")  # whose negatives are written too
_FUSED: Final = re.compile(
    r"(?P<before>re|real|im|imag|abs|mag|mod|arg|phase|ph|theta|θ)?(?P<kind>z|y|s11)"
    r"(?P<after>re|real|im|imag|abs|mag|mod|arg|phase|phz|ph|theta|θ)?"
)
_TRACE: Final = re.compile(r"(?:(?:trace|tr|ch|channel|kanal|spur)\s*\d+|trace\b)\s*[:\-]?\s*(?=\D)")
_LOGARITHM: Final = re.compile(r"(log10|log_10|lg|ln|log)(?!\w*mag)[\s_]*(?=[\s_(|a-z])(.+)")
_LONGEST: Final = 200  # characters of a heading that is looked at

_DIMENSIONS: Final = (
    {"f": "Hz", "omega": "rad/s", "D": "1", "Q": "1", "|S|": "1", "Re S": "1", "Im S": "1"}
    | dict.fromkeys(("|Y|", "G", "B"), "S")
    | dict.fromkeys(("Ls", "Lp"), "H")
    | dict.fromkeys(("Cs", "Cp"), "F")
    | dict.fromkeys(("theta", "theta_Z", "theta_Y", "theta_S"), "rad")
)
_BASES: Final = {
    **dict.fromkeys(("hz", "hertz"), "Hz"),
    **dict.fromkeys(("ohm", "ohms", "ω"), "ohm"),
    **dict.fromkeys(("s", "siemens", "mho", "mhos"), "S"),
    **dict.fromkeys(("h", "henry", "henrys"), "H"),
    **dict.fromkeys(("f", "farad", "farads"), "F"),
    "rad/s": "rad/s",
}
_ANGLES: Final = {
    **dict.fromkeys(("deg", "degs", "degree", "degrees", "°", "grad"), math.pi / 180),
    **dict.fromkeys(("rad", "radian", "radians", "rads"), 1.0),
    "mrad": 1e-3,
}
_PURE: Final = {**dict.fromkeys(("", "-", "1", "u", "lin", "linear"), 1.0), "%": 0.01}
_DECIBELS: Final = {"db": "", "dbohm": "ohm", "dbω": "ohm", "dbs": "S"}
_PREFIXES: Final = {
    **{"": 1.0, "p": 1e-12, "n": 1e-9, "u": 1e-6, "µ": 1e-6, "μ": 1e-6, "m": 1e-3},
    **{"k": 1e3, "K": 1e3, "M": 1e6, "G": 1e9},
}
_UNIT: Final = re.compile(
    r"([pnuµμmkKMG]?)\s*(H(?:z|Z|ertz|ERTZ)|[Oo]hms?|OHMS?|[Ωω]|S|[Ss]iemens|mhos?|H|[Hh]enrys?|F|[Ff]arads?|rad/s)"
)
_SPLITS: Final = tuple(
    re.compile(rf"(.*\S)\s*{behind}", re.DOTALL)
    for behind in (r"[(\[]([^()\[\]]*)[)\]]", r"/\s*(\S+(?:/s)?)", r",\s*(\S+)", r"\s(?:in|IN)\s+(\S+)", r"[\s_](\S+)")
)


class ColumnHeading(NamedTuple):
    """Quantity and unit of a column.

    Parameters
    ----------
    symbol : str
        Of the quantity, such as "f", "|Z|", "R", "Cp" or "theta" for a phase that does not say of what.
    scale : float
        Value of the column's unit in SI.
    decades : float
        Powers of ten in a step of one of a logarithmic column, such as 1/20 for decibels; zero for a linear one.
    """

    symbol: str
    scale: float
    decades: float = 0.0

    def in_si(self, values: Floats) -> Floats:
        """Values of the column in SI."""
        return self.scale * (10.0 ** (self.decades * values) if self.decades else values)


@lru_cache(maxsize=4096)
def parse_heading(text: str) -> ColumnHeading | None:
    """Quantity and unit in the heading of a column, or None where it is none of an impedance table.

    See Also
    --------
    unclear_heading : Why a heading may be None.
    """
    label = _cleaned(text)
    if not label or len(label) > _LONGEST:
        return None
    if (found := _LOGARITHM.fullmatch(label.lower())) and found[1] != "log":
        inner = parse_heading(_without_brackets(label[found.start(2) :]))
        is_magnitude = inner is not None and inner.symbol in ("|Z|", "|Y|", "f") and not inner.decades
        decades = 1 / math.log(10) if found[1] == "ln" else 1.0
        return ColumnHeading(inner.symbol, inner.scale, decades) if inner and is_magnitude else None
    found_unit = (_heading(name, unit) for name, unit in _with_units(label))
    heading = next(filter(None, found_unit), None) or _bare_heading(label)
    if heading is not None and heading.symbol == "omega":
        return ColumnHeading("f", heading.scale / (2 * math.pi))
    return heading


def is_phase_without_unit(text: str) -> bool:
    """Whether the heading of a column names a phase and states no unit, or one that is no angle."""
    label = _cleaned(text)
    names = [label, *(name for name, _ in _with_units(label))]
    return parse_heading(text) is None and any((_symbol(name, "") or "").startswith("theta") for name in names)


def phase_symbol(text: str) -> str:
    """Symbol of a phase whose heading states no unit: "theta", or that of impedance, admittance or reflection."""
    label = _cleaned(text)
    names = [label, *(name for name, _ in _with_units(label))]
    return next((found for name in names if (found := _symbol(name, "") or "").startswith("theta")), "theta")


def unclear_heading(text: str) -> str:
    """Readings of a heading that may mean one quantity or another; empty where it is clear or unknown."""
    label = _cleaned(text)
    if parse_heading(text) is not None or len(label) > _LONGEST:
        return ""
    if (found := _LOGARITHM.fullmatch(label.lower())) and found[1] == "log":
        return "may be a decimal or a natural logarithm: write log10|Z| or ln|Z|"
    for name in (label, *(name for name, _ in _with_units(label))):
        if circuits := _CIRCUITS.get(_plain(name)):
            one, other = circuits
            return f"may be of the series or of the parallel circuit: write {one} or {other}"
        words = _plain(name).split()
        if words and all(word in _ASPECT or word in _FILLERS for word in words):
            aspect = next((_ASPECT[word] for word in words if word in _ASPECT), "")
            if aspect in ("re", "im", "abs"):
                part = {"re": "real", "im": "imag", "abs": "magnitude"}[aspect]
                return f"may be of impedance, admittance or reflection: write 'Z {part} (ohm)' or 'Y {part} (S)'"
    return ""


def _cleaned(text: str) -> str:
    """Heading without quotation marks, with one spelling of signs, and without the number of a trace."""
    label = " ".join(unicodedata.normalize("NFC", text).replace("\u2126", "Ω").split()).strip(' "')
    label = label.replace("′", "'").replace("″", "''").replace("’", "'").replace("−", "-")
    found = _TRACE.match(label.lower())
    return label[found.end() :].strip() if found else label


def _without_brackets(text: str) -> str:
    """Text without brackets around all of it."""
    inner = text.strip()
    depth = 0
    for at, sign in enumerate(inner):
        depth += (sign == "(") - (sign == ")")
        if depth == 0 and at < len(inner) - 1:
            return inner
    return inner[1:-1].strip() if inner.startswith("(") and inner.endswith(")") else inner


def _with_units(label: str) -> Iterator[tuple[str, str]]:
    """Name and unit by each way of writing a unit behind a name."""
    for pattern in _SPLITS:
        if found := pattern.fullmatch(label):
            yield found[1].rstrip(" :"), found[2].strip()


def _heading(name: str, unit: str) -> ColumnHeading | None:
    """Heading of a name and a unit; None where the name is not known or the unit is of another kind."""
    decibels = _DECIBELS.get(unit.lower().replace(" ", ""))
    if decibels is not None:
        symbol = _symbol(name, decibels)
        return ColumnHeading(symbol, 1.0, 1 / 20) if symbol in ("|Z|", "|Y|", "|S|") else None
    for dimension, scale in _readings(unit):
        symbol = _symbol(name, dimension)
        if symbol is not None and _DIMENSIONS.get(symbol, "ohm") == dimension:
            return ColumnHeading(symbol, _sign(name) * scale)
    return None


def _bare_heading(label: str) -> ColumnHeading | None:
    """Heading without a unit, whose numbers are in SI; None for a phase, which may be in degrees."""
    symbol = _symbol(label, "")
    is_phase = symbol is not None and symbol.startswith("theta")
    is_unclear = is_phase or label.lower() == "w"  # an angular frequency or anything else
    return None if symbol is None or is_unclear else ColumnHeading(symbol, _sign(label))


def _sign(name: str) -> float:
    """Sign before a name: -1 for the negative of a quantity, such as -Im(Z)."""
    return -1.0 if name.strip().startswith("-") else 1.0


def _readings(unit: str) -> Iterator[tuple[str, float]]:
    """Dimension of a unit and its value in SI, by each meaning that it has."""
    lower = unit.lower()
    if lower in _ANGLES:
        yield "rad", _ANGLES[lower]
    if lower in _PURE:
        yield "1", _PURE[lower]
    if lower in ("hz", "khz", "ghz"):  # mhz is milli or mega and neither
        yield "Hz", {"hz": 1.0, "khz": 1e3, "ghz": 1e9}[lower]
    elif found := _UNIT.fullmatch(unit if unit != "MHZ" else "MHz"):
        yield _BASES[found[2].lower()], _PREFIXES[found[1]]


def is_unit(text: str) -> bool:
    """Whether a cell holds a unit of an impedance table, in brackets or without, and nothing else."""
    bare = text.strip(' "()[]').replace("\u2126", "Ω")
    return bool(bare) and bare != "1" and (any(True for _ in _readings(bare)) or bare.lower() in _DECIBELS)


def _symbol(name: str, dimension: str) -> str | None:
    """Symbol of a name; the dimension of its unit tells impedance from admittance where the name does not."""
    plain = _plain(name.strip().lstrip("-"))
    symbol = _SYMBOLS.get(plain) or _with_its_symbol(plain) or _composed(plain, dimension)
    return symbol if symbol in _SIGNED or _sign(name) > 0 else None


def _with_its_symbol(plain: str) -> str | None:
    """Symbol of a name that is followed by it, such as "parallel capacitance Cp"; None of any other name."""
    name, _, last = plain.rpartition(" ")
    symbol = _SYMBOLS.get(last)
    return symbol if symbol and (_SYMBOLS.get(name) == symbol or symbol in _CIRCUITS.get(name, ())) else None


def _composed(plain: str, dimension: str) -> str | None:
    """Symbol of words for impedance, admittance or reflection and for one of its parts, in any order."""
    kind = aspect = ""
    for word in plain.split():
        fused = _FUSED.fullmatch(word)
        if word in _FILLERS:
            continue
        if word in _KIND or fused:
            own = _KIND.get(word) or (_KIND[fused["kind"]] if fused else "")
            part = _ASPECT.get((fused["before"] or fused["after"] or "") if fused else "", "")
            if (kind and kind != own) or (part and aspect and part != aspect):
                return None
            kind, aspect = own, part or aspect
        elif word in _ASPECT:
            if aspect and aspect != _ASPECT[word]:
                return None
            aspect = _ASPECT[word]
        else:
            return None
    if not kind and aspect in ("re", "im", "abs"):
        kind = {"ohm": "Z", "S": "Y"}.get(dimension, "")
    if kind and not aspect and dimension == "rad":
        aspect = "angle"
    return _MEANINGS.get((kind, aspect))


def _plain(name: str) -> str:
    """Words of a name in small letters, bars as "abs", primes as the real and the imaginary part."""
    text = name.strip().lower()
    text = re.sub(r"\|\s*([^|]+?)\s*\|", r" abs \1 ", text)
    text = re.sub(r"\b([zy])\s*(?:''|\")", r" im \1 ", text)
    text = re.sub(r"\b([zy])\s*'", r" re \1 ", text)
    text = re.sub(r"\blog[\s_-]?mag\b", "logmag", text)
    return re.sub(r"[\s_\-:.,()\[\]{}/*]+", " ", text).strip()
