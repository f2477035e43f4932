"""Measurement: instrument files read into records with uncertainty, and the analyses of friction tests.

`README.md` beside this file describes the methods, the names and the sub-rooms.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
