"""Published friction tests as records, and every friction model fitted and cross-validated against them."""
