"""Trains the perception model on rendered streets and evaluates it on held-out streets.

    python -m benchmarks.perception_streets --split train --layouts 256 --processes 16 --out perception_train.npz
    python -m benchmarks.perception_streets --split test --layouts 20 --out perception_test.npz
    python -m urbanverse_mjx.distillation.train_perception --train perception_train.npz --test perception_test.npz \\
        --init shipped --minutes 6 --out perception.npz

Frames are rendered during training, each from a random position with a random lens, appearance, condition (night,
rain, a bonnet, ...) and camera fault; none is used twice. `--init` may be weights of a network with fewer blocks. The
learning rate is a function of the elapsed time, so that it ends at zero on any machine. `--within` bounds the wall time
of the whole command but for the final scoring, so that it fits into a lent machine's time. Prints one JSON line per
progress report and a table at the end. Weights are written every minute and at the end; with `--state` also the rest of
the training state: the same command after a killed or a paused (`--pause-after`) run continues it.
"""

import argparse
import concurrent.futures
import dataclasses
import functools
import json
import pathlib
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import optax
from flax import traverse_util
from jax.sharding import Mesh, NamedSharding, PartitionSpec

from .. import settings
from ..datatypes import SceneBank, ValidationError
from ..datatypes.validation import write_atomically
from .perception_model import inference, network, scales, score, weights
from .perception_model.augment import augment, with_faults
from .perception_model.conditions import vary
from .perception_model.decode import Decoded
from .perception_model.network import OUTPUT_STRIDE, Seen
from .perception_model.targets import GroundTruth, loss, without
from .perception_model.views import Views


@dataclasses.dataclass(frozen=True)
class LearningOptions:
    """Training options; chosen manually.

    Attributes:
      warm_up: share of the run in which the learning rate rises; afterwards it follows a cosine.
      weight_decay: weight decay of AdamW.
      average_decay: decay per step of the running average of the weights, which is evaluated and stored.
      mixed_ground: share of the ground with the material of another kind; see `Views.of`.
      heights, fields_of_view: ranges of the training cameras, m and degrees; wider than those of the test.
      aimed_share: share of the cameras that look at an object whose class is drawn first: rare classes are seen.
      save_interval: s, time between two saves of the weights.
      report_interval: s, time between two progress reports.
    """

    warm_up: float = 0.04
    weight_decay: float = 1e-2
    average_decay: float = 0.998
    mixed_ground: float = 0.4
    heights: tuple[float, float] = (0.35, 2.2)
    fields_of_view: tuple[float, float] = (29.0, 78.0)
    aimed_share: float = 0.35
    save_interval: float = 60.0
    report_interval: float = 20.0


_OPTIONS = LearningOptions()
#: Value of `--init` for the weights of the package.
SHIPPED = "shipped"


class Learner(NamedTuple):
    """Network variables, their running average, and the optimiser's state."""

    variables: Any
    average: Any
    moments: Any


@dataclasses.dataclass
class Progress:
    """Progress of a run: number of steps, and the time they took in s."""

    steps: int = 0
    seconds: float = 0.0


def _optimiser() -> optax.GradientTransformation:
    # Flattened to one vector: hundreds of arrays with operations of their own take long to compile.
    return optax.flatten(
        optax.chain(
            optax.clip_by_global_norm(5.0), optax.scale_by_adam(), optax.add_decayed_weights(_OPTIONS.weight_decay)
        )
    )


def begin(key: jax.Array, height: int, width: int) -> Any:
    """Random variables of the network: kernels after LeCun, and residual blocks that are the identity.

    The numbers are drawn here, because compiling the network's own initialisation takes minutes.
    """
    shapes = jax.eval_shape(weights.network().init, key, jnp.zeros((1, height, width, 3)))
    rng = np.random.default_rng(np.asarray(jax.random.key_data(key)))
    flat = network.flat_variables(shapes)
    return traverse_util.unflatten_dict({path: _initial(path, x.shape, rng) for path, x in flat.items()})


def learner_of(variables: Any) -> Learner:
    """A learner that begins with variables of the network, which it holds `network.stacked`."""
    variables = network.stacked(jax.tree.map(jnp.asarray, variables))
    return Learner(variables, jax.tree.map(jnp.copy, variables), _optimiser().init(variables["params"]))


