"""Exports a trained policy as an ONNX file by jax2onnx and compares it with JAX.

The file computes in single precision, also for convolutions that were trained in bfloat16, which CPU runtimes do not
support. `datatypes.policy_file` describes the metadata.
"""

import dataclasses
import logging
import pathlib
from collections.abc import Callable, Iterator
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from ml_collections import ConfigDict

from ..datatypes import ValidationError
from ..datatypes import validation as v
from ..datatypes.policy_file import BATCH, METADATA_KEY, NEXT, PolicyRecord, RobotRecord, TensorRecord
from .networks import PIXELS
from .policy import PolicySpec, latest_policy, load_params, network_factory

#: Largest difference of outputs to those of JAX, due to the order of sums in single precision.
TOLERANCE = 1e-5
#: Number of observations for the comparison of an exported file, and batch size.
OBSERVATIONS, _AT_ONCE = 1000, 100
MEMORY = "memory"


@dataclasses.dataclass(frozen=True)
class _Step:
    """One control step as a function of arrays, whose leading axis is the robots.

    Attributes:
      function: arrays in the order of `inputs` -> tuple in the order of `outputs`.
      inputs: name -> (shape without the leading axis, dtype).
      outputs: name -> shape.
    """

    function: Callable[..., tuple[jax.Array, ...]]
    inputs: dict[str, tuple[tuple[int, ...], Any]]
    outputs: dict[str, tuple[int, ...]]


class _Reads(dict[str, Any]):
    """Mapping of observations that records which were read."""

    def __init__(self, values: dict[str, Any]) -> None:
        super().__init__(values)
        self.names: list[str] = []

    def __getitem__(self, name: str) -> Any:
        if name not in self.names:
            self.names.append(name)
        return super().__getitem__(name)


def export_onnx(source: pathlib.Path, out: pathlib.Path) -> PolicyRecord:
    """Writes the newest policy under `source` as the ONNX file `out`; returns its metadata.

    Raises:
      ValidationError: there is no policy, the file name does not end in .onnx, or an output differs from JAX's by more
        than `TOLERANCE` over `OBSERVATIONS` random observations. No file is written then.
    """
    if out.suffix != ".onnx":
        raise ValidationError(f"export-onnx: found {out.name!r} to write, needed a name that ends in .onnx.")
    folder = latest_policy(source)
    spec = PolicySpec.load(folder)
    step = _step(spec, jax.tree.map(lambda x: np.asarray(x, np.float32), load_params(folder)[1]))
    model = _converted(step)
    difference = largest_difference(model.SerializeToString(), step)
    if difference > TOLERANCE:
        raise ValidationError(
            f"export-onnx: found answers that differ from JAX's by {difference:.2g}, needed at most {TOLERANCE:g}; "
            "report it with the policy's policy.json."
        )
    record = _record(spec, step, difference)
    _note(model, record)
    body = model.SerializeToString()
    v.write_atomically(out, lambda p: p.write_bytes(body))
    return record


def _step(spec: PolicySpec, params: Any) -> _Step:
    """The policy's deterministic step in single precision."""
    config = ConfigDict(spec.ppo_config)
    if "bfloat16" in config.network:
        config.network.bfloat16 = False
    if "convolution" in config.network:
        config.network.convolution = "xla"
    types = {
        name: jnp.uint8 if name.startswith(("pixels/", "privileged_map")) else jnp.float32 for name in spec.observations
    }
    shapes = {name: (tuple(shape), types[name]) for name, shape in spec.observations.items()}
    student = config.get("algorithm") == "dagger"
    act, inputs, outputs = (_student if student else _feed_forward)(spec, config, params, shapes)
    return _Step(act, inputs, {"action": (spec.action_size,), **outputs})


