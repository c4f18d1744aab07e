"""`Batch`: functions behind the Gymnasium interface, compiled once for all instances of an environment."""

import dataclasses
import functools
import pathlib
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import gymnasium
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Key

from .. import settings, table_arguments
from ..datatypes import SceneBank, ValidationError
from ..envs import Result, StagedBase, registry

type Obs = dict[str, jax.Array]


class Transition[C](NamedTuple):
    """One step of n envs.

    Attributes:
      carried: states after the step, or of the next episode where one began.
      obs: dict of (n, ...) observations of `carried`.
      reward: (n,) f32.
      terminated, truncated: (n,) bool.
      info: info of `carried`.
      final_info: info of the step itself, dicts of (n,).
      final_obs: observations before new episodes began; None if not requested.
    """

    carried: C
    obs: Obs
    reward: Float[Array, " n"]
    terminated: Bool[Array, " n"]
    truncated: Bool[Array, " n"]
    info: dict[str, jax.Array]
    final_info: dict[str, jax.Array]
    final_obs: Obs | None = None


class Batch[C]:
    """An environment's functions, batched over a leading axis of n envs.

    Args:
      env: an environment of `envs.registry`.
      observations: names of the policy's observations; None: all of the task's, except names that begin with
        "privileged".

    Raises:
      ValidationError: the environment has no observation of this name.
    """

    def __init__(self, env: StagedBase[C], observations: Sequence[str] | None = None) -> None:
        self.env = env
        shapes = jax.eval_shape(env.reset, jax.random.key(0)).obs
        own = set(jax.eval_shape(lambda key: env.observe(env.begin(key)), jax.random.key(0)))
        chosen = sorted(n for n in own if not n.startswith("privileged")) if observations is None else observations
        for name in chosen:
            if name not in shapes:
                raise ValidationError(f"observations: found {name!r}, needed some of {', '.join(sorted(shapes))}.")
        self._named = not own.issuperset(chosen)
        self._names = tuple(chosen)
        self.observation_space = gymnasium.spaces.Dict({name: _space(shapes[name]) for name in chosen})
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (env.action_size,), np.float32)
        self.begin = table_arguments.jit(self._begin)
        self.merge = jax.jit(self._merge)
        self.step = table_arguments.jit(self._step)
        self.step_or_begin = table_arguments.jit(self._step_or_begin)
        self._to_next, self._to_next_with_last = (
            table_arguments.jit(functools.partial(self._step_and_begin, final_obs)) for final_obs in (False, True)
        )

    def _observe(self, carried: C) -> Obs:
        def one(carried: C) -> Obs:
            obs = self.env.observe(carried)
            if self._named:
                obs = {**obs, **self.env.named_observations(carried, obs)}
            return {name: obs[name] for name in self._names}

        return jax.vmap(one)(carried)

    def _info(self, carried: C, metrics: dict[str, jax.Array]) -> dict[str, jax.Array]:
        values = jax.vmap(self.env.info_of)(carried)
        # Gymnasium's wrappers reserve the key "episode".
        values["row"] = values["episode"]
        return {name: values[name] for name in ("scene", "row", "result", "steps")} | metrics

    def _fresh_info(self, carried: C, number: int) -> dict[str, jax.Array]:
        zeros = {name: jnp.zeros(number, x.dtype) for name, x in self.env.zero_metrics().items()}
        return self._info(carried, zeros)

    def _begin(self, keys: Key[Array, " n"]) -> tuple[C, Obs, dict[str, jax.Array]]:
        """Returns the first states of new episodes with observations and info."""
        carried = jax.vmap(self.env.begin)(keys)
        return carried, self._observe(carried), self._fresh_info(carried, len(keys))

    def _merge(self, mask: Bool[Array, " n"], new: Any, old: Any) -> Any:
        """Returns `new` where the mask is set, else `old`."""
        return jax.tree.map(functools.partial(_where, mask), new, old)

    def _advance(
        self, carried: C, action: Float[Array, "n nu"]
    ) -> tuple[C, jax.Array, jax.Array, jax.Array, dict[str, jax.Array]]:
        carried, reward, done, metrics = jax.vmap(self.env.advance)(carried, action)
        info = self._info(carried, metrics)
        truncated = (done > 0) & (info["result"] == Result.TIMEOUT)
        return carried, reward, (done > 0) & ~truncated, truncated, info

    def _step(self, carried: C, action: Float[Array, "n nu"]) -> Transition[C]:
        """Steps all envs without beginning new episodes."""
        carried, reward, terminated, truncated, info = self._advance(carried, action)
        return Transition(carried, self._observe(carried), reward, terminated, truncated, info, info)

    def _step_or_begin(self, carried: C, over: Bool[Array, " n"], action: Float[Array, "n nu"]) -> Transition[C]:
        """Steps the envs whose episode continues; the others begin the next episode, with zero reward and no
        termination."""
        stepped, reward, terminated, truncated, info = self._advance(carried, action)
        begun = jax.vmap(self.env.reset_episode)(carried)
        begun_info = self._fresh_info(begun, len(over))
        after, info = self._merge(over, (begun, begun_info), (stepped, info))
        reward = jnp.where(over, 0.0, reward)
        return Transition(after, self._observe(after), reward, terminated & ~over, truncated & ~over, info, info)

    def step_and_begin(self, carried: C, action: Float[Array, "n nu"], final_obs: bool) -> Transition[C]:
        """Steps all envs; those whose episode ends begin the next one immediately."""
        return (self._to_next_with_last if final_obs else self._to_next)(carried, action)

    def _step_and_begin(self, final_obs: bool, carried: C, action: Float[Array, "n nu"]) -> Transition[C]:
        stepped, reward, terminated, truncated, final_info = self._advance(carried, action)
        over = terminated | truncated
        begun = jax.vmap(self.env.reset_episode)(stepped)
        begun_info = self._fresh_info(begun, len(over))
        after, info = self._merge(over, (begun, begun_info), (stepped, final_info))
        obs = self._observe(after)
        # Rendering dominates the cost, so images are rendered twice only if an episode ended.
        last = jax.lax.cond(over.any(), lambda: self._observe(stepped), lambda: obs) if final_obs else None
        return Transition(after, obs, reward, terminated, truncated, info, final_info, last)