def _initial(path: tuple[str, ...], shape: tuple[int, ...], rng: np.random.Generator) -> jax.Array:
    """Initial values of one array of the network's variables."""
    if path[-1] == "kernel":
        return jnp.asarray(rng.normal(size=shape) / np.sqrt(np.prod(shape[:-1])), jnp.float32)
    last_of_block = path[1].startswith("_Block_") and path[2] == "_Conv_1"
    one = path[-1] == "var" or (path[-1] == "scale" and not last_of_block)
    return jnp.full(shape, 1.0 if one else 0.0)


#: Axis of the devices that a batch is divided over.
_DEVICES = "devices"


class Step:
    """One training step: renders a batch, varies its images, computes the gradient and updates the network.

    These are four programs, not one, because XLA compiles them at the same time and each much faster than their
    union: the graphs are optimised as a whole, in one thread. A batch is divided evenly over `devices`; each normalises
    by the statistics of its part, and the mean gradient updates equal copies of the network.
    """

    def __init__(
        self,
        model: Any,
        views: Views,
        batch: int,
        options: dict[str, Any] | None = None,
        devices: Sequence[Any] | None = None,
    ) -> None:
        """Makes the programs, which are compiled by `compile` or by the first call.

        Args:
          batch: images of a step, a multiple of the number of devices.
          options: of XLA for the program with the convolutions, see `convolution_options`.
          devices: that share the work; default: the first one.
        """
        mesh = Mesh(np.array(list(devices or jax.devices()[:1])), (_DEVICES,))
        part, whole = PartitionSpec(_DEVICES), PartitionSpec()
        shared = functools.partial(jax.shard_map, mesh=mesh, check_vma=False)
        slopes = shared(
            functools.partial(_slopes, model), in_specs=(whole, part, part, part, whole), out_specs=(whole,) * 3
        )
        self._programs: dict[str, Any] = {
            "draw": jax.jit(shared(views, in_specs=part, out_specs=part)),
            "vary": jax.jit(shared(_varied, in_specs=part, out_specs=part)),
            "slopes": jax.jit(slopes, compiler_options=options),
            "update": jax.jit(_updated, donate_argnums=0),
        }
        self._batch, self._part, self._whole = batch, NamedSharding(mesh, part), NamedSharding(mesh, whole)
        # An argument, not a constant: the program is the same for all streets.
        self._balance = None if views.balance is None else jax.device_put(views.balance, self._whole)

    def placed(self, learner: Learner) -> Learner:
        """A copy of the learner on each of the devices."""
        return jax.device_put(learner, self._whole)

    def _keys(self, key: jax.Array) -> tuple[jax.Array, jax.Array]:
        """Keys (batch,) of the views and of the conditions, divided over the devices."""
        view_key, change_key = jax.random.split(key)
        keys = jax.random.split(view_key, self._batch), jax.random.split(change_key, self._batch)
        return jax.device_put(keys[0], self._part), jax.device_put(keys[1], self._part)

    def compile(self, learner: Learner, key: jax.Array, say: Callable[[str, float], None]) -> None:
        """Compiles the programs in as many threads; `say` is called with a program's name and its time in s."""
        view_keys, change_keys = self._keys(key)
        images, wanted, counts = self._shapes(self._part, self._programs["draw"], view_keys)
        inputs, varied = self._shapes(self._part, self._programs["vary"], change_keys, images, wanted)
        of_slopes = (learner.variables, inputs, varied, counts, self._balance)
        slopes, _, statistics = self._shapes(self._whole, self._programs["slopes"], *of_slopes)
        arguments = {
            "draw": (view_keys,),
            "vary": (change_keys, images, wanted),
            "slopes": of_slopes,
            "update": (learner, slopes, statistics, jnp.asarray(0.0)),
        }

        def compiled(name: str) -> Any:
            begin = time.monotonic()
            program = self._programs[name].lower(*arguments[name]).compile()
            say(name, time.monotonic() - begin)
            return program

        with concurrent.futures.ThreadPoolExecutor(len(arguments)) as pool:
            self._programs = dict(zip(arguments, pool.map(compiled, arguments), strict=True))

    @staticmethod
    def _shapes(sharding: NamedSharding, program: Any, *arguments: Any) -> Any:
        """Shapes of a program's results, placed as `sharding` says."""
        return jax.tree.map(
            lambda x: jax.ShapeDtypeStruct(x.shape, x.dtype, sharding=sharding), jax.eval_shape(program, *arguments)
        )

    def __call__(self, learner: Learner, key: jax.Array, rate: jax.Array) -> tuple[Learner, dict[str, jax.Array]]:
        """The learner, `placed`, after a step with the learning rate () `rate`, and the parts of the loss."""
        view_keys, change_keys = self._keys(key)
        images, wanted, counts = self._programs["draw"](view_keys)
        inputs, wanted = self._programs["vary"](change_keys, images, wanted)
        slopes, parts, statistics = self._programs["slopes"](learner.variables, inputs, wanted, counts, self._balance)
        return self._programs["update"](learner, slopes, statistics, rate), parts


