"""Answer of look-ups: a table of facts as blocks and as JSON, both given."""

from collections.abc import Callable, Sequence
from typing import Any, ClassVar

from sonolube.tasks.answer import Answer, Block, Dataset, answer


@answer
class Listing(Answer):
    """Table of facts.

    Parameters
    ----------
    parts : sequence of Block
        For people.
    content : dict
        For JSON.
    labelled : callable, optional
        Returns the same as a dataset; the quantities and texts of the content where absent.
    """

    is_lookup: ClassVar[bool] = True

    parts: Sequence[Block]
    content: dict[str, Any]
    labelled: "Callable[[], Dataset] | None" = None

    def blocks(self) -> Sequence[Block]:
        """Blocks as given."""
        return self.parts

    def object(self) -> dict[str, Any]:
        """Object as given."""
        return self.content

    def dataset(self) -> Dataset:
        """Table as a labelled dataset, with units."""
        return super().dataset() if self.labelled is None else self.labelled()
