"""Records of runs: a folder each, with protocol, facts, documents, raw blocks and recordings."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
