from .mock_up import fmu as fmu