def _feed_forward(spec: PolicySpec, config: ConfigDict, params: Any, shapes: dict[str, Any]) -> Any:
    sizes = {name: shape for name, (shape, _) in shapes.items()}
    network = network_factory(config)(sizes, spec.action_size).policy_network
    read: list[str] = []

    def shape_of(obs: dict[str, jax.Array]) -> Any:
        noted = _Reads(obs)
        out = network.apply(None, params, noted)
        read.extend(noted.names)
        return out

    jax.eval_shape(
        shape_of, {name: jax.ShapeDtypeStruct((1, *shape), dtype) for name, (shape, dtype) in shapes.items()}
    )

    def act(*values: jax.Array) -> tuple[jax.Array, ...]:
        logits = network.apply(None, params, dict(zip(read, values, strict=True)))
        # The mode of a normal distribution squashed by tanh; the standard deviations come after the means.
        return (jnp.tanh(logits[..., : spec.action_size]),)

    return act, {name: shapes[name] for name in read}, {}


def _student(spec: PolicySpec, config: ConfigDict, params: Any, shapes: dict[str, Any]) -> Any:
    from .dagger import make_student
    from .student import SEEN

    network = make_student(config, spec.action_size).clone(single_step=True)
    inputs = {name: shapes[name] for name in SEEN}
    if not network.memory:
        return (lambda *values: _student_step(network, params, values)[:1]), inputs, {}
    inputs[MEMORY] = ((network.memory,), jnp.float32)
    return (lambda *values: _student_step(network, params, values)), inputs, {NEXT + MEMORY: (network.memory,)}


def _student_step(network: Any, params: Any, values: tuple[jax.Array, ...]) -> tuple[jax.Array, jax.Array]:
    from .student import SEEN

    obs = {name: x[None] for name, x in zip(SEEN, values, strict=False)}
    goal = values[SEEN.index("goal")]
    memory = values[len(SEEN)] if network.memory else jnp.zeros((goal.shape[0], 0))
    # The caller passes zeros when an episode begins.
    begins = jnp.zeros((1, goal.shape[0]), bool)
    action, memory, _ = network.apply(params, obs, memory, begins)
    return action[0], memory


def _converted(step: _Step) -> Any:
    """Converts a step to an `onnx.ModelProto` for any number of robots."""
    import jax2onnx

    inputs = [jax.ShapeDtypeStruct((BATCH, *shape), dtype) for shape, dtype in step.inputs.values()]
    log = logging.getLogger("onnx_ir")
    level = log.level
    log.setLevel(logging.ERROR)  # jax2onnx warns about every shape that depends on the number of robots
    try:
        return jax2onnx.to_onnx(
            lambda *values: step.function(*values),
            inputs,
            model_name="policy",
            input_names=list(step.inputs),
            output_names=list(step.outputs),
        )
    finally:
        log.setLevel(level)


def _random(step: _Step, count: int, seed: int) -> Iterator[list[np.ndarray]]:
    """Yields batches of `count` random observations in all: noise images, vectors of some units, memories in [-1,
    1]."""
    rng = np.random.default_rng(seed)
    for begin in range(0, count, _AT_ONCE):
        n = min(_AT_ONCE, count - begin)
        batch = []
        for name, (shape, dtype) in step.inputs.items():
            if dtype == jnp.uint8:
                batch.append(rng.integers(0, 256, (n, *shape), np.uint8))
            elif name == MEMORY:
                batch.append(rng.uniform(-1.0, 1.0, (n, *shape)).astype(np.float32))
            else:
                batch.append((10.0 if name == "goal" else 1.0) * rng.normal(size=(n, *shape)).astype(np.float32))
        yield batch


def largest_difference(model: bytes, step: _Step, count: int = OBSERVATIONS, seed: int = 0) -> float:
    """Largest difference between a file's outputs and those of a step in JAX on the CPU, over `count` random
    observations."""
    import onnxruntime

    session = onnxruntime.InferenceSession(model, providers=["CPUExecutionProvider"])
    names, largest = list(step.outputs), 0.0
    with jax.default_device(jax.devices("cpu")[0]):
        function = jax.jit(step.function)
        for batch in _random(step, count, seed):
            found = session.run(names, dict(zip(step.inputs, batch, strict=True)))
            for mine, theirs in zip(found, function(*batch), strict=True):
                largest = max(largest, float(np.abs(mine - np.asarray(theirs)).max()))
    return largest


