"""Policy folders: parameters of a trained policy (orbax, through Brax) and their description `policy.json`."""

import dataclasses
import functools
import pathlib
import sys
from collections.abc import Callable
from importlib import metadata
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from ml_collections import ConfigDict

from ..datatypes import PlacedBank, ValidationError
from ..datatypes import validation as v
from ..envs.staged import observed_size
from ..work_folder import work_folder
from . import policy_files
from .policy_files import FILE
from .policy_packing import pack_arrays

SCHEMA = "urbanverse.policy/1"
HINT = "take another checkpoint of the run, or copy it again from where it is whole"
#: Limits far above the size of any observation or action.
_MAX_AXES, _MAX_SIDE = 4, 100_000
PolicyFunction = Callable[[Any, jax.Array], jax.Array]


@dataclasses.dataclass(frozen=True)
class PolicySpec:
    """The description of a policy that is needed to use its parameters.

    Attributes:
      environment, env_config: name and full config of the environment it was trained in.
      ppo_config: full training config, networks included.
      observations: name -> shape.
      action_size: number of components of an action.
      scene_ids, bank_hashes: of its training.
      steps: env-steps of training.
      versions: packages.
    """

    environment: str
    env_config: dict[str, Any]
    ppo_config: dict[str, Any]
    observations: dict[str, list[int]]
    action_size: int
    scene_ids: list[str]
    bank_hashes: dict[str, Any]
    steps: int
    versions: dict[str, str]

    @staticmethod
    def of(environment: str, env: Any, ppo_config: ConfigDict, steps: int) -> "PolicySpec":
        ids = trained_scenes(env)
        return PolicySpec(
            environment=environment,
            env_config=env.config.to_dict(),
            ppo_config=ppo_config.to_dict(),
            observations={k: list(s) for k, s in observed_size(env).items()},
            action_size=env.action_size,
            scene_ids=ids,
            bank_hashes=dict(env.bank.meta.get("hashes", {})),
            steps=steps,
            versions=package_versions(),
        )

    def save(self, folder: pathlib.Path) -> None:
        """Writes `policy.json` with checksums of itself and of the folder's files, which are flushed to disk before
        it."""
        v.write_json(folder / FILE, policy_files.sealed({"schema": SCHEMA, **dataclasses.asdict(self)}, folder))

    @staticmethod
    def load(folder: pathlib.Path) -> "PolicySpec":
        """Reads `policy.json`.

        Raises:
          ValidationError: the file does not exist, or a field is missing or of another type.
        """
        body = v.read_json(folder / FILE, "policy")
        fields = [f.name for f in dataclasses.fields(PolicySpec)]
        m = dict(v.mapping(body, "policy", ["schema", *fields], policy_files.SEAL))
        v.choice(m.pop("schema"), "policy.schema", (SCHEMA,))
        where = str(folder / FILE)
        v.text(m["environment"], f"{where}: environment")
        for name in ("env_config", "ppo_config", "bank_hashes", "versions", "observations"):
            if not isinstance(m[name], dict):
                raise v.fail(f"{where}: {name}", v.show(m[name]), "an object with named fields", HINT)
        for name, shape in m["observations"].items():
            for size in v.items(shape, f"{where}: observations.{name}", 0, _MAX_AXES):
                v.integer(size, f"{where}: observations.{name}", 1, _MAX_SIDE)
        v.integer(m["action_size"], f"{where}: action_size", 1, _MAX_SIDE)
        v.integer(m["steps"], f"{where}: steps", 0)
        for name in v.items(m["scene_ids"], f"{where}: scene_ids"):
            v.text(name, f"{where}: scene_ids")
        return PolicySpec(**{name: m[name] for name in fields})


def trained_scenes(env: Any) -> list[str]:
    """Ids of the scenes of an environment, also of those that come and go."""
    if isinstance(env.bank, PlacedBank):
        return list(env.bank.all_ids)
    return [env.bank.scene_ids[i] for i in env.scenes]


