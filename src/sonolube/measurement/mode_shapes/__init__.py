"""Mode shapes of other programs: universal files and CalculiX results as modes at nodes, in SI."""