def _record(spec: PolicySpec, step: _Step, difference: float) -> PolicyRecord:
    config = spec.env_config
    robot = _robot_of(config, PIXELS in step.inputs)

    def tensor(name: str, shape: tuple[int, ...], dtype: Any, texts: tuple[str, str, str]) -> TensorRecord:
        return TensorRecord(name, (BATCH, *shape), np.dtype(dtype).name, *texts)

    def about(name: str) -> tuple[str, str, str]:
        return _about(name, config, 0.0 if robot is None else robot.camera_fovy)

    return PolicyRecord(
        inputs=tuple(tensor(n, shape, dtype, about(n)) for n, (shape, dtype) in step.inputs.items()),
        outputs=tuple(tensor(n, shape, np.float32, about(n)) for n, shape in step.outputs.items()),
        rate_hz=round(1.0 / config["ctrl_dt"], 6),
        environment=spec.environment,
        env_config=config,
        steps=spec.steps,
        versions=spec.versions,
        largest_difference=difference,
        observations=OBSERVATIONS,
        robot=robot,
    )


_ACTIONS = {
    "waypoint": ("m", "waypoint (ahead, left) in the body frame, to be reached and faced within one horizon"),
    "velocity": ("1", "a0 to speed (a0 + 1) / 2 · max_speed, a1 to yaw rate a1 · max_yaw_rate"),
    "joint": ("1", "one per actuator: -1 and 1 are the ends of its range"),
}


def _about(name: str, config: dict[str, Any], fovy: float) -> tuple[str, str, str]:
    """Unit, meaning and normalisation of an input or output."""
    if name == "action":
        unit, meaning = _ACTIONS.get(config.get("action_mode", "joint"), _ACTIONS["joint"])
        return unit, meaning, "none: in [-1, 1] already"
    if name == "goal":
        limit = config.get("goal_observation_limit", 0.0)
        meaning = "final goal" if config.get("goal_mode", "final") == "final" else "next waypoint of the route"
        meaning += " (ahead, left) in the robot's heading frame"
        return "m", meaning, f"shortened to at most {limit:g} m" if limit > 0 else "none: the network scales it"
    camera = f"front camera with a vertical field of view of {fovy:.3f} rad"
    known = {
        PIXELS: ("sRGB, 0 to 255", f"{camera}, first row at the top", "none: the network scales it"),
        "proprio": ("m/s, m/s, rad/s, 1, 1", "speed ahead, speed to the left, yaw rate, last action", "none"),
        "robot": (
            "1",
            "size and dynamics of the robot, the same at every step",
            "that of urbanverse_mjx.robots.embodiment",
        ),
        MEMORY: ("1", f"zeros when an episode begins, then {NEXT}{MEMORY} of the step before", "none"),
        NEXT + MEMORY: ("1", f"{MEMORY} of the next step", "none"),
    }
    return known.get(name, ("see the environment", f"observation {name!r} of the environment", "none"))


def _robot_of(config: dict[str, Any], sees: bool) -> RobotRecord | None:
    """The robot of a navigation task; None for other tasks, which have no body velocity."""
    import mujoco

    from ..envs.robot import make_robot

    if "action_mode" not in config:
        return None
    robot = make_robot(ConfigDict(config))
    fovy = np.radians(float(mujoco.MjModel.from_xml_string(robot.mjcf).camera(robot.camera).fovy[0])) if sees else 0.0
    return RobotRecord(robot.name, robot.max_speed, robot.max_yaw_rate, round(float(fovy), 6))


def _note(model: Any, record: PolicyRecord) -> None:
    """Writes the record to the model's metadata."""
    entry = model.metadata_props.add()
    entry.key, entry.value = METADATA_KEY, record.to_json()
    model.doc_string = "A policy of urbanverse_mjx; its metadata say how it is driven."
