"""Test protocols as data: steps of a test with their limits, read from TOML, as a time line, and written back."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