def _where(mask: jax.Array, new: jax.Array, old: jax.Array) -> jax.Array:
    return jnp.where(mask.reshape(-1, *[1] * (new.ndim - 1)), new, old)


def _space(x: jax.ShapeDtypeStruct) -> gymnasium.spaces.Box:
    if x.dtype == jnp.uint8:
        return gymnasium.spaces.Box(0, 255, x.shape, np.uint8)
    return gymnasium.spaces.Box(-np.inf, np.inf, x.shape, np.float32)


def keys_of(seeds: Sequence[int]) -> Key[Array, " n"]:
    """Returns a key for each seed; a seed gives the same episodes alone and in any batch."""
    return jax.vmap(jax.random.key)(jnp.asarray(np.asarray(seeds, np.uint64) & 0xFFFFFFFF, jnp.uint32))


@dataclasses.dataclass(frozen=True)
class _Overrides:
    """Config overrides as a cache key; equal if their text is equal."""

    spelled: str
    values: Mapping[str, Any] = dataclasses.field(compare=False)


@functools.lru_cache(maxsize=2)
def _cached(
    name: str, overrides: _Overrides, bank: pathlib.Path | None, file: tuple[Any, ...], chosen: tuple[str, ...] | None
) -> Batch[Any]:
    del file  # part of the key: another file under the same name, or another default
    scenes = None if bank is None else SceneBank.load(bank)
    return Batch(_load(name, overrides.values, scenes), chosen)


def _load(name: str, overrides: Mapping[str, Any], bank: SceneBank | None) -> StagedBase[Any]:
    env = registry.load(name, config_overrides=overrides, bank=bank)
    if not isinstance(env, StagedBase):
        raise ValidationError(f"environment {name!r}: found a {type(env).__name__}, needed a subclass of StagedBase.")
    return env


def load_batch(
    name: str,
    preset: str | None,
    overrides: Mapping[str, Any] | None,
    bank: SceneBank | str | pathlib.Path | None,
    observations: Sequence[str] | None,
) -> Batch[Any]:
    """Returns the functions of a registered environment; equal arguments share compiled code if the bank is a file."""
    given = dict(overrides or {}) | ({} if preset is None else {"preset": preset})
    chosen = None if observations is None else tuple(observations)
    if isinstance(bank, SceneBank):
        return Batch(_load(name, given, bank), chosen)
    path = settings.default_bank_path() if bank is None else pathlib.Path(bank).expanduser()
    status = path.stat() if path.is_file() else None
    file = (path.absolute(), status and (status.st_mtime_ns, status.st_size))
    spelled = _Overrides(repr(sorted(given.items())), given)
    return _cached(name, spelled, None if bank is None else path, file, chosen)


def with_masks(info: dict[str, Any], mask: np.ndarray) -> dict[str, Any]:
    """Adds Gymnasium's masks to a vector's info: for each entry `x` an entry `_x`, (n,) bool, of the envs that have
    it."""
    return {key: value for name, x in info.items() for key, value in ((name, x), (f"_{name}", mask))}


def seeds_of(seed: int | Sequence[int] | None, number: int, draw: Callable[[], np.random.Generator]) -> list[int]:
    """Returns a seed for each env by Gymnasium's convention: an int is the first of consecutive seeds, None draws
    random ones.

    Raises:
      ValidationError: the list has another length.
    """
    if seed is None:
        return draw().integers(2**32, size=number).tolist()
    if isinstance(seed, int | np.integer):
        return [int(seed) + i for i in range(number)]
    if len(seed) != number:
        raise ValidationError(f"seed: found {len(seed)} seeds, needed an int or one for each of the {number} envs.")
    return [int(s) for s in seed]
