"""Which plain YAML scalars are numbers, true, false or null: YAML 1.2's core schema.

YAML 1.1, PyYAML's default, reads ``1e-3`` as text, ``no`` as false, ``1:30`` as 90 and
``2001-01-01`` as a date. The reader and the writer share these words, so that what is written is
read back as it was.
"""

import re

import yaml

CORE = "tag:yaml.org,2002:"

_WORDS = {
    "null": (r"^(?:~|null|Null|NULL|)$", ["~", "n", "N", ""]),
    "bool": (r"^(?:true|True|TRUE|false|False|FALSE)$", list("tTfF")),
    "int": (r"^(?:[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+)$", list("-+0123456789")),
    "float": (
        (
            r"^(?:[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?"
            r"|[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN))$"
        ),
        list("-+.0123456789"),
    ),
    "merge": (r"^<<$", ["<"]),
}


class CoreLoader(yaml.SafeLoader):
    """PyYAML's safe loader with the scalars of YAML 1.2."""


class CoreDumper(yaml.SafeDumper):
    """PyYAML's safe dumper with the scalars of YAML 1.2; never writes anchors."""

    def ignore_aliases(self, data: object) -> bool:
        """Write equal lists twice rather than as anchor and alias."""
        return True


for _class in (CoreLoader, CoreDumper):
    _class.yaml_implicit_resolvers = {}
    for _word, (_pattern, _first) in _WORDS.items():
        _class.add_implicit_resolver(CORE + _word, re.compile(_pattern), _first)


def scalar(tag: str, text: str) -> str | int | float | bool | None:
    """Return the value of a plain scalar that the core schema gave ``tag``."""
    match tag.removeprefix(CORE):
        case "null":
            return None
        case "bool":
            return text.lower() == "true"
        case "int" if text.startswith(("0o", "0x")):
            return int(text, base=0)
        case "int":
            # more digits than any float holds; Python refuses to parse thousands of them
            return int(text) if len(text) < 400 else float(text)
        case "float":
            return float(text.lower().replace(".inf", "inf").replace(".nan", "nan"))
        case _:
            return text
