"""Metadata of a policy file (ONNX): `PolicyRecord`, JSON under `METADATA_KEY` in the file's metadata."""

import dataclasses
import json
from collections.abc import Mapping, Sequence
from typing import Any

from . import validation as v

SCHEMA = "urbanverse.onnx/2"
#: Older files, which do not describe the robot.
_OLD_SCHEMA = "urbanverse.onnx/1"
#: Key of the record among an ONNX file's metadata.
METADATA_KEY = "urbanverse"
#: Prefix of an input's name for the output that is fed back to it at the next step.
NEXT = "next_"
#: Length of the first axis, which counts robots, in `TensorRecord.shape`.
BATCH = "n"


@dataclasses.dataclass(frozen=True)
class TensorRecord:
    """One input or output.

    Attributes:
      name: in the file.
      shape: axes, the first one `BATCH`.
      dtype: "uint8" or "float32".
      unit: of its numbers, SI or "1".
      meaning: what they are.
      normalisation: scaling that the caller must apply to the numbers, or none.
    """

    name: str
    shape: tuple[int | str, ...]
    dtype: str
    unit: str
    meaning: str
    normalisation: str

    @staticmethod
    def from_json(value: Any, where: str) -> "TensorRecord":
        m = v.mapping(value, where, [f.name for f in dataclasses.fields(TensorRecord)])
        return TensorRecord(**{**m, "shape": tuple(m["shape"])})


@dataclasses.dataclass(frozen=True)
class RobotRecord:
    """The robot of a policy: what turns its actions into velocities, and its camera.

    Attributes:
      name: e.g. "coco".
      max_speed: m/s, max_yaw_rate: rad/s: a waypoint 1 m ahead means `max_speed`.
      camera_fovy: rad, vertical field of view of the front camera; 0 for a policy without images.
    """

    name: str
    max_speed: float
    max_yaw_rate: float
    camera_fovy: float

    @staticmethod
    def from_json(value: Any, where: str) -> "RobotRecord":
        m = v.mapping(value, where, [f.name for f in dataclasses.fields(RobotRecord)])
        speeds = {k: v.number(m[k], f"{where}.{k}", above=0.0) for k in ("max_speed", "max_yaw_rate")}
        fovy = v.number(m["camera_fovy"], f"{where}.camera_fovy", minimum=0.0, maximum=3.1)
        return RobotRecord(v.text(m["name"], f"{where}.name"), camera_fovy=fovy, **speeds)


@dataclasses.dataclass(frozen=True)
class PolicyRecord:
    """Interface of a policy file.

    Attributes:
      inputs, outputs: in the file's order. An input X with an output `next_`X is memory: zeros when an episode begins,
        then the output of the previous step.
      rate_hz: control steps per second.
      environment, env_config: the task it was trained for, as `registry.load` takes it.
      steps: env-steps of its training.
      versions: of the packages that trained it.
      largest_difference: of its outputs from JAX's at export.
      observations: over how many.
      robot: that it was trained with; None in files of before.
    """

    inputs: tuple[TensorRecord, ...]
    outputs: tuple[TensorRecord, ...]
    rate_hz: float
    environment: str
    env_config: Mapping[str, Any]
    steps: int
    versions: Mapping[str, str]
    largest_difference: float = 0.0
    observations: int = 0
    robot: RobotRecord | None = None

    def to_json(self) -> str:
        return json.dumps({"schema": SCHEMA, **dataclasses.asdict(self)}, ensure_ascii=False)

    @staticmethod
    def from_json(text: str, where: str) -> "PolicyRecord":
        """The record in a file's metadata.

        Raises:
          ValidationError: no JSON, fields that are missing or unknown, or another schema.
        """
        try:
            body = json.loads(text)
        except ValueError as error:
            raise v.fail(
                where, f"metadata that is no JSON ({error})", "what `urbanverse export-onnx` writes"
            ) from error
        fields = [f.name for f in dataclasses.fields(PolicyRecord) if f.name != "robot"]
        m = dict(v.mapping(body, where, ["schema", *fields], ["robot"]))
        v.choice(m.pop("schema"), f"{where}: schema", (SCHEMA, _OLD_SCHEMA))
        robot = m.pop("robot", None)
        m["robot"] = None if robot is None else RobotRecord.from_json(robot, f"{where}: robot")
        for side in ("inputs", "outputs"):
            m[side] = tuple(TensorRecord.from_json(t, f"{where}: {side}") for t in v.items(m[side], f"{where}: {side}"))
        return PolicyRecord(**m)


def memories(inputs: Sequence[str], outputs: Sequence[str]) -> tuple[str, ...]:
    """Names of the memory inputs, to which an output is fed back."""
    return tuple(name for name in inputs if NEXT + name in outputs)