def _varied(keys: jax.Array, images: jax.Array, wanted: GroundTruth) -> tuple[jax.Array, GroundTruth]:
    """Images (n, H, W, 3) as floats with random conditions and camera faults, and the targets of what they show."""
    vary_keys, fault_keys = jnp.moveaxis(jax.vmap(jax.random.split)(keys), 1, 0)
    varied, hidden = jax.vmap(vary)(vary_keys, images)
    inputs = jax.vmap(with_faults)(fault_keys, varied)
    return inputs, without(wanted, hidden[:, 1::OUTPUT_STRIDE, 1::OUTPUT_STRIDE])


def _slopes(
    model: Any, variables: Any, inputs: jax.Array, wanted: GroundTruth, counts: jax.Array, balance: jax.Array | None
) -> tuple[Any, dict[str, jax.Array], Any]:
    """Gradient of the loss, its parts, and the updated statistics of the normalisation; means over the devices."""

    def answer(params: Any) -> Any:
        seen, updated = model.apply({**variables, "params": params}, inputs, train=True, mutable=["batch_stats"])
        total, parts = loss(seen, wanted, counts, balance)
        return total, (parts, updated["batch_stats"])

    slopes, (parts, statistics) = jax.grad(answer, has_aux=True)(variables["params"])
    return jax.lax.pmean((slopes, parts, statistics), _DEVICES)


def _updated(learner: Learner, slopes: Any, statistics: Any, rate: jax.Array) -> Learner:
    updates, moments = _optimiser().update(slopes, learner.moments, learner.variables["params"])
    params = jax.tree.map(lambda p, u: p - rate * u, learner.variables["params"], updates)
    variables = {"params": params, "batch_stats": statistics}
    decay = _OPTIONS.average_decay
    average = jax.tree.map(lambda a, b: decay * a + (1 - decay) * b, learner.average, variables)
    return Learner(variables, average, moments)


def rate_at(progress: float, peak: float) -> float:
    """Learning rate after a share `progress` of the run."""
    if progress < _OPTIONS.warm_up:
        return peak * progress / _OPTIONS.warm_up
    fallen = min((progress - _OPTIONS.warm_up) / (1.0 - _OPTIONS.warm_up), 1.0)
    return peak * 0.5 * (1.0 + float(np.cos(np.pi * fallen)))


def convolution_options(autotune: int) -> dict[str, Any] | None:
    """Options of XLA for programs with convolutions: with 0, cuDNN's first suggestion is taken for each.

    Without trials XLA otherwise leaves a convolution's algorithm open and cuDNN's default serves, which can be slow;
    where it has to be deterministic, it takes the first suggested one (XLA's `select_first_config`).
    """
    return {"xla_gpu_autotune_level": 1, "xla_gpu_deterministic_ops": True} if autotune == 0 else None


class Frame(NamedTuple):
    """Prediction and ground truth of one frame: (h, w) classes, owner (-1 = none), depth m (0 = unknown), leaf."""

    seen: Decoded
    kinds: np.ndarray
    owner: np.ndarray
    depth: np.ndarray
    leaf: np.ndarray


def make_predict(
    model: Any, views: Views, options: dict[str, Any] | None = None
) -> Callable[[Any, int, int, int], Iterator[Frame]]:
    """A function of (variables, frames, batch, seed) that yields what is found in seeded frames with the same camera
    faults as the images of training, without hard conditions; frames without objects are left out.

    Args:
      options: of XLA for the network.
    """
    outputs = make_outputs(model, views, options)

    def frames_of(variables: Any, frames: int, batch: int, seed: int) -> Iterator[Frame]:
        for fine, coarse, wanted in outputs(variables, frames, batch, seed):
            # Depths are compared in the canonical camera, which does not depend on the lens.
            yield frame_of(scales.decoded(fine, coarse, network.CANONICAL_FOCAL), wanted)

    return frames_of


