"""Reproduction of the dissertation: each published number beside the number computed for it, and figures."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
