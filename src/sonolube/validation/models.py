"""The models that are compared, what each needs to be told of a test, and which tests tell it."""

from collections.abc import Iterable
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

from sonolube.errors import UnknownName
from sonolube.validation.closures import VARIANTS, ClosureVariant
from sonolube.validation.friction_tests import Circumstances
from sonolube.validation.literature import LITERATURE_VARIANTS

NEEDS: Final = MappingProxyType(
    {
        "contact": "roughness and materials of the bodies",
        "normal_load": "the normal load",
        "friction_coefficient": "the friction coefficient without vibration",
        "sliding_speed": "the sliding speed",
        "vibration_amplitude": "the amplitude along the normal",
        "frequency": "the frequency",
        "in_plane_amplitude": "the amplitude along the sliding",
        "vibration_velocity": "the velocity of a vibration within the plane",
        "vibration_direction": "the direction of a vibration within the plane",
        "holder_stiffness": "the stiffness of the holder",
        "holder_mass": "the mass that moves with the holder",
    }
)
"""What a model may need of a test, in words."""

_NORMAL: Final = ("contact", "normal_load", "vibration_amplitude", "frequency", "sliding_speed")
_RUBBING: Final = (*_NORMAL, "friction_coefficient")
_ALONG: Final = ("contact", "normal_load", "friction_coefficient", "in_plane_amplitude", "frequency", "sliding_speed")
_AMPLITUDE: Final = ("vibration_amplitude", "frequency", "sliding_speed")


@dataclass(frozen=True, kw_only=True, slots=True)
class ComparedModel:
    """One model under the protocol of the comparison.

    Parameters
    ----------
    variant : ClosureVariant
        Its name, meaning, free parameters with bounds, and prediction.
    needs : tuple of str
        What it has to be told of a test, words of `NEEDS`.
    source : str
        Who published it.
    """

    variant: ClosureVariant
    needs: tuple[str, ...]
    source: str

    @property
    def name(self) -> str:
        """Its name in tables and figures."""
        return self.variant.name

    def inapplicable(self, test: Circumstances) -> str | None:
        """Return why it cannot be asked about a test; None where it can."""
        missing = [NEEDS[name] for name in self.needs if getattr(test, name, None) is None]
        return f"needs {', '.join(missing)}: not known here" if missing else None


_CLOSURES: Final = {
    "as-published": (_NORMAL, "D 3.46 to 3.48"),
    "separating-half-period": (_NORMAL, "D 3.15"),
    "load-balanced": (_NORMAL, "D 3.46 to 3.48, mean gap corrected"),
    "load-balanced-per-rig": (_NORMAL, "D 3.46 to 3.48, mean gap corrected"),
    "kinematic": (_NORMAL, "D 3.46; Kumar and Hutchings 2004, across"),
    "kinematic-fitted": (_NORMAL, "D 3.46; Kumar and Hutchings 2004, across"),
}
_LITERATURE: Final = {
    "coulomb-in-plane": (("sliding_speed", "vibration_velocity", "vibration_direction"), "Littmann 2001; Kumar 2004"),
    "coulomb-along-hidden": (_AMPLITUDE, "Littmann, Storck and Wallaschek 2001"),
    "coulomb-oblique-hidden": (_AMPLITUDE, "Kumar and Hutchings 2004"),
    "spring-flat": (_RUBBING, "M. Popov, V. L. Popov and N. V. Popov 2017"),
    "spring-parabolic": (_RUBBING, "M. Popov, V. L. Popov and N. V. Popov 2017"),
    "spring-approximate": (_RUBBING, "M. Popov, V. L. Popov and N. V. Popov 2017"),
    "spring-flat-fitted": (_RUBBING, "M. Popov, V. L. Popov and N. V. Popov 2017"),
    "spring-in-plane": (_RUBBING, "M. Popov and Q. Li 2018"),
    "spring-along": (_ALONG, "V. L. Popov, Starcevic and Filippov 2010"),
    "elliptical": (_NORMAL, "D 2.1.4"),
    "dahl": (_RUBBING, "D 3.10 and 3.11; Dahl 1968"),
    "dahl-in-plane": (_RUBBING, "D 3.10 and 3.11; Dahl 1968"),
    "lugre": (_RUBBING, "Canudas de Wit, Olsson, Astrom and Lischinsky 1995"),
    "lugre-in-plane": (_RUBBING, "Canudas de Wit, Olsson, Astrom and Lischinsky 1995"),
    "dahl-driven": ((*_ALONG, "holder_stiffness", "holder_mass"), "Gutowski and Leus 2012"),
}

COMPARED_MODELS: Final = tuple(
    ComparedModel(variant=variant, needs=needs, source=source)
    for variants, known in ((VARIANTS, _CLOSURES), (LITERATURE_VARIANTS, _LITERATURE))
    for variant in variants
    for needs, source in (known.get(variant.name, (_RUBBING, "this program")),)
)
"""Every model that is compared: the closures and those of the literature."""


def compared_models(names: Iterable[str] = ()) -> tuple[ComparedModel, ...]:
    """Return the models of some names, in the order of the table; all where none is named.

    Raises
    ------
    UnknownName
        If there is no such model.
    """
    known = {model.name: model for model in COMPARED_MODELS}
    wanted = list(names)
    for name in wanted:
        if name not in known:
            raise UnknownName.among(known, kind="model", name=name)
    return tuple(model for model in COMPARED_MODELS if not wanted or model.name in wanted)
