"""The YAML schema and its loader: the only place that meets a dict."""

from cardiosurf.config.decode import ConfigError
from cardiosurf.config.dump import dump_config
from cardiosurf.config.loader import Loaded, load, load_text, overlay
from cardiosurf.config.schema import config_schema
from cardiosurf.config.sections import Config, regions_of, target_key

__all__ = [
    "Config",
    "ConfigError",
    "Loaded",
    "config_schema",
    "dump_config",
    "load",
    "load_text",
    "overlay",
    "regions_of",
    "target_key",
]
