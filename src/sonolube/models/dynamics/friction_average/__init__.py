"""Averages of the kinematic friction factor over a period of vibration, by quadrature in compiled kernels."""
