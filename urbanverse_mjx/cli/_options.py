"""Options of several commands: JSON objects, and sizes of images."""

import json
import re
from collections.abc import Mapping
from typing import Annotated, Any

import tyro
from tyro.constructors import PrimitiveConstructorSpec

from ..datatypes import ValidationError


def json_object(text: str, option: str) -> dict[str, Any]:
    """Parses the JSON object of an option.

    Raises:
      ValidationError: the text is not a JSON object; the message names the option.
    """
    try:
        value = json.loads(text)
    except json.JSONDecodeError as error:
        raise ValidationError(
            f"{option}: found {text!r}, which is not JSON ({error}), needed a JSON object."
        ) from error
    if not isinstance(value, dict):
        raise ValidationError(f"{option}: found {text!r}, needed a JSON object such as '{{\"key\": 1}}'.")
    return value


def image_size(text: str, option: str) -> tuple[int, int]:
    """Parses height and width in pixels of an option "HEIGHTxWIDTH".

    Raises:
      ValidationError: the text has another form, or a size is 0; the message names the option.
    """
    found = re.fullmatch(r"([1-9]\d{0,4})x([1-9]\d{0,4})", text)
    if found is None:
        raise ValidationError(f"{option}: found {text!r}, needed HEIGHTxWIDTH in pixels, such as 180x320.")
    return int(found[1]), int(found[2])


def _is_size(value: Any) -> bool:
    return isinstance(value, tuple) and len(value) == 2 and all(isinstance(n, int) for n in value)


def _json_option(option: str) -> Any:
    """How an option with a JSON object is read and shown."""
    return PrimitiveConstructorSpec(
        nargs=1,
        metavar="JSON",
        instance_from_str=lambda words: json_object(words[0], option),
        is_instance=lambda value: isinstance(value, Mapping),
        str_from_instance=lambda value: [json.dumps(dict(value))],
    )


#: Type of the option `--playground-config-overrides JSON`: flat dotted keys of the environment's config.
EnvOverrides = Annotated[
    Mapping[str, Any],
    tyro.conf.arg(name="playground-config-overrides"),
    _json_option("--playground-config-overrides"),
]
#: Type of the option `--ppo-overrides JSON`: flat dotted keys of the training's config.
PpoOverrides = Annotated[Mapping[str, Any], _json_option("--ppo-overrides")]
#: Type of the option `--people`, which other commands call `--dynamic`.
Crowded = Annotated[bool, tyro.conf.arg(aliases=["--dynamic"])]
#: The same option where the field is called dynamic.
Dynamic = Annotated[bool, tyro.conf.arg(name="people", aliases=["--dynamic"])]
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
