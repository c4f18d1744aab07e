"""Canonical content hashes: the same content gives the same hash on every machine.

Floats are quantised before hashing (default 1e-3: 1 mm, 1 mrad, 1 g), keys sorted, UTF-8 JSON; arrays
hash their shape and quantised values. File bytes (Parquet, XML, PNG) are never hashed.
"""

import hashlib
import json
from typing import Any

import numpy as np

QUANTUM = 1e-3


def canonical(value: Any, quantum: float = QUANTUM) -> Any:
    """Converts nested dicts, sequences, arrays and scalars to plain JSON with floats in whole quanta."""
    if isinstance(value, dict):
        return {str(k): canonical(v, quantum) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [canonical(v, quantum) for v in value]
    if isinstance(value, np.ndarray):
        flat = value.ravel()
        body = np.round(flat / quantum).astype(np.int64) if flat.dtype.kind == "f" else flat
        return {"shape": list(value.shape), "values": body.tolist()}
    if isinstance(value, np.generic):
        return canonical(value.item(), quantum)
    if isinstance(value, float):
        return {"q": round(value / quantum)}
    return value


def content_hash(value: Any, quantum: float = QUANTUM) -> str:
    """64 hexadecimal digits over the canonical form of `value`."""
    body = json.dumps(canonical(value, quantum), sort_keys=True, ensure_ascii=False, separators=(",", ":"))
    return hashlib.sha256(body.encode("utf-8")).hexdigest()
