"""Decay length of the contact of a new rig: of published tests, as stated, or from a measured normal stiffness."""

import json
from typing import Final

from sonolube.checks import require_positive
from sonolube.errors import InvalidInput
from sonolube.rig.new_rig.pin_and_vibration import Entries, toml_text
from sonolube.rig.worn_contact import CENTRAL_SHARE, PUBLISHED_DECAY_LENGTH

_STATED_FACTOR: Final = 1.3


def compliance_entries(*, decay_length: float | None, normal_stiffness: float | None) -> Entries:
    """Entries of a new rig file for the decay length of its contact.

    Of the table contact; the median of worn contacts in published tests where both are None.
    """
    if decay_length is not None and normal_stiffness is not None:
        raise InvalidInput("give either decay_length or normal_stiffness, got both")
    if normal_stiffness is not None:
        require_positive(normal_stiffness=normal_stiffness)
        return _entries(
            {"normal_stiffness": toml_text(normal_stiffness, "N/m")},
            "as stated, taken as measured under this load: a factor of 1.3",
            _STATED_FACTOR,
        )
    if decay_length is not None:
        require_positive(decay_length=decay_length)
        return _entries({"decay_length": toml_text(decay_length, "m")}, "as stated: a factor of 1.3", _STATED_FACTOR)
    published = PUBLISHED_DECAY_LENGTH
    low, high = (f"{1e6 * end:.2g} um" for end in published.central_range())
    return _entries(
        {"decay_length": toml_text(published.median, "m"), "decay_length_origin": json.dumps("published_tests")},
        f"median of worn contacts in published friction tests; {100 * CENTRAL_SHARE:.0f} % have {low} to {high};"
        " roughness before wear does not tell it: see the decay length of worn contacts in the theory of contact",
        published.factor,
    )


def _entries(table: dict[str, str], reason: str, factor: float) -> Entries:
    """Entries of the table contact, its first key assumed and lognormal."""
    key = f"contact.{next(iter(table))}"
    return Entries(
        tables={"contact": table}, assumptions={key: reason}, uncertainty={key: f"lognormal factor {factor:.4g}"}
    )