def package_versions() -> dict[str, str]:
    """Versions of the packages that affect a policy's actions."""
    packages = ("urbanverse_mjx", "mujoco", "mujoco-mjx", "mujoco-warp", "mujoco-warp-pbr", "jax", "brax")
    return {p: _version(p) for p in packages}


def _version(package: str) -> str:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return "not installed"


def policy_path(checkpoints: pathlib.Path, steps: int) -> pathlib.Path:
    """The folder of the policy after `steps` env-steps."""
    return checkpoints / f"{steps:012d}"


def save_policy(folder: pathlib.Path, params: Any, spec: PolicySpec, pack: bool = False) -> pathlib.Path:
    """Writes a policy folder named by its steps under `folder` and returns it. `policy.json` is written last.

    pack: takes longer to write, for a tenth fewer bytes.
    """
    import flax.serialization
    import orbax.checkpoint as ocp

    path = policy_path(folder, spec.steps)
    # In a training over several hosts, only the first process writes; by default Orbax would wait for the others.
    me = jax.process_index()
    alone = ocp.options.MultiprocessingOptions(me, {me}, "policy" if jax.process_count() > 1 else None)
    writer = ocp.Checkpointer(ocp.PyTreeCheckpointHandler(multiprocessing_options=alone), multiprocessing_options=alone)
    # The format that `brax.training.checkpoint.load` reads; the normaliser is stored as a plain structure.
    normaliser, *rest = params
    plain = (flax.serialization.to_state_dict(normaliser), *rest)
    writer.save(path, jax.tree.map(np.asarray, plain), force=True)
    # Orbax's completion marker contains the folder's path on this machine and is not needed, because `policy.json` is
    # written last.
    (path / "commit_success.txt").unlink(missing_ok=True)
    if pack:
        pack_arrays(path)
    spec.save(path)
    return path


def save_student(folder: pathlib.Path, params: Any, spec: PolicySpec) -> pathlib.Path:
    """Writes a student's policy folder under `folder`, in half precision; returns it."""
    half = jax.tree.map(lambda x: np.asarray(x, np.float16), params)
    return save_policy(folder, (_no_normaliser(), half, {}), spec)


def save_actor_and_critic(folder: pathlib.Path, params: Any, spec: PolicySpec) -> pathlib.Path:
    """Writes the policy folder of {"actor", "critic"} under `folder`; returns it."""
    return save_policy(folder, (_no_normaliser(), params["actor"], params["critic"]), spec)


def _no_normaliser() -> Any:
    """Brax expects a normaliser in every checkpoint; this one is not used."""
    from brax.training.acme import running_statistics, specs

    return running_statistics.init_state(specs.Array((1,), jnp.dtype("float32")))


def export_actor(source: pathlib.Path, out: pathlib.Path) -> pathlib.Path:
    """Writes the newest policy under `source` without its critic to the folder `out`; the result has half the size and
    cannot be trained further.

    Raises:
      ValidationError: there is no policy, or `out` is not empty.
    """
    folder = latest_policy(source)
    if out.exists() and any(out.iterdir()):
        raise ValidationError(f"export-policy: found files in {out}, needed a new or empty folder.")
    normaliser, actor, _ = load_params(folder)
    out.absolute().parent.mkdir(parents=True, exist_ok=True)
    with work_folder(".policy-", out.absolute().parent) as work:
        save_policy(work, (normaliser, actor, {}), PolicySpec.load(folder), pack=True).replace(out)
    return out


def load_params(folder: pathlib.Path) -> Any:
    """(normaliser, policy, value) parameters of a policy folder.

    Raises:
      ValidationError: there is no policy, or its parameters cannot be read.
    """
    from brax.training import checkpoint

    if not (folder / FILE).is_file():
        raise ValidationError(f"policy: found no {FILE} in {folder}, needed a policy folder; see `urbanverse train`.")
    try:
        # Orbax does not accept relative paths.
        return checkpoint.load(folder.absolute())
    except Exception as error:
        # Orbax and its storage raise many types of errors for truncated files.
        reason = v.show(" ".join(str(error).split()), 100)
        raise v.fail(str(folder), f"parameters that cannot be read ({reason})", "a whole policy", HINT) from error


