"""Recording in, finding out."""
