"""Records of the catalogue of materials: a sourced value, a sourced text, and a material or class of materials."""

from collections.abc import Mapping
from dataclasses import dataclass

from sonolube.errors import MissingProperty
from sonolube.vocabulary import quantity


@dataclass(frozen=True, kw_only=True, slots=True)
class SourcedValue:
    """A numerical property with its unit and source.

    Parameters
    ----------
    value : float
        Value, in `unit`.
    unit : str
        Its SI unit; empty for dimensionless numbers.
    source : str
        Table, data sheet, handbook or paper.
    condition : str
        Temper, temperature or kind of test for which it holds; empty where the source does not state any.
    note : str
        Further remarks, such as a source that disagrees.
    deviation : float
        Standard deviation of its logarithm over the materials that a class covers; zero for one material.
    """

    value: float
    unit: str
    source: str
    condition: str = ""
    note: str = ""
    deviation: float = 0.0


@dataclass(frozen=True, kw_only=True, slots=True)
class SourcedText:
    """A property in words with its source.

    Parameters
    ----------
    text : str
        The statement.
    source : str
        Table, data sheet, handbook or paper.
    note : str
        Further remarks.
    """

    text: str
    source: str
    note: str = ""


@dataclass(frozen=True, kw_only=True, slots=True)
class Material:
    """A material, or a class of materials, with its scalar properties.

    Parameters
    ----------
    name : str
        Its identifier in rig files and results, such as "m50".
    title : str
        Its name in prose.
    family : str
        Its kind, such as "steel", "brass", "ceramic" or "polymer": materials of one family rub alike.
    properties : mapping of str to SourcedValue
        Its scalar properties, by their vocabulary names.
    crystal_structure : SourcedText or None
        Its crystal structure, where a source states it.
    aliases : tuple of str
        Further names by which it is found.
    is_class : bool
        Whether it stands for a class of materials, such as unspecified steel: its properties are medians, each
        with the standard deviation of its logarithm.
    """

    name: str
    title: str
    family: str
    properties: Mapping[str, SourcedValue]
    crystal_structure: SourcedText | None = None
    aliases: tuple[str, ...] = ()
    is_class: bool = False

    def property(self, property_name: str) -> SourcedValue:
        """Property with its unit and source.

        Parameters
        ----------
        property_name : str
            Its name in the vocabulary, such as "youngs_modulus".

        Returns
        -------
        SourcedValue

        Raises
        ------
        MissingProperty
            If the catalogue has no source for it.
        UnknownName
            If the vocabulary has no such property.
        """
        try:
            return self.properties[property_name]
        except KeyError:
            quantity_name = quantity(property_name).name
            raise MissingProperty(
                f"{self.name} has no {quantity_name}: no source is known; give it in the rig file"
            ) from None

    def value(self, property_name: str) -> float:
        """Numerical value of a property, in SI.

        Parameters
        ----------
        property_name : str
            Its name in the vocabulary, such as "youngs_modulus".

        Returns
        -------
        float

        Raises
        ------
        MissingProperty
            If the catalogue has no source for it.
        UnknownName
            If the vocabulary has no such property.
        """
        return self.property(property_name).value
