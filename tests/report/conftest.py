"""Report of the reproduction of one chapter, written once for all tests that read it."""

from pathlib import Path

import pytest
from tests.reproduced import reproduced

from sonolube.reproduction import write_report


@pytest.fixture(scope="session")
def chapter_3_report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of the report of chapter 3, which no test changes."""
    folder = tmp_path_factory.mktemp("report")
    write_report(reproduced(3), folder=folder)
    return folder
