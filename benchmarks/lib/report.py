"""Report of a measurement: machine and versions, a table, a proof sheet, a baseline for comparison."""

import importlib.metadata
import json
import math
import os
import pathlib
import platform
import sys
from collections.abc import Mapping, Sequence
from typing import Any

import jax
import numpy as np
from PIL import Image

from benchmarks.lib import tables
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.datatypes.hashing import content_hash
from urbanverse_mjx.datatypes.validation import write_atomically

PACKAGES = ("urbanverse_mjx", "jax", "mujoco", "mujoco-mjx", "mujoco-warp", "mujoco-warp-pbr", "warp-lang")
SCHEMA = "urbanverse.throughput_baseline/1"
#: A rate lower than the baseline's by this share counts as slower. Repeats on an idle machine vary by 2-5 %, and
#: machines of one kind differ by about the same amount.
TOLERANCE = 0.15
#: Fields of a row that are compared, if present; all are rates.
RATES = (
    "env_steps_per_s",
    "parts.physics_steps_per_s",
    "parts.frames_per_s",
    "policy.env_steps_per_s_with_policy",
    "learn.env_steps_per_s",
    "learn.imitation.env_steps_per_s",
    "learn.finetune.env_steps_per_s",
    "physics_active.physics_steps_per_s",
)
#: Fields that identify a row, in addition to the bank.
_IDENTITY = (
    "env",
    "preset",
    "impl",
    "num_envs",
    "pixels",
    "scenes",
    "hulls",
    "physics_steps_per_env_step",
    "num_slots",
    "shading",
    "shadows",
    "sky",
    "overrides",
    "rival",
)
#: Frames on a proof sheet.
PROOF = 64


