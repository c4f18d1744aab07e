"""Options of several commands: JSON objects, sizes of images, and the forms of texts that the help shows."""

import dataclasses
import json
import re
from collections.abc import Callable, Mapping, Sequence
from typing import Annotated, Any

import tyro
from tyro.constructors import ConstructorRegistry, PrimitiveConstructorSpec, StructConstructorSpec, StructTypeInfo

from ..datatypes import ValidationError

#: The form of each option or argument that is a text, by its field, in place of STR in the help.
FORMS = {
    "agent": "NAME",
    "blur": "NAME|MODULE:FUNCTION",
    "city": "NAME",
    "command_topic": "/NAME",
    "contact": "TEXT",
    "coordinator": "HOST:PORT|auto",
    "country": "NAME|CODE",
    "encoder": "SPEED",
    "env_name": "NAME",
    "folder": "DATASET",
    "host": "ADDRESS",
    "image_topic": "/NAME",
    "licence": "NAME",
    "meta": "JSON",
    "odometry_topic": "/NAME",
    "only": "TEXT",
    "policy": "NAME|PATH",
    "preset": "NAME",
    "robot": "HOST[:PORT]|ros",
    "scene": "NAME",
    "scenes": "SPLIT|ID,ID",
    "sequence": "NAME",
    "sets": "[NAME ...]",
    "split": "NAME",
    "suffix": "TEXT",
    "title": "TEXT",
}


#: Dataclasses whose fields are being read.
_OPEN: list[Any] = []


def _with_forms(info: StructTypeInfo) -> StructConstructorSpec | None:
    """A rule for tyro: gives those fields of a dataclass that are texts the metavars of `FORMS`, where their annotation
    has none."""
    if not dataclasses.is_dataclass(info.type) or info.type in _OPEN:
        return None
    _OPEN.append(info.type)  # so that tyro's own rule is asked
    try:
        spec = ConstructorRegistry.get_struct_spec(info)
    finally:
        _OPEN.pop()
    if not isinstance(spec, StructConstructorSpec):
        return None
    fields = tuple(
        dataclasses.replace(field, type=Annotated[field.type, tyro.conf.arg(metavar=FORMS[field.name])])
        if field.name in FORMS and not _has_form(field.type)
        else field
        for field in spec.fields
    )
    return dataclasses.replace(spec, fields=fields)


def _has_form(kind: Any) -> bool:
    """Whether an annotation names a metavar, or the type is no text."""
    named = any(getattr(extra, "metavar", None) for extra in getattr(kind, "__metadata__", ()))
    return named or "str" not in str(kind)


def parse[T](kind: Callable[..., T], argv: Sequence[str], prog: str) -> T:
    """Reads a command's words into a dataclass, or one of several as subcommands, see `tyro.cli`.

    The help names the form of each value, and "None" is no value: an option that is not given has its default.
    """
    return tyro.cli(kind, args=list(argv), prog=prog, config=(tyro.conf.DisallowNone,), registry=_registry())


def parse_subcommand(commands: Mapping[str, Callable[..., Any]], argv: Sequence[str], prog: str) -> Any:
    """Reads the first word as the name of a function or dataclass and the others as its arguments, as `parse` does;
    returns what it returns."""
    return tyro.extras.subcommand_cli_from_dict(
        dict(commands), args=list(argv), prog=prog, config=(tyro.conf.DisallowNone,), registry=_registry()
    )


def _registry() -> ConstructorRegistry:
    registry = ConstructorRegistry()
    registry.struct_rule(_with_forms)
    return registry


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