def latest_policy(folder: pathlib.Path) -> pathlib.Path:
    """The complete, undamaged policy folder with the most steps under `folder` (or `folder` itself).

    Damaged ones are skipped with a line on standard error; if `folder` itself is a damaged policy, this is an error.

    Raises:
      ValidationError: there is none.
    """
    if (folder / FILE).is_file():
        policy_files.check(folder / FILE)
        return folder
    found = sorted(folder.glob(f"**/{FILE}"), key=lambda p: p.parent.name, reverse=True)
    if not found:
        raise ValidationError(f"policy: found none under {folder}, needed a folder with {FILE}; train one first.")
    for path in found:
        try:
            policy_files.check(path)
        except ValidationError as error:
            sys.stderr.write(f"{str(error).rstrip('.')}; passing over this policy, taking the one before it\n")
        else:
            return path.parent
    raise v.fail(str(folder), f"{len(found)} policies, all of them damaged", "a whole one", HINT)


def network_factory(ppo_config: ConfigDict) -> Callable[..., Any]:
    """The network factory of a training config, used for `ppo.train` and for loading."""
    network = ppo_config.network
    if "map_layers" in network:
        from .map_networks import make_map_networks

        layers = [(int(depth), int(kernel), int(stride)) for depth, kernel, stride in network.map_layers]
        hidden = tuple(int(n) for n in network.hidden)
        told = bool(network.get("told", False))  # absent from configurations of older policies
        return functools.partial(make_map_networks, map_layers=layers, hidden=hidden, told=told)
    if "actor_hidden" in network:
        from .mlp_networks import make_mlp_networks

        hidden = {name: tuple(int(n) for n in network[name]) for name in ("actor_hidden", "critic_hidden")}
        return functools.partial(make_mlp_networks, **hidden)
    from .networks import make_networks

    layers = [(int(depth), int(kernel), int(stride)) for depth, kernel, stride in network.layers]
    return functools.partial(
        make_networks,
        layers=layers,
        critic_sees=network.critic_sees,
        bfloat16=network.bfloat16,
        # Configurations of older policies do not have this field.
        convolution=network.get("convolution", "auto"),
    )


def make_policy_function(
    observations: dict[str, Any], action_size: int, ppo_config: ConfigDict, params: Any, deterministic: bool = True
) -> PolicyFunction:
    """Makes a function (observation, key) -> action for one env or a batch."""
    from brax.training.agents.ppo import networks as ppo_networks

    nets = network_factory(ppo_config)({k: tuple(s) for k, s in observations.items()}, action_size)
    act = ppo_networks.make_inference_fn(nets)((None, *params[1:]), deterministic=deterministic)
    return lambda obs, key: act(obs, key)[0]


def parametric_policy(spec: PolicySpec) -> Callable[[Any, Any, jax.Array], jax.Array]:
    """Makes a function (parameters, observations, key) -> deterministic actions for the networks of `spec` (for the
    parameters see `load_params`)."""
    from brax.training.agents.ppo import networks as ppo_networks

    sizes = {name: tuple(shape) for name, shape in spec.observations.items()}
    make = ppo_networks.make_inference_fn(network_factory(ConfigDict(spec.ppo_config))(sizes, spec.action_size))
    return lambda params, obs, key: make((None, *params[1:]), deterministic=True)(obs, key)[0]


def initial_params(observations: dict[str, Any], action_size: int, ppo_config: ConfigDict, seed: int) -> Any:
    """Randomly initialised parameters."""
    nets = network_factory(ppo_config)({k: tuple(s) for k, s in observations.items()}, action_size)
    key_policy, key_value = jax.random.split(jax.random.PRNGKey(seed))
    return None, nets.policy_network.init(key_policy), nets.value_network.init(key_value)


