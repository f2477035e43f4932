"""Former keys and names of rig files, each with the present one."""

from collections.abc import Mapping
from typing import Any

from sonolube.errors import InvalidInput

_KEYS = {"contact.pair.combined_modulus": "contact.pair.effective_modulus", "friction.closure": "friction.model"}
_NAMES = {
    "contact.asperity_law": {"as_published": "dong_2015", "corrected": "chang_etsion_bogy"},
    "friction.model": {
        "as_published": "dong_2015_full_period",
        "separating_half_period": "dong_2015_half_period",
        "load_balanced": "dong_2015_load_balanced",
        "stick_slip": "asperity_stick_slip",
        "coupled": "bristle_with_holder",
    },
}


def refuse_former_names(content: Mapping[str, Any]) -> None:
    """Refuse content of a rig file that has a former key or name."""
    for key, present in _KEYS.items():
        if (value := entry_of(content, key)) is not None:
            names = _NAMES.get(present, {})
            now = f'{present.rpartition(".")[2]} = "{names.get(value, value)}"' if isinstance(value, str) else present
            raise InvalidInput(f"{key}: is now {present}; write {now}")
    for key, names in _NAMES.items():
        value = entry_of(content, key)
        if isinstance(value, str) and value in names:
            raise InvalidInput(f'{key}: "{value}" is now "{names[value]}"')


def entry_of(content: Mapping[str, Any], key: str) -> Any:
    """Entry of the content of a file by its dotted key; None where there is none."""
    place: Any = content
    for part in key.split("."):
        if not isinstance(place, Mapping) or part not in place:
            return None
        place = place[part]
    return place
