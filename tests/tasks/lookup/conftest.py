"""Program in this process, held to the files that it declares."""

from tests.cli.conftest import only_foreseen_files as only_foreseen_files, sonolube as sonolube
