"""Builds the compiled library of pymunk_ellipse from the package's own functions: tools of the build, not installed."""
