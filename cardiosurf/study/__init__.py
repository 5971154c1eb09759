"""A config carried through to its verdict."""