def load_compatible(folder: pathlib.Path, env: Any, ppo_config: ConfigDict) -> Any:
    """The newest parameters under `folder` that fit the networks of a training in `env`; {} for the critic of a policy
    without one.

    Raises:
      ValidationError: there is no policy, or its networks have other shapes.
    """
    path = latest_policy(folder)
    found = load_params(path)
    observations = observed_size(env)
    needed = jax.eval_shape(lambda: initial_params(observations, env.action_size, ppo_config, 0))
    for part, mine, theirs in (("actor", needed[1], found[1]), ("critic", needed[2], found[2])):
        if (part == "actor" or theirs) and jax.tree.map(jnp.shape, mine) != jax.tree.map(jnp.shape, theirs):
            raise ValidationError(
                f"--start-from: found {part} layers of other shapes in {path}, needed those that this preset makes; "
                "take the preset, image size and networks that the policy was trained with."
            )
    return found


def load_student(folder: pathlib.Path) -> Any:
    """Parameters of the actor of a policy folder. They are stored in half precision; computation is in single
    precision."""
    return jax.tree.map(lambda x: jnp.asarray(x, jnp.float32), load_params(folder)[1])


def load_compatible_student(folder: pathlib.Path, env: Any, config: ConfigDict) -> Any:
    """Parameters of the newest student under `folder` that fit the network of `config` in `env`.

    Raises:
      ValidationError: there is no policy, its network has other shapes, or it sees other parts of proprioception.
    """
    from .dagger import make_student
    from .student import initial_student

    path = latest_policy(folder)
    found = load_student(path)
    network = make_student(config, env.action_size)
    sizes = observed_size(env)
    needed = jax.eval_shape(lambda: initial_student(network, sizes, 0))
    if jax.tree.map(jnp.shape, found) != jax.tree.map(jnp.shape, needed):
        raise ValidationError(
            f"--start-from: found layers of other shapes in {path}, needed those of this preset's student; take a "
            "policy that was trained with the same preset, image size and networks."
        )
    before = ConfigDict(PolicySpec.load(path).ppo_config).get("network", {})
    for name in ("proprio", "last_action"):
        # Weights of what a student never saw are those that it began with.
        had, wanted = bool(before.get(name, True)), bool(config.network.get(name, True))
        if had != wanted:
            said, asked = (str(x).lower() for x in (had, wanted))
            raise ValidationError(
                f"--start-from: found network.{name} {said} in {path}, needed {asked}; pass "
                f"--ppo-overrides '{{\"network.{name}\": {said}}}'."
            )
    return found


def untrained_policy(spec: PolicySpec) -> Any:
    """The policy of `spec` with random parameters from the seed of its config."""
    config = ConfigDict(spec.ppo_config)
    if config.get("algorithm") == "dagger":
        from .dagger import make_student
        from .student import StudentPolicy, initial_student

        network = make_student(config, spec.action_size)
        return StudentPolicy(network, initial_student(network, spec.observations, config.seed))
    start = initial_params(spec.observations, spec.action_size, config, config.seed)
    return make_policy_function(spec.observations, spec.action_size, config, start)


def load_policy(folder: pathlib.Path, deterministic: bool = True) -> tuple[Any, PolicySpec]:
    """Loads a trained policy, a function (observation, key) -> action or a `StudentPolicy` with memory, and its
    description.

    Args:
      folder: a policy folder, or a folder of several (the one with the most steps is loaded).
    """
    folder = latest_policy(folder)
    spec = PolicySpec.load(folder)
    config = ConfigDict(spec.ppo_config)
    if config.get("algorithm") == "dagger":
        from .dagger import make_student
        from .student import StudentPolicy

        return StudentPolicy(make_student(config, spec.action_size), load_student(folder)), spec
    function = make_policy_function(spec.observations, spec.action_size, config, load_params(folder), deterministic)
    return function, spec
