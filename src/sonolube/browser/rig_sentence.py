"""A contact in a sentence whose values are entries of the rig, for the page where the sentence is the form."""

import re
from collections.abc import Collection, Mapping
from typing import Any, Final, Literal

from sonolube.rig import Rig

_PAIR: Final = re.compile(r"\S (?:on|over|between|against) \S")
_PIN_ON_DISC: Final = re.compile(r"(?P<pin>.+ pin) on (?P<disc>.+ disc)", re.IGNORECASE)
_TIP: Final = re.compile(r"\btip radius (?P<size>[\d.]+ \w+)")
_FLAT: Final = re.compile(r"flat of (?P<size>[\d.]+ \w+) in diameter")
_MOVING: Final = re.compile(r"vibrating (?:\w+ )*(\w+)$|(\w+) that vibrates|(disc)$")

Piece = dict[Literal["text", "key"], str]


def rig_sentence(rig: Rig, content: Mapping[str, Any], keys: Collection[str]) -> list[Piece]:
    """Sentence on a contact as its texts and, between them, the keys of the entries whose values it states.

    Parameters
    ----------
    rig : Rig
    content : mapping of str to Any
        Tables of its file.
    keys : collection of str
        Dotted keys of the entries that the file has; values of others are left out.

    Returns
    -------
    list of dict
        Each with `text` or `key`.
    """
    bodies = _bodies(rig)
    places = (
        (f"{bodies}, pressed with ", "contact.normal_load"),
        (", sliding at ", "sliding.sliding_speed"),
        (f"{_motion(bodies, content)} {rig.direction.text.removesuffix(' of the contact')} at ", "drive.frequency"),
        (" with ", "vibration.vibration_amplitude"),
        (", driven by ", "drive.voltage_peak_to_peak"),
        (". Without vibration its coefficient of friction is ", "friction.friction_coefficient"),
    )
    found: list[Piece] = []
    for text, key in places:
        if key in keys:
            found += [{"text": text}, {"key": key}]
        elif key == "drive.frequency":
            found.append({"text": text.removesuffix(" at ")})
    return [*found, {"text": "."}]


def vibrating_body(content: Mapping[str, Any]) -> str:
    """Body that vibrates: "pin", the upper one of the drawing, or "disc"."""
    return str(content.get("vibration", {}).get("vibrating_body", "pin"))


def _bodies(rig: Rig) -> str:
    """Both bodies by the title of the rig, with the end of the pin where its file states one."""
    pair = next((part for part in rig.title.split(", ") if _PAIR.search(part)), "the contact")
    found = _PIN_ON_DISC.fullmatch(pair)
    if found is None:
        return f"{pair[:1].upper()}{pair[1:]}"
    reason = rig.assumptions.get("contact.nominal_area", "")
    tip, flat = _TIP.search(reason), _FLAT.match(reason)
    shape = f" of {tip['size']} radius" if tip else f" of {flat['size']} in diameter" if flat else ""
    pin, disc = (_with_article(found[name]) for name in ("pin", "disc"))
    return f"{pin[:1].upper()}{pin[1:]}{shape} on {disc}"


def _with_article(body: str) -> str:
    """Body with its article, where it has none."""
    if body.lower().startswith(("a ", "an ", "the ")):
        return body
    name = body if body[1:2].isupper() else f"{body[:1].lower()}{body[1:]}"
    return f"{'an' if name[:1].lower() in 'aeio' else 'a'} {name}"


def _motion(bodies: str, content: Mapping[str, Any]) -> str:
    """Verb of the vibration, with the body that moves where it is not the one that the sentence is about."""
    if vibrating_body(content) == "pin":
        return ", vibrates"
    named = _MOVING.search(bodies)
    return f"; the {next(filter(None, named.groups())) if named else 'lower body'} vibrates"
