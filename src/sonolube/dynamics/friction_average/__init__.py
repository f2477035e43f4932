"""Period averages of the kinematic friction factor, by quadrature in compiled kernels."""
