"""Program in this process, held to the files that it declares; equal models are solved once."""

from tests.cli.conftest import (
    equal_models_are_solved_once as equal_models_are_solved_once,
    only_foreseen_files as only_foreseen_files,
    sonolube as sonolube,
)
