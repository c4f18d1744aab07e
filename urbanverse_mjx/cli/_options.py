"""Options that several commands read alike: JSON, and sizes of pictures."""

import json
import re
from typing import Annotated, Any

from tyro.constructors import PrimitiveConstructorSpec

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


def image_size(text: str, option: str) -> tuple[int, int]:
    """Height and width in pixels of an option's "HEIGHTxWIDTH".

    Raises:
      NounError: another form, or no pixels; the message names the option.
    """
    found = re.fullmatch(r"([1-9]\d{0,4})x([1-9]\d{0,4})", text)
    if found is None:
        raise NounError(f"{option}: found {text!r}, needed HEIGHTxWIDTH in pixels, such as 180x320.")
    return int(found[1]), int(found[2])


def _is_size(value: Any) -> bool:
    return isinstance(value, tuple) and len(value) == 2 and all(isinstance(n, int) for n in value)


#: Type of an option `--size HEIGHTxWIDTH`: (height, width) in pixels.
ImageSize = Annotated[
    tuple[int, int],
    PrimitiveConstructorSpec(
        nargs=1,
        metavar="HEIGHTxWIDTH",
        instance_from_str=lambda words: image_size(words[0], "--size"),
        is_instance=_is_size,
        str_from_instance=lambda size: [f"{size[0]}x{size[1]}"],
    ),
]
