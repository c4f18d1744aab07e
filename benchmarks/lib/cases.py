"""Configurations of the throughput benchmark: one `Case` per configuration, from the command line or a grid file."""

import dataclasses
import itertools
import json
import pathlib
from collections.abc import Iterable, Mapping
from typing import Any

from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.datatypes import validation as v

#: Available measures of a configuration, see `measure`.
MEASURES = ("step", "parts", "refit", "active", "policy", "learn")


def image_size(text: str, name: str) -> tuple[int, int] | None:
    """Height and width of "HxW"; None of "none".

    Args:
      name: of the option, for the error.

    Raises:
      ValidationError: it is neither.
    """
    if text == "none":
        return None
    try:
        height, width = (int(part) for part in text.split("x"))
    except ValueError:
        height = width = 0
    if min(height, width) < 1:
        raise ValidationError(f"{name}: found {text!r}, needed HEIGHTxWIDTH such as 36x64, or none.")
    return height, width


@dataclasses.dataclass(frozen=True)
class Case:
    """One configuration. Fields that are None keep the preset's values.

    Attributes:
      bank: file; None = the shipped streets.
      scenes: number of scenes to keep, from the first.
      hulls: largest number of hulls per scene (`banks.with_hulls`).
      pixels: "HxW", or "none" for an environment without camera.
      substeps: physics steps per control step.
      overrides: further env config, flat dotted keys.
      ppo: further training config (measure "learn").
      measure: of `MEASURES`.
      rivals: `baselines.BASELINES` to measure in addition.
      steps: control steps in one timed run.
      repeats: timed runs.
      iterations: PPO iterations of "learn".
    """

    env: str = "CocoNav"
    preset: str = "cpu"
    impl: str = "auto"
    num_envs: int = 64
    pixels: str = "36x64"
    bank: str | None = None
    scenes: int | None = None
    hulls: int | None = None
    substeps: int | None = None
    num_slots: int | None = None
    shading: str | None = None
    shadows: bool | None = None
    sky: bool | None = None
    overrides: dict[str, Any] = dataclasses.field(default_factory=dict)
    ppo: dict[str, Any] = dataclasses.field(default_factory=dict)
    measure: tuple[str, ...] = ("step", "parts", "active")
    rivals: tuple[str, ...] = ()
    steps: int = 20
    repeats: int = 5
    iterations: int = 4
    seed: int = 0

    def __post_init__(self) -> None:
        for name in ("num_envs", "steps", "repeats", "iterations"):
            v.integer(getattr(self, name), name, 1)
        for name in ("scenes", "hulls", "substeps"):
            if getattr(self, name) is not None:
                v.integer(getattr(self, name), name, 1)
        unknown = [m for m in self.measure if m not in MEASURES]
        if unknown:
            raise ValidationError(f"measure: found {unknown[0]!r}, needed some of {', '.join(MEASURES)}.")
        _ = self.size

    @property
    def size(self) -> tuple[int, int] | None:
        """Height and width of the frame; None without camera."""
        return image_size(self.pixels, "pixels")

    def config_overrides(self, ctrl_dt: float) -> dict[str, Any]:
        """Overrides of the env's config; `ctrl_dt` (s) is the preset's control step."""
        found: dict[str, Any] = {"preset": self.preset, "impl": self.impl, **self.overrides}
        if self.size is None:
            found["vision"] = False
        else:
            found["vision_config.height"], found["vision_config.width"] = self.size
        for name in ("shading", "shadows", "sky"):
            if getattr(self, name) is not None:
                found[f"vision_config.{name}"] = getattr(self, name)
        if self.substeps is not None:
            found["sim_dt"] = ctrl_dt / self.substeps
        if self.num_slots is not None:
            found["num_slots"] = self.num_slots
        return found

    def to_json(self) -> dict[str, Any]:
        return {k: list(x) if isinstance(x, tuple) else x for k, x in dataclasses.asdict(self).items()}

    @staticmethod
    def from_json(value: Mapping[str, Any]) -> "Case":
        """Makes a case from a mapping of some of its fields.

        Raises:
          ValidationError: a key is not a field, or a value is invalid.
        """
        names = [f.name for f in dataclasses.fields(Case)]
        unknown = [k for k in value if k not in names]
        if unknown:
            raise ValidationError(f"grid: found the key {unknown[0]!r}, needed some of {', '.join(names)}.")
        lists = {k: _texts(value[k], k) for k in ("measure", "rivals") if k in value}
        return Case(**{**value, **lists})


def _texts(value: Any, key: str) -> tuple[str, ...]:
    if isinstance(value, str):
        value = [part for part in value.split(",") if part]
    if not isinstance(value, (list, tuple)) or not all(isinstance(x, str) for x in value):
        raise ValidationError(f"grid: found {value!r} for {key!r}, needed a list of texts.")
    return tuple(value)


def product(base: Case, axes: Mapping[str, Iterable[Any]]) -> list[Case]:
    """Returns `base` with every combination of the values of `axes` (field name to values), the last axis fastest."""
    names = list(axes)
    return [
        dataclasses.replace(base, **dict(zip(names, values, strict=True)))
        for values in itertools.product(*axes.values())
    ]


def read_grid(path: pathlib.Path, base: Case) -> list[Case]:
    """Reads cases from a JSON file: a list of objects with some fields of `Case`; the others are `base`'s.

    Raises:
      ValidationError: no such file, no list of objects, or a wrong key.
    """
    try:
        rows = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, json.JSONDecodeError) as error:
        raise ValidationError(f"--grid {path}: found no readable JSON ({error}), needed a list of objects.") from error
    if not isinstance(rows, list) or not rows or not all(isinstance(row, dict) for row in rows):
        raise ValidationError(f"--grid {path}: found something else, needed a list of at least one object.")
    return [Case.from_json({**base.to_json(), **row}) for row in rows]
