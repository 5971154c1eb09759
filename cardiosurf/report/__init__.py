"""Figures from recordings."""
