"""Scores of the fidelity table's rows on a street, on disk, so that a stopped run continues."""

import dataclasses
import pathlib
from typing import Any

import numpy as np

from benchmarks.lib.fidelity_scores import Scores
from urbanverse_mjx.datatypes import validation as v

Row = tuple[Scores, dict[str, float]]
_TYPES = {
    "right": bool,
    "small": bool,
    "front": bool,
    "distance": float,
    "heading": float,
    "volume": float,
    "size": float,
}


def save(path: pathlib.Path, rows: dict[str, Row]) -> None:
    """Writes the rows of one street."""
    path.parent.mkdir(parents=True, exist_ok=True)
    v.write_json(
        path, {name: {"scores": _plain(scores), "figures": figures} for name, (scores, figures) in rows.items()}
    )


def load(path: pathlib.Path) -> dict[str, Row]:
    """The rows of one street, as far as they were done; none without a file.

    Raises:
      ValidationError: a file that is no such record.
    """
    if not path.is_file():
        return {}
    names = [f.name for f in dataclasses.fields(Scores)]
    rows = {}
    for name, row in v.read_json(path, "scores of a street").items():
        body = dict(v.mapping(row["scores"], f"{path.name}: {name}", names))
        body |= {key: np.array(body[key], kind) for key, kind in _TYPES.items()}
        body["size"] = body["size"].reshape(-1, 2)
        body["detections"] = {k: np.array(x, float).reshape(-1, 2) for k, x in body["detections"].items()}
        body["pairs"] = [(found, true) for found, true in body["pairs"]]
        rows[name] = Scores(**body), dict(row["figures"])
    return rows


def _plain(scores: Scores) -> dict[str, Any]:
    body = {f.name: getattr(scores, f.name) for f in dataclasses.fields(Scores)}
    body |= {key: body[key].tolist() for key in _TYPES}
    body["detections"] = {label: rows.tolist() for label, rows in scores.detections.items()}
    return body
