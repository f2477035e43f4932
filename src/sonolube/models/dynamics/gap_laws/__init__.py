"""Contact laws for dynamics: normal contact force against displacement."""
