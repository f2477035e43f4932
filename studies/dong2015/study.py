"""Entry of the study: the dissertation judged, and its horns and transducers, each imported when it is asked for."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from dong2015.chapters import Reproduction
    from sonolube.design.horns.face import HornFace
    from sonolube.models.fem import Transducer
    from sonolube.studies import Advance


@dataclass(frozen=True, kw_only=True, slots=True)
class ReproductionReport:
    """The reproduction as text, JSON and files.

    Parameters
    ----------
    result : Reproduction
    """

    result: "Reproduction"

    @property
    def caveats(self) -> tuple[str, ...]:
        """Assumptions of the rows that contradict the dissertation."""
        return self.result.caveats

    def lines(self) -> list[str]:
        """Scorecard of the claims, and the number of rows by class and verdict."""
        from dong2015.report import summary_lines

        return summary_lines(self.result)

    def object(self) -> dict[str, Any]:
        """Claims, rows, and the number of rows by class and verdict."""
        from dong2015.report import validation_object

        return validation_object(self.result)

    def files(self, *, advance: "Advance") -> dict[str, str | bytes]:
        """Report, claims and rows as JSON, and every figure."""
        from dong2015.report import reproduction_files

        return reproduction_files(self.result, advance=advance)


class Dissertation:
    """The dissertation as a study of sonolube."""

    title = "S. Dong, Friction and Wear Reduction via Ultrasonic Lubrication, The Ohio State University, 2015"

    @property
    def transducers(self) -> "Mapping[str, Callable[..., Transducer]]":
        """Its transducers, and a stack of the size of its Table 4.7."""
        from dong2015.hardware.transducers import DONG_2015_TRANSDUCERS

        return DONG_2015_TRANSDUCERS

    @property
    def horn_faces(self) -> "Mapping[str, HornFace]":
        """Faces of both horns of the Poisson-effect tests."""
        from dong2015.chapter2.horn_rows import measured_region
        from dong2015.chapter2.poisson_horn import FACE_ASSUMPTIONS, FACE_END, friction_on_face
        from dong2015.published_rigs import HORNS
        from sonolube.design.horns.face import HornFace

        return {
            horn: HornFace(
                end=FACE_END,
                measured=measured_region(horn),
                source="Table 2.1",
                friction=partial(friction_on_face, horn),
                assumptions=FACE_ASSUMPTIONS,
            )
            for horn in HORNS
        }

    def reproduce(self, *, chapter: int | None, advance: "Advance") -> ReproductionReport:
        """Claims of the dissertation judged, and its numbers beside computed ones, with figures."""
        from dong2015.chapters import reproduction

        return ReproductionReport(result=reproduction(chapter=chapter, advance=advance))


STUDY: Final = Dissertation()
"""Loaded by the entry point `dong2015` of the group `sonolube.studies`."""
