"""Every test makes its own surfaces, unless it asks for the cache."""

import os

# in the environment, so that the command lines that tests start have it too
os.environ["CARDIOSURF_CACHE"] = "off"
