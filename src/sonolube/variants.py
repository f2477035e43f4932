"""Tables of named variants: models, laws and readers chosen by name, each imported when it is first looked up."""

from collections.abc import Callable, Iterator, Mapping
from importlib import import_module
from typing import Any, Generic, TypeVar

from sonolube.errors import entry_named

Variant = TypeVar("Variant")


class VariantTable(Mapping[str, Variant], Generic[Variant]):
    """Table of the variants of one kind by name, imported on first access.

    A table maps names to places such as ``"sonolube.models.friction.models.kinematic:Kinematic"``; adding a variant
    takes its file and one line of the table. Iterating over the names imports nothing.

    Parameters
    ----------
    kind : str
        Kind of the variants in messages, such as "friction model".
    places : mapping of str to str
        Module and attribute of each variant, by name.
    made : callable, optional
        Makes the variant from the attribute; by default the attribute itself is the variant.
    """

    def __init__(self, kind: str, places: Mapping[str, str], *, made: Callable[[Any], Variant] | None = None) -> None:
        self.kind = kind
        self._places = dict(places)
        self._made = made
        self._loaded: dict[str, Variant] = {}

    def __getitem__(self, name: str) -> Variant:
        if name not in self._loaded:
            module, _, attribute = self._places[name].partition(":")
            found = getattr(import_module(module), attribute)
            self._loaded[name] = found if self._made is None else self._made(found)
        return self._loaded[name]

    def __contains__(self, name: object) -> bool:
        return name in self._places

    def __iter__(self) -> Iterator[str]:
        return iter(self._places)

    def __len__(self) -> int:
        return len(self._places)

    def named(self, name: str) -> Variant:
        """Variant of a name.

        Parameters
        ----------
        name : str

        Returns
        -------
        object

        Raises
        ------
        UnknownName
            If the name is not in the table; the closest one is suggested.
        """
        return entry_named(self, name, kind=self.kind)
