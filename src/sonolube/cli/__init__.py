"""The command `sonolube`."""

from sonolube.cli.app import main

__all__ = ["main"]
