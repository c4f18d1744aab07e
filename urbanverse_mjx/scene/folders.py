"""Finds compiled scenes on disk."""

import pathlib
from collections.abc import Sequence

from ..datatypes import validation as v
from ..work_folder import is_unfinished, recover_below
from .metadata import SCHEMA


def scene_folders(places: Sequence[pathlib.Path]) -> list[pathlib.Path]:
    """Compiled scenes among folders and their subfolders at any depth; each once, sorted by name.

    A scene that a killed compilation had moved aside is restored first; one that is being compiled does not count.

    Raises:
      ValidationError: there are none, or two have one name.
    """
    found: dict[str, pathlib.Path] = {}
    for place in places:
        recover_below(place)
        inside = [place] if (place / "metadata.json").is_file() else [p.parent for p in place.rglob("metadata.json")]
        for folder in inside:
            if is_unfinished(folder, place):
                continue
            body = v.read_json(folder / "metadata.json", "scene's metadata")
            if not isinstance(body, dict) or body.get("schema") != SCHEMA:
                continue
            if "statistics" not in body:
                raise v.fail(
                    str(folder), "a scene compiled before there were statistics", "a new one", "compile it again"
                )
            if found.setdefault(body["id"], folder) != folder:
                raise v.fail(str(folder), f"another scene called {body['id']!r}", "every scene once", "leave one out")
    if not found:
        raise v.fail(
            ", ".join(map(str, places)) or "folders", "no compiled scene", "at least one", "compile some first"
        )
    return [found[name] for name in sorted(found)]
