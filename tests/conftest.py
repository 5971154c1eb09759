"""Every test makes its own surfaces, unless it asks for the cache."""

import os
import signal

# in the environment, so that the command lines that tests start have it too
os.environ["CARDIOSURF_CACHE"] = "off"

# a shell that starts the tests in the background has them ignore Ctrl-C, which some of them send
signal.signal(signal.SIGINT, signal.default_int_handler)
