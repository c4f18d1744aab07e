"""A tiny recurrent policy file with the metadata of `export-onnx`, whose actions depend on every input."""

import pathlib
from typing import Any

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

from urbanverse_mjx.datatypes.policy_file import METADATA_KEY, PolicyRecord, RobotRecord, TensorRecord

SIZE = (12, 16)
SPEED, YAW_RATE = 2.0, 1.0


def robot_policy(path: pathlib.Path, rate_hz: float = 5.0, mode: str = "waypoint", limit: float = 0.0) -> pathlib.Path:
    """Writes a policy that drives in curves: (0.6 + 0.1 sin(memory), 0.2 + 0.1 mean(image) / 255 + 0.001 tanh(sum of
    goal and proprio)); its memory counts steps."""
    f32, u8 = TensorProto.FLOAT, TensorProto.UINT8
    values = {"pixels/front": (u8, [*SIZE, 3]), "goal": (f32, [2]), "proprio": (f32, [5]), "memory": (f32, [1])}
    inputs = [helper.make_tensor_value_info(k, t, ["n", *shape]) for k, (t, shape) in values.items()]
    outputs = [helper.make_tensor_value_info(k, f32, ["n", n]) for k, n in (("action", 2), ("next_memory", 1))]

    def node(kind: str, given: list[str], out: str, **attributes: Any) -> onnx.NodeProto:
        return helper.make_node(kind, given, [out], **attributes)

    nodes = [
        node("Cast", ["pixels/front"], "colours", to=f32),
        node("Flatten", ["colours"], "flat"),
        node("ReduceMean", ["flat", "axis"], "light", keepdims=1),
        node("Mul", ["light", "by_light"], "from_light"),
        node("Concat", ["goal", "proprio"], "felt", axis=1),
        node("ReduceSum", ["felt", "axis"], "sum", keepdims=1),
        node("Tanh", ["sum"], "bounded"),
        node("Mul", ["bounded", "by_felt"], "from_felt"),
        node("Add", ["from_light", "from_felt"], "turned"),
        node("Add", ["turned", "left"], "y"),
        node("Sin", ["memory"], "wave"),
        node("Mul", ["wave", "by_wave"], "from_wave"),
        node("Add", ["from_wave", "ahead"], "x"),
        node("Concat", ["x", "y"], "action", axis=1),
        node("Add", ["memory", "one"], "next_memory"),
    ]
    numbers = {"by_light": 0.1 / 255, "by_felt": 0.001, "left": 0.2, "by_wave": 0.1, "ahead": 0.6, "one": 1.0}
    tensors = [numpy_helper.from_array(np.array([[x]], np.float32), k) for k, x in numbers.items()]
    tensors.append(numpy_helper.from_array(np.array([1]), "axis"))
    model = helper.make_model(
        helper.make_graph(nodes, "policy", inputs, outputs, tensors),
        opset_imports=[helper.make_opsetid("", 18)],
        ir_version=9,
    )

    def record(name: str, kind: str, shape: list[int]) -> TensorRecord:
        return TensorRecord(name, ("n", *shape), kind, "1", name, "none")

    entry = model.metadata_props.add()
    entry.key = METADATA_KEY
    entry.value = PolicyRecord(
        inputs=tuple(record(k, "uint8" if t == u8 else "float32", shape) for k, (t, shape) in values.items()),
        outputs=(record("action", "float32", [2]), record("next_memory", "float32", [1])),
        rate_hz=rate_hz,
        environment="CocoNav",
        env_config={"action_mode": mode, "goal_observation_limit": limit},
        steps=0,
        versions={},
        robot=RobotRecord("coco", SPEED, YAW_RATE, 0.9),
    ).to_json()
    path.write_bytes(model.SerializeToString())
    return path
