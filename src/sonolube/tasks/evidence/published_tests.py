"""Tasks `evidence list`, `evidence check` and `evidence plot`: published tests that predictions learn from."""

from collections.abc import Mapping, Sequence
from typing import Annotated, Any

from sonolube.errors import SonolubeError
from sonolube.prediction.evidence_figure import evidence_chart
from sonolube.prediction.evidence_learning import read_sources, source_paths
from sonolube.prediction.published_source import PublishedSource, read_source, shipped_sources
from sonolube.report import Drawing
from sonolube.report.results import evidence as results
from sonolube.tasks.answer import Answer, Block, Dataset, answer
from sonolube.tasks.files import InputFile, file_path, with_names_only
from sonolube.tasks.parameters import File
from sonolube.tasks.task import task

OwnSources = Annotated[
    Sequence[InputFile] | InputFile, File("Your own files of published tests, or folders of them.", "FILES...")
]
_CAPTION = (
    "Measured friction ratios of published tests by source: filled along the normal of the contact, hollow within its"
    " plane. Bars: the printed scatter of a ratio, and how well an amplitude is known."
)


def own_sources(files: Sequence[InputFile] | InputFile) -> tuple[PublishedSource, ...]:
    """Sources of files, and of all files of folders."""
    return read_sources([file_path(each) for each in ([files] if isinstance(files, InputFile) else files)])


@answer
class PublishedTests(Answer):
    """Sources of published tests with their points.

    Parameters
    ----------
    sources : sequence of PublishedSource
    refused : mapping of str to str
        Reason for each file that cannot be read.
    is_brief : bool
        Whether each source is one line.
    """

    sources: Sequence[PublishedSource]
    refused: Mapping[str, str]
    is_brief: bool = False

    def blocks(self) -> Sequence[Block]:
        """Sources, their rigs and the ranges of their conditions."""
        if self.is_brief:
            return [f"{source.file}: {results.source_line(source)}" for source in self.sources]
        count = sum(source.points for source in self.sources)
        head = f"{count} published points of {len(self.sources)} sources"
        return [head, *(block for source in self.sources for block in results.source_blocks(source))]

    def object(self) -> dict[str, Any]:
        """Sources with their rigs and points, in SI."""
        return {"sources": [results.source_object(source) for source in self.sources]}

    def dataset(self) -> Dataset:
        """Points, over `point` by source, set and label."""
        return results.points_dataset(self.sources).assign_attrs(self.notes())

    def refusals(self) -> Mapping[str, str]:
        """Reason for each file that cannot be read."""
        return self.refused

    @property
    def has_result(self) -> bool:
        """Whether any file could be read."""
        return bool(self.sources)


@answer
class DrawnTests(PublishedTests):
    """Published tests with their figure."""

    def figures(self) -> Mapping[str, Drawing]:
        """Friction ratio over amplitude and velocity ratio, by source."""
        return {"evidence": Drawing(chart=lambda: evidence_chart(self.sources), caption=_CAPTION)}

    def files(self) -> Mapping[str, Dataset]:
        """Points as a dataset."""
        return {"evidence.nc": results.points_dataset(self.sources)}


@task
def list(own: OwnSources = ()) -> PublishedTests:  # noqa: A001 - the command's name
    """Published tests that predictions learn from: sources, points, direction, conditions, and what is not printed.

    Example: sonolube evidence list

    Examples
    --------
    >>> import sonolube as sl
    >>> answer = sl.evidence.list()
    >>> [source["title"] for source in answer.object()["sources"]]
    ['Dong', 'Littmann et al.', 'Gutowski and Leus', 'Luo et al.']
    """
    return PublishedTests(sources=(*shipped_sources(), *own_sources(own)), refused={})


@task
def check(
    files: Annotated[Sequence[InputFile] | InputFile, File("Files of published tests, or folders of them.", "FILE...")],
) -> PublishedTests:
    """Check files of published tests that you typed in: one line each.

    Example: sonolube evidence check examples/evidence/own_tests.toml

    Examples
    --------
    >>> import sonolube as sl
    >>> print(sl.evidence.check("examples/evidence/own_tests.toml"))
    own_tests.toml: Invented example: 3 points on 1 rig, 3 along the normal
    """
    given = [files] if isinstance(files, InputFile) else files
    found, refused = [], {}
    for path in source_paths([file_path(each) for each in given]):
        try:
            found.append(read_source(path))
        except SonolubeError as failure:
            refused[with_names_only(str(path))] = with_names_only(str(failure))
    return PublishedTests(sources=found, refused=refused, is_brief=True)


@task
def plot(own: OwnSources = ()) -> DrawnTests:
    """Measured friction ratios of published tests over amplitude and velocity ratio, by source.

    Example: sonolube evidence plot

    Examples
    --------
    >>> import sonolube as sl
    >>> answer = sl.evidence.plot()
    >>> round(float(answer["friction_ratio"].min()), 3)
    0.045
    """
    return DrawnTests(sources=(*shipped_sources(), *own_sources(own)), refused={})
