"""Answer of look-ups: a table of facts as lines and as JSON, both given."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from sonolube.cli.console.answer import Answer


@dataclass(frozen=True, kw_only=True)
class Listing(Answer):
    """Table of facts.

    Parameters
    ----------
    text : sequence of str
        Lines for people.
    content : dict
        For JSON.
    """

    is_lookup: ClassVar[bool] = True

    text: Sequence[str]
    content: dict[str, Any]

    def lines(self) -> list[str]:
        """Lines as given."""
        return list(self.text)

    def object(self) -> dict[str, Any]:
        """Object as given."""
        return self.content
