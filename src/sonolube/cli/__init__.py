"""The command `sonolube`: its entry, which imports nothing heavy before it can be interrupted."""

import atexit
import gc
import os
import sys

try:
    from collections.abc import Sequence

    from sonolube.storage.interruption import end_program_at_signals
except KeyboardInterrupt:  # the handler of signals is not yet in place
    sys.stderr.write("sonolube: interrupted\n")
    raise SystemExit(130) from None

__all__ = ["main"]

_COLLECTIONS = 100_000, 50, 100  # between collections of garbage, of which imports and compilation make little
_THREADS = {"OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"}
# by which a user chooses threads of linear algebra: on the small blocks here they cost several times what they save


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the program and exit: 0 after success, 1 after files refused, 2 after bad input.

    A program of its own, which this is without `arguments`, ends with 130 after SIGINT, and 143 after SIGTERM.

    Parameters
    ----------
    arguments : sequence of str, optional
        Command with its arguments; those of the process where absent.

    Raises
    ------
    SystemExit
        Always.
    """
    if arguments is None:
        end_program_at_signals()
        gc.set_threshold(*_COLLECTIONS)
        atexit.register(gc.freeze)  # no search for garbage in all modules at the end, which takes a tenth of a second
        os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")  # for which it reads the metadata of all packages
        if not _THREADS & os.environ.keys():
            os.environ["OPENBLAS_NUM_THREADS"] = "1"  # read when numpy is imported
        if sys.argv[1:2] == ["app"]:
            _serve_at_once(sys.argv[2:])
    from sonolube.cli.app import run

    run(arguments)


def _serve_at_once(arguments: Sequence[str]) -> None:
    """Serve the workbench and exit, where its options are so few that no parser has to be imported for them."""
    from importlib import import_module

    from sonolube.errors import SonolubeError

    try:
        server = import_module("sonolube.browser.server")
        options = server.plain_options(arguments)
        if options is not None:
            server.run(**options)
            sys.exit(0)
    except (ImportError, SonolubeError):
        return  # the parser reads the options again, and the refusal is said as those of all commands
    except KeyboardInterrupt:
        sys.exit(130)
