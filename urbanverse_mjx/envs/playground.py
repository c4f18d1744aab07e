"""Model properties and domain randomiser in the interface of MuJoCo Playground.

The engines of this package run the physics. They use only the friction and the mass of a randomised model, as factors.
"""

import contextlib
import functools
import hashlib
from typing import TYPE_CHECKING, Any

import jax
import jax.numpy as jnp
import mujoco
from jax import core
from jaxtyping import Array, Key, Shaped

from .. import settings
from ..datatypes import RobotSpec, SimState, ValidationError
from ..datatypes.validation import write_atomically

if TYPE_CHECKING:
    from mujoco import mjx

#: Factors that `domain_randomize` draws, uniform: the ranges of the navigation task's preset `paper`.
FRICTION, MASS = (0.7, 1.3), (0.8, 1.25)
_TAKEN = ("geom_friction", "body_mass", "body_inertia", "body_subtreemass")


@functools.cache
def register_with_playground(cls: type) -> None:
    """Registers a class as virtual subclass of `mujoco_playground.MjxEnv` if Playground is installed."""
    with contextlib.suppress(ImportError):
        from mujoco_playground import MjxEnv

        MjxEnv.register(cls)


class ModelNames:
    """The robot's model under the names of Playground and Brax, without a scene, because each env has its own."""

    robot: RobotSpec
    _first_model: "mjx.Model | None" = None
    # Playground's and Brax's wrappers store a batch of randomised models here while they reset and step.
    _mjx_model: "mjx.Model | None" = None

    @property
    def mj_model(self) -> mujoco.MjModel:
        """The robot's model without scene."""
        raise NotImplementedError

    @property
    def mjx_model(self) -> "mjx.Model":
        """`mj_model` for JAX."""
        # MJX initialises Warp, which importing this package must not do.
        from mujoco import mjx

        if self._mjx_model is None:
            with jax.ensure_compile_time_eval():
                self._first_model = self._mjx_model = mjx.put_model(self.mj_model)
        return self._mjx_model

    @property
    def sys(self) -> "mjx.Model":
        """Brax's name of `mjx_model`."""
        return self.mjx_model

    @sys.setter
    def sys(self, model: "mjx.Model") -> None:
        self._mjx_model = model

    @property
    def xml_path(self) -> str:
        """Path of a cached file with the robot's MJCF."""
        digest = hashlib.sha256(self.robot.mjcf.encode()).hexdigest()[:16]
        path = settings.cache_dir("robots", f"{self.robot.name}-{digest}.xml")
        if not path.is_file() or path.read_bytes() != self.robot.mjcf.encode():
            write_atomically(path, lambda temporary: temporary.write_text(self.robot.mjcf, encoding="utf-8"))
        return str(path)

    @property
    def model_assets(self) -> dict[str, bytes]:
        """Files that the MJCF at `xml_path` references: none."""
        return {}

    def with_model(self, sim: SimState) -> SimState:
        """The first state of an episode with the friction and mass of a wrapper's randomised model, if any.

        Raises:
          ValidationError: a wrapper randomises other properties than friction and mass.
        """
        first, model = self._first_model, self._mjx_model
        if first is None or model is None or model is first:
            return sim
        for path, leaf in jax.tree_util.tree_leaves_with_path(model):
            name = str(getattr(path[0], "name", path[0]))
            if isinstance(leaf, core.Tracer) and name not in _TAKEN:
                raise ValidationError(
                    f"randomization_fn: found one that changes {name}, needed one that changes only "
                    f"{', '.join(_TAKEN)}; take registry.get_domain_randomizer."
                )
        friction = model.geom_friction[:, 0].sum() / first.geom_friction[:, 0].sum()
        mass = model.body_mass.sum() / first.body_mass.sum()
        return sim._replace(friction_scale=sim.friction_scale * friction, mass_scale=sim.mass_scale * mass)


def domain_randomize(model: "mjx.Model", rng: Key[Array, " n"] | Shaped[Array, "n 2"]) -> "tuple[mjx.Model, mjx.Model]":
    """n models with random friction and mass, and the axes of their batched fields (None for all others).

    Args:
      rng: n keys, one for each env.
    """

    def draw(key: Any) -> tuple[Array, Array]:
        low, high = jnp.array([FRICTION[0], MASS[0]]), jnp.array([FRICTION[1], MASS[1]])
        friction, mass = jax.random.uniform(key, (2,), jnp.float32, low, high)
        return friction, mass

    friction, mass = jax.vmap(draw)(rng)
    factors = dict.fromkeys(_TAKEN, mass) | {"geom_friction": friction}
    values = {name: jax.vmap(jnp.multiply, (0, None))(f, getattr(model, name)) for name, f in factors.items()}
    axes = jax.tree.map(lambda _: None, model)
    return model.tree_replace(values), axes.tree_replace(dict.fromkeys(_TAKEN, 0))
