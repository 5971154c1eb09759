"""Excitation waves on curved, anisotropic cardiac tissue: from a YAML config to a verdict."""

__version__ = "0.1.0"