def versions() -> dict[str, str]:
    """Versions of the packages that a figure depends on."""
    found = {}
    for name in PACKAGES:
        try:
            found[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:  # run from a tree that is not installed
            found[name] = "unknown"
    return found


def cores() -> int | None:
    """Number of processor cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()


def machine() -> dict[str, Any]:
    """Device, cores and versions."""
    return {
        "device": jax.devices()[0].device_kind if jax.default_backend() != "cpu" else "cpu",
        "cores": cores(),
        "processor": platform.processor() or platform.machine(),
        "python": ".".join(map(str, sys.version_info[:3])),
        "versions": versions(),
    }


def bank_hash(bank: SceneBank) -> str:
    """Returns a hash (16 hexadecimal digits) of the inputs of the bank's scenes, constant for a file."""
    hashes = bank.meta.get("hashes", {})
    hulls = [int(n) for n in (bank.inst_hull >= 0).sum(1)]
    return content_hash({"scenes": {s: hashes.get(s, "") for s in bank.scene_ids}, "hulls": hulls})[:16]


def planned(case: Any) -> dict[str, Any]:
    """Keys of a configuration, for rows of configurations that failed without results."""
    return {"benchmark": "throughput", **case.to_json(), "pixels": list(case.size) if case.size else None}


def describe(env: Any, case: Any) -> dict[str, Any]:
    """The measurement, machine and versions."""
    view, bank = env.config.vision_config, env.bank
    hulls, objects = (bank.inst_hull >= 0).sum(1), (bank.slot_mesh >= 0).sum(1)
    seen = {name: view[name] for name in ("shading", "shadows", "sky", "light") if name in view}
    return {
        "benchmark": "throughput",
        "env": case.env,
        "preset": case.preset,
        "impl": case.impl,
        "num_envs": case.num_envs,
        "pixels": list(case.size) if case.size else None,
        "physics_steps_per_env_step": env.n_substeps,
        "num_slots": int(env.config.num_slots),
        **(seen if case.size else {}),
        **({"overrides": case.overrides} if case.overrides else {}),
        "scenes": len(env.scenes),
        "hulls": int(hulls.max()),
        "objects_seen": int(objects.max()),
        "bank": bank_hash(bank),
        "steps": case.steps,
        "repeats": case.repeats,
    }


def rounded(value: Any) -> Any:
    """Rounds to four significant digits, the precision of timings. Non-finite numbers become None for JSON."""
    if isinstance(value, dict):
        return {name: rounded(part) for name, part in value.items()}
    if isinstance(value, float):
        return float(f"{value:.4g}") if math.isfinite(value) else None
    return value


def look_up(row: Mapping[str, Any], name: str) -> Any:
    """A figure by its dotted name; None where it is missing."""
    value: Any = row
    for part in name.split("."):
        value = value.get(part) if isinstance(value, Mapping) else None
    return value


def markdown(rows: Sequence[Mapping[str, Any]]) -> str:
    """All rows as a table: the configuration, its rates, and the parts of a step's time."""
    columns = {
        "what": lambda r: r.get("rival") or f"urbanverse {r['impl']}",
        "scenes": lambda r: r.get("scenes"),
        "hulls": lambda r: r.get("hulls"),
        "envs": lambda r: r.get("num_envs"),
        "pixels": lambda r: "x".join(map(str, r["pixels"])) if r.get("pixels") else "none",
        "substeps": lambda r: r.get("physics_steps_per_env_step"),
        "env-steps/s": lambda r: r.get("env_steps_per_s"),
        "physics steps/s": lambda r: look_up(r, "parts.physics_steps_per_s") or r.get("physics_steps_per_s"),
        "frames/s": lambda r: look_up(r, "parts.frames_per_s") or r.get("frames_per_s"),
        "with policy": lambda r: look_up(r, "policy.env_steps_per_s_with_policy"),
        "training": lambda r: look_up(r, "learn.env_steps_per_s"),
        "peak MiB": lambda r: look_up(r, "memory.peak_device_mib") or look_up(r, "memory.peak_rss_mib"),
        "remarks": lambda r: r.get("error") or r.get("does", ""),
    }
    cells = ([_cell(read(row)) for read in columns.values()] for row in rows)
    return tables.markdown(list(columns), cells) + "\n"


def _cell(value: Any) -> str:
    if value is None:
        return ""
    text = f"{value:,.0f}" if isinstance(value, float) else str(value)
    return text.replace("|", "/").replace("\n", " ")


def proof_sheet(frames: np.ndarray, path: pathlib.Path) -> None:
    """Writes the first frames (n, H, W, C) uint8 in a square, one pixel apart, as a PNG."""
    shown = np.asarray(frames[:PROOF, ..., :3])
    side = math.ceil(math.sqrt(len(shown)))
    height, width = shown.shape[1:3]
    rows = math.ceil(len(shown) / side)
    sheet = np.full((rows * (height + 1) - 1, side * (width + 1) - 1, 3), 255, np.uint8)
    for i, frame in enumerate(shown):
        y, x = i // side * (height + 1), i % side * (width + 1)
        sheet[y : y + height, x : x + width] = frame
    write_atomically(path, lambda temporary: Image.fromarray(sheet).save(temporary, format="PNG"))


def identity(row: Mapping[str, Any]) -> str:
    """Returns the configuration as text; rows of equal identity can be compared."""
    return json.dumps({name: row[name] for name in (*_IDENTITY, "bank") if row.get(name) is not None}, sort_keys=True)


def _machine_of(rows: Sequence[Mapping[str, Any]]) -> Any:
    return next(row["machine"] for row in rows if "machine" in row)


def own_baseline(rows: Sequence[Mapping[str, Any]]) -> pathlib.Path:
    """File of the baseline of the device kind that rows were measured on."""
    kind = "".join(c if c.isalnum() else "-" for c in _machine_of(rows)["device"].lower())
    return pathlib.Path(__file__).parents[1] / "baselines" / f"{kind}.json"


def save_baseline(rows: Sequence[Mapping[str, Any]], path: pathlib.Path) -> None:
    """Stores the rates of rows without error as the new baseline."""
    kept = [
        {name: row[name] for name in (*_IDENTITY, "bank") if row.get(name) is not None}
        | {"rates": {name: value for name in RATES if (value := look_up(row, name)) is not None}}
        for row in rows
        if not row.get("error")
    ]
    if not kept:
        raise ValidationError("--save-baseline: found no row without an error, needed one; nothing was written.")
    body = {"schema": SCHEMA, "machine": _machine_of(rows), "rows": kept}
    text = json.dumps(body, indent=1) + "\n"
    write_atomically(path, lambda temporary: temporary.write_text(text, encoding="utf-8"))


def compare(rows: Sequence[Mapping[str, Any]], path: pathlib.Path, tolerance: float) -> list[dict[str, Any]]:
    """The rates of rows beside a baseline's: {"what", "rate", "now", "baseline", "ratio", "slower"} each.

    Raises:
      ValidationError: no baseline, one of another device or number of cores, or none of its rows was measured.
    """
    try:
        body = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, json.JSONDecodeError) as error:
        raise ValidationError(
            f"--compare {path}: found no baseline ({error}), needed one; see --save-baseline."
        ) from error
    if not isinstance(body, dict) or body.get("schema") != SCHEMA:
        raise ValidationError(f"--compare {path}: found something else, needed a baseline ({SCHEMA}).")
    here, there = _machine_of(rows), body["machine"]
    for name in ("device", "cores"):
        if here[name] != there[name]:
            raise ValidationError(
                f"--compare {path}: found a baseline of {name} {there[name]!r}, needed one of {here[name]!r}; "
                "make one here with --save-baseline."
            )
    known = {identity(row): row["rates"] for row in body["rows"]}
    found = []
    for row in rows:
        for rate, before in known.get(identity(row), {}).items():
            # A rate that is only in the baseline counts as 0.
            now = look_up(row, rate) or 0.0
            ratio = now / before
            what = row.get("rival") or identity(row)
            found.append(
                {"what": what, "rate": rate, "now": now, "baseline": before, "ratio": rounded(ratio)}
                | {"slower": ratio < 1.0 - tolerance}
            )
    if not found:
        raise ValidationError(
            f"--compare {path}: found no row of the baseline measured, needed one; use the same options."
        )
    return found
