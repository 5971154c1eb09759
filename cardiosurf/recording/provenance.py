"""Where and with what a recording was made."""

import platform
import sys
from collections.abc import Mapping
from datetime import UTC, datetime
from importlib.metadata import version

import h5py
import numpy as np
import scipy

import cardiosurf


def provenance() -> Mapping[str, str | Mapping[str, str]]:
    """Return the versions of what computed this, the platform and the time, for ``meta``."""
    versions = {
        "python": sys.version.split()[0],
        "cardiosurf": cardiosurf.__version__,
        "numpy": np.__version__,
        "scipy": scipy.__version__,
        # the only one that is not imported here: the package's own file is searched for it
        "scikit-fem": version("scikit-fem"),
        "h5py": h5py.__version__,
    }
    return {
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "platform": f"{platform.system()} {platform.release()} {platform.machine()}",
        "versions": versions,
    }
