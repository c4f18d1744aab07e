"""Options whose value is JSON."""

import json
from typing import Any

from ..datatypes import NounError


def json_object(text: str, option: str) -> dict[str, Any]:
    """The object that an option's text holds.

    Raises:
      NounError: no JSON, or no object; the message names the option.
    """
    try:
        value = json.loads(text)
    except json.JSONDecodeError as error:
        raise NounError(f"{option}: found {text!r}, which is not JSON ({error}), needed a JSON object.") from error
    if not isinstance(value, dict):
        raise NounError(f"{option}: found {text!r}, needed a JSON object such as '{{\"key\": 1}}'.")
    return value
