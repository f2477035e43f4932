"""What all tests share: examples drawn by hypothesis may take their time, since machines are shared."""

from hypothesis import settings

settings.register_profile("patient", deadline=None)
settings.load_profile("patient")