def make_outputs(
    model: Any, views: Views, options: dict[str, Any] | None = None
) -> Callable[[Any, int, int, int], Iterator[tuple[Seen, Seen, GroundTruth]]]:
    """A function of (variables, frames, batch, seed) that yields the outputs for seeded frames at both of `scales` and
    their targets, as NumPy arrays of one frame."""
    apply = jax.jit(functools.partial(model.apply, train=False), compiler_options=options)
    draw = jax.jit(lambda keys: views(keys, dye=False))
    fault = jax.jit(jax.vmap(augment))

    def outputs_of(variables: Any, frames: int, batch: int, seed: int) -> Iterator[tuple[Seen, Seen, GroundTruth]]:
        for start in range(0, frames, batch):
            keys = jax.random.split(jax.random.fold_in(jax.random.key(seed), start), batch)
            images, wanted, counts = draw(keys)
            seen = scales.outputs(functools.partial(apply, variables), fault(keys, images))
            for i in range(batch):
                if counts[i]:
                    yield jax.tree.map(lambda x, i=i: np.asarray(x[i]), (*seen, wanted))

    return outputs_of


def frame_of(decoded: Decoded, wanted: GroundTruth) -> Frame:
    """What was decoded in a frame, and its targets."""
    depth = network.DEPTH_UNIT * np.exp(np.asarray(wanted.log_depth)) * np.asarray(wanted.has_depth)
    kinds, owner, leaf = (np.asarray(x) for x in (wanted.classes, wanted.owner, wanted.leaf))
    return Frame(decoded, kinds, owner, depth, leaf)


def evaluate(frames: Iterable[Frame], cut: float = 0.0) -> dict[str, Any]:
    """The table of `score.Score` over frames, for detected objects with a score of at least `cut`."""
    result = score.Score()
    for frame in frames:
        result.add(*frame._replace(seen=frame.seen.surer(cut)))
    return result.table()


def sharing(count: int, batch: int) -> list[Any]:
    """At most `count` devices, which share batches.

    Raises:
      ValidationError: they cannot have equal parts of a batch.
    """
    devices = jax.devices()[:count]
    if batch % len(devices):
        raise ValidationError(f"--batch: found {batch}, needed a multiple of {len(devices)}, the number of devices.")
    return devices


def train(arguments: argparse.Namespace) -> dict[str, Any]:
    """Trains the network, writes the weights, and returns the table of the test streets."""
    started = time.monotonic()
    devices = sharing(arguments.devices, arguments.batch)
    size = arguments.height, arguments.width
    views = Views.of(
        SceneBank.load(arguments.train),
        *size,
        mixed=_OPTIONS.mixed_ground,
        samples=arguments.samples,
        heights=_OPTIONS.heights,
        fields_of_view=_OPTIONS.fields_of_view,
        aimed_share=_OPTIONS.aimed_share,
    )
    test = Views.of(SceneBank.load(arguments.test), *size, appearance=0.0, samples=arguments.samples)
    key = jax.random.key(arguments.seed)
    record = {"train": _hash(views), "test": _hash(test), "seed": arguments.seed, "batch": arguments.batch}
    if arguments.init is None:
        variables = begin(jax.random.fold_in(key, 0), arguments.height, arguments.width)
    else:
        variables, given = weights.load(None if arguments.init == SHIPPED else arguments.init)
        if not arguments.keep_size:
            fresh = begin(jax.random.fold_in(key, 0), arguments.height, arguments.width)
            variables = network.grown(variables, fresh)
        record["before"] = {name: x for name, x in given.items() if name != "score"}
    options = convolution_options(arguments.autotune)
    model = weights.network(jnp.dtype(arguments.dtype), network.blocks_of(variables), scanned=True)
    predicted, seeded = make_predict(model, test, options), (arguments.test_batch, arguments.seed + 1)
    learner, progress = learner_of(variables), Progress()
    if arguments.state is not None and arguments.state.is_file():
        learner, progress = _read_state(arguments.state, learner)
    if arguments.minutes > 0:
        step = Step(model, views, arguments.batch, options, devices)
        learner = step.placed(learner)
        _say({"event": "read", "seconds": round(time.monotonic() - started, 1)})

        def validate(average: Any) -> None:
            average = jax.device_put(average, devices[0])
            _validate(list(predicted(average, arguments.validation_frames, *seeded)), progress)

        # The initial weights are scored while the programs of a step compile; validation is then compiled as well.
        with concurrent.futures.ThreadPoolExecutor(1) as pool:
            before = pool.submit(validate, learner.average) if arguments.validate_every > 0 else None
            step.compile(
                learner, key, lambda name, took: _say({"event": "program", "name": name, "seconds": round(took, 1)})
            )
            if before is not None:
                before.result()
        learner, _ = step(learner, jax.random.fold_in(key, 1), jnp.asarray(0.0))
        jax.block_until_ready(learner)
        ready = time.monotonic() - started
        _say({"event": "compiled", "seconds": round(ready, 1)})
        if arguments.within is not None:
            arguments.minutes = min(
                arguments.minutes, progress.seconds / 60.0 + max(arguments.within - ready / 60.0, 0.0)
            )
        learner = _run(step, learner, key, arguments, record, progress, validate)
    record = _keep(arguments, learner, progress, record)
    if progress.seconds < 60.0 * arguments.minutes:
        return {**record, "paused_after_s": round(progress.seconds, 1)}
    # The stored weights are evaluated, not those in memory.
    variables, _ = weights.load(arguments.out)
    table = evaluate(predicted(network.stacked(variables), arguments.test_frames, *seeded), arguments.cut)
    weights.save(arguments.out, variables, {**record, "score": table})
    return {**record, **table}


