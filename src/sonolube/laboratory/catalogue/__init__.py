"""Catalogue of runs: an index of their folders, searched by material, load, speed, date, tag and text."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
