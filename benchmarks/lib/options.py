"""Options of an environment or a training on the command line: NAME=VALUE, with values in JSON."""

import argparse
import json
from collections.abc import Iterable
from typing import Any


def option(text: str) -> str:
    """The type of such an option for argparse, which refuses another text in a sentence."""
    name, equals, value = text.partition("=")
    try:
        json.loads(value)
    except json.JSONDecodeError:
        known = False
    else:
        known = bool(name and equals)
    if not known:
        raise argparse.ArgumentTypeError(
            f"found {text!r}, needed NAME=VALUE with a value in JSON, such as ctrl_dt=0.1, vision=false or "
            "'light=\"direct\"'"
        )
    return text


def parsed_options(texts: Iterable[str]) -> dict[str, Any]:
    """Name -> value of options that `option` takes."""
    pairs = (text.partition("=") for text in texts)
    return {name: json.loads(value) for name, _, value in pairs}