def _run(
    step: Step,
    learner: Learner,
    key: jax.Array,
    arguments: argparse.Namespace,
    record: dict[str, Any],
    done: Progress,
    validate: Callable[[Any], None],
) -> Learner:
    """Runs steps until the time is over or a pause is due, and updates `done`.

    Validation takes none of the time, unless the wall time is bounded.
    """
    before, begin = done.seconds, time.monotonic()
    said = saved = validated = begin
    length = arguments.minutes * 60.0
    end = length if arguments.pause_after is None else min(length, before + arguments.pause_after * 60.0)
    while done.seconds < end:
        rate = jnp.asarray(rate_at(done.seconds / length, arguments.rate))
        learner, parts = step(learner, jax.random.fold_in(key, 2 + done.steps), rate)
        done.steps += 1
        now = time.monotonic()
        done.seconds = before + now - begin
        if now - said > _OPTIONS.report_interval or done.steps == 1:
            losses = {name: round(float(x), 4) for name, x in parts.items()}
            _say({"event": "step", "steps": done.steps, "seconds": round(done.seconds, 1), **losses})
            said = now
        if now - saved > _OPTIONS.save_interval:
            _keep(arguments, learner, done, record)
            saved = now
        if arguments.validate_every > 0 and now - validated > 60.0 * arguments.validate_every:
            jax.block_until_ready(learner)
            stopped = time.monotonic()
            validate(learner.average)
            validated = time.monotonic()
            if arguments.within is None:
                begin, said, saved = (x + validated - stopped for x in (begin, said, saved))
        if done.steps % 8 == 0:  # a bounded queue: the clock then measures work that is done
            jax.block_until_ready(parts)
    return learner


def _validate(frames: Sequence[Frame], done: Progress) -> None:
    """Prints the tables of frames of the test streets, of all detected objects and of the likely ones."""
    tables = {"raw": evaluate(frames), "likely": evaluate(frames, inference.MIN_SCORE)}
    _say({"event": "validation", "steps": done.steps, "seconds": round(done.seconds, 1), **tables})


def _keep(arguments: argparse.Namespace, learner: Learner, done: Progress, record: dict[str, Any]) -> dict[str, Any]:
    """Writes the weights and, if requested, the state; returns the written record."""
    record = {**record, "steps": done.steps, "frames": done.steps * arguments.batch, "minutes": arguments.minutes}
    weights.save(arguments.out, network.unstacked(learner.average), record)
    if arguments.state is not None:
        arrays = {str(i): np.asarray(x) for i, x in enumerate(jax.tree.leaves(learner))}
        arrays["progress"] = np.array([done.steps, done.seconds])
        write_atomically(arguments.state, lambda temporary: np.savez(temporary, allow_pickle=False, **arrays))
    return record


def _read_state(path: pathlib.Path, like: Learner) -> tuple[Learner, Progress]:
    """Reads the state that `_keep` writes.

    Raises:
      ValidationError: the file belongs to another network or is not a state file.
    """
    leaves, tree = jax.tree.flatten(like)
    try:
        with np.load(path, allow_pickle=False) as file:
            found = [file[str(i)] for i in range(len(leaves))]
            steps, seconds = file["progress"]
    except (OSError, ValueError, KeyError) as error:
        raise ValidationError(
            f"{path}: found no state of this training ({error}), needed one; remove the file."
        ) from error
    if [x.shape for x in found] != [x.shape for x in leaves]:
        raise ValidationError(f"{path}: found the state of another network, needed this one's; remove the file.")
    learner = jax.tree.unflatten(tree, [jnp.asarray(x) for x in found])
    return learner, Progress(int(steps), float(seconds))


