"""JSON Schemas of results: every key is always there, and no other."""

from typing import Any


def result_schema(root: type, identity: str) -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of a result as it is written.

    Parameters
    ----------
    root : type
        The dataclass whose fields are the result's keys.
    identity : str
        Its ``$id``: name and version.
    """
    from pydantic import TypeAdapter

    schema = TypeAdapter(root).json_schema(mode="serialization")
    for part in (schema, *schema.get("$defs", {}).values()):
        if "properties" in part:
            part["required"] = sorted(part["properties"])
            part["additionalProperties"] = False
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", "$id": identity, **schema}