def _hash(views: Views) -> str:
    return str(views.renderer.bank.meta["hashes"].get("bank", ""))


def _say(row: dict[str, Any]) -> None:
    sys.stdout.write(json.dumps(row) + "\n")
    sys.stdout.flush()


def parse(argv: list[str] | None) -> argparse.Namespace:
    height, width = network.SIZE
    parser = argparse.ArgumentParser(prog="python -m urbanverse_mjx.distillation.train_perception", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--train", type=pathlib.Path, required=True, help="bank of streets to learn on")
    parser.add_argument("--test", type=pathlib.Path, required=True, help="bank of streets to score on")
    parser.add_argument("--out", type=pathlib.Path, required=True, help="weights to write")
    init = f"initial weights, '{SHIPPED}' for those of the package; default: random ones"
    parser.add_argument("--init", help=init)
    parser.add_argument("--minutes", type=float, default=16.0, help="of training in all; 0 only scores --init")
    within = "wall time of the whole command but for the final scoring, compiling and validation included"
    parser.add_argument("--within", type=float, metavar="MINUTES", help=within)
    parser.add_argument("--state", type=pathlib.Path, help="file with the state of the run, from which it continues")
    parser.add_argument("--pause-after", type=float, metavar="MINUTES", help="stop after so many and keep --state")
    every = "print the score of --validation-frames frames after so many minutes of training; 0: never"
    parser.add_argument("--validate-every", type=float, default=0.0, metavar="MINUTES", help=every)
    parser.add_argument("--validation-frames", type=int, default=64)
    same = "keep the number of residual blocks of --init (a file of the same size); default: today's network"
    parser.add_argument("--keep-size", action="store_true", help=same)
    tuned = (
        "0: XLA takes cuDNN's first suggestion for each convolution; 1 to 4: measures several, which takes long (GPU)"
    )
    parser.add_argument("--autotune", type=int, choices=range(5), default=0, help=tuned)
    parser.add_argument("--batch", type=int, default=32)
    several = "GPUs that share each batch, at most those of the machine"
    parser.add_argument("--devices", type=int, default=1, help=several)
    parser.add_argument("--rate", type=float, default=2e-3, help="peak learning rate")
    parser.add_argument("--height", type=int, default=height, help="pixels, a multiple of 64")
    parser.add_argument("--width", type=int, default=width)
    parser.add_argument("--samples", type=int, default=2, help="rays per pixel and side of the images")
    parser.add_argument("--dtype", choices=("bfloat16", "float32"), default="bfloat16", help="of the arithmetic")
    parser.add_argument("--test-frames", type=int, default=512)
    parser.add_argument("--test-batch", type=int, default=32)
    cut = f"score only objects this likely right; `PerceptionModel` takes {inference.MIN_SCORE}"
    parser.add_argument("--cut", type=float, default=0.0, help=cut)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args(argv)
    if arguments.devices < 1:
        parser.error("--devices must be at least 1")
    if arguments.height % (2 * network.STRIDE) or arguments.width % (2 * network.STRIDE) or arguments.minutes < 0:
        parser.error(f"--height and --width must be multiples of {2 * network.STRIDE}, --minutes 0 or more")
    if arguments.pause_after is not None and arguments.state is None:
        parser.error("--pause-after needs --state, or what was learnt is lost")
    if arguments.keep_size and arguments.init is None:
        parser.error("--keep-size needs --init, whose size it keeps")
    return arguments


def main(argv: list[str] | None = None) -> int:
    arguments = parse(argv)
    # Trying out algorithms for each of the convolutions takes minutes, longer beside other jobs.
    settings.set_xla_flags({"xla_gpu_autotune_level": str(arguments.autotune), "xla_gpu_enable_triton_gemm": "false"})
    jax.config.update("jax_compilation_cache_dir", str(settings.use_compilation_cache()))
    try:
        table = train(arguments)
    except ValidationError as error:
        sys.stderr.write(f"error: {error}\n")
        return 2
    if "paused_after_s" in table:
        _say({"event": "paused", **table})
        return 0
    _say({"event": "done", **table})
    sys.stdout.write(score.as_markdown(table) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
