"""Data parallelism of the iterative learners: envs spread over devices, equal parameters on all of them.

Each device steps its share of the envs and computes the gradients of its share of a minibatch; gradients are averaged
before the optimizer sees them, so N devices do what one does with the same total number of envs, up to rounding, apart
from the random numbers of image augmentation and of a teacher that uses its key, and the order of sequences.
`jax.shard_map` gives each device a program of its own, which the engines' custom calls need.
"""

import dataclasses
import math
from collections.abc import Callable, Mapping
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax.sharding import NamedSharding, PartitionSpec

from .. import table_arguments
from ..datatypes import ValidationError
from ..datatypes import validation as v

AXIS = "devices"
#: Placement of arrays: with a leading axis of envs, and equal on all devices.
SPREAD, EQUAL = PartitionSpec(AXIS), PartitionSpec()


@dataclasses.dataclass(frozen=True)
class Devices:
    """Devices that train together. With one device, all methods return what they are given.

    `mean`, `sum`, `variance`, `std`, `rows` and `own_key` are called within a function that `run` compiles, the others
    outside of it.

    Attributes:
      devices: of this process, or of all processes that train together.
    """

    devices: tuple[Any, ...]

    @staticmethod
    def every() -> "Devices":
        """All devices that JAX has."""
        return Devices(tuple(jax.devices()))

    @property
    def count(self) -> int:
        return len(self.devices)

    @property
    def _mesh(self) -> jax.sharding.Mesh:
        return jax.sharding.Mesh(np.array(self.devices), (AXIS,))

    def check_shares(self, num_envs: int, minibatches: Mapping[str, int]) -> None:
        """Checks that every device gets equally many envs of every minibatch.

        Args:
          minibatches: key in the config -> number of minibatches that all envs are cut into, of each stage.

        Raises:
          ValidationError: it does not.
        """
        for key, number in minibatches.items():
            v.integer(number, key, 1)
        parts = math.lcm(*minibatches.values())
        each = self.count * parts
        if num_envs % each:
            raise ValidationError(
                f"ppo.num_envs: found {num_envs}, needed a multiple of {v.counted(self.count, 'devices')} x "
                f"{v.counted(parts, 'minibatches')} ({', '.join(minibatches)}); take --num-envs "
                f"{nearest(num_envs, each)}{self.remedy}."
            )

    def check_draws(self, learns_episodes: bool) -> None:
        """Checks that episodes are not drawn by their success rates on several devices.

        Args:
          learns_episodes: of the wrapped env.

        Raises:
          ValidationError: they are.
        """
        if self.count > 1 and learns_episodes:
            raise ValidationError(
                f"config.schedule.learnable: found it together with {self.count} devices, needed one device, because "
                "each would count success rates of its own; set it to 0.0, or CUDA_VISIBLE_DEVICES to one GPU."
            )

    def check_places(self, held: table_arguments.Held | None) -> None:
        """Checks that streets do not come and go on several devices.

        Args:
          held: of the wrapped env.

        Raises:
          ValidationError: they do.
        """
        if self.count > 1 and held is not None:
            raise ValidationError(
                f"config.schedule.places: found it together with {self.count} devices, needed one device, whose "
                "streets are exchanged; set it to 0, or CUDA_VISIBLE_DEVICES to one GPU."
            )

    @property
    def remedy(self) -> str:
        """The end of an error about a number that does not divide."""
        return "" if self.count == 1 else ", or fewer GPUs by CUDA_VISIBLE_DEVICES"

    def run(
        self,
        function: Callable[..., Any],
        given: Any,
        made: Any,
        donate: Any = (),
        held: table_arguments.Held | None = None,
    ) -> Callable[..., Any]:
        """Compiles a function that runs on each device with its share of the envs.

        Args:
          function: of arguments placed as `given`, returns what is placed as `made`.
          given, made: prefix pytrees of `SPREAD` and `EQUAL`.
          donate: numbers of the arguments whose buffers are reused.
          held: tables that may be replaced by others, on one device; see `check_places`.
        """
        if self.count == 1:
            return table_arguments.jit(function, donate, held)
        mesh = self._mesh
        alone = jax.shard_map(function, mesh=mesh, in_specs=given, out_specs=made, check_vma=False)
        return jax.jit(
            alone, donate_argnums=donate, in_shardings=self._shardings(given), out_shardings=self._shardings(made)
        )

    def create(self, make: Callable[[], Any], placement: Any) -> Any:
        """What a function of nothing returns, on the devices; all processes call this with functions that are equal."""
        return make() if self.count == 1 else jax.jit(make, out_shardings=self._shardings(placement))()

    def place(self, tree: Any, placement: Any) -> Any:
        """Arrays that are equal in all processes, on the devices; each device gets its share alone.

        Args:
          placement: prefix pytree of `SPREAD` and `EQUAL`.
        """
        if self.count == 1:
            return tree
        return jax.tree.map(
            lambda sharding, part: jax.tree.map(lambda x: _placed(x, sharding), part), self._shardings(placement), tree
        )

    def local_copy(self, tree: Any) -> Any:
        """The copy of the first device of arrays that are equal on all."""
        if self.count == 1:
            return tree
        return jax.tree.map(lambda x: x.addressable_data(0), tree)

    def _shardings(self, placement: Any) -> Any:
        return jax.tree.map(
            lambda spec: NamedSharding(self._mesh, spec), placement, is_leaf=lambda x: isinstance(x, PartitionSpec)
        )

    def mean(self, tree: Any) -> Any:
        """Mean over devices."""
        return tree if self.count == 1 else jax.lax.pmean(tree, AXIS)

    def sum(self, tree: Any) -> Any:
        """Sum over devices."""
        return tree if self.count == 1 else jax.lax.psum(tree, AXIS)

    def rows(self, values: jax.Array) -> jax.Array:
        """This device's rows of values (n, ...) for all envs."""
        if self.count == 1:
            return values
        each = values.shape[0] // self.count
        return jax.lax.dynamic_slice_in_dim(values, jax.lax.axis_index(AXIS) * each, each)

    def own_key(self, key: jax.Array) -> jax.Array:
        """A key that differs from those of other devices."""
        return key if self.count == 1 else jax.random.fold_in(key, jax.lax.axis_index(AXIS))

    def variance(self, values: jax.Array) -> jax.Array:
        """Variance of the values of all devices."""
        if self.count == 1:
            return values.var()
        return self.mean(jnp.square(values - self.mean(values.mean())).mean())

    def std(self, values: jax.Array) -> jax.Array:
        """Standard deviation of the values of all devices."""
        return values.std() if self.count == 1 else jnp.sqrt(self.variance(values))


def nearest(number: int, each: int) -> int:
    """The multiple of `each`, at least one, that is nearest to a number."""
    return each * max(round(number / each), 1)


def _placed(leaf: Any, sharding: NamedSharding) -> jax.Array:
    is_key = jnp.issubdtype(leaf.dtype, jax.dtypes.prng_key)
    data = np.asarray(jax.random.key_data(leaf) if is_key else leaf)
    spread = jax.make_array_from_callback(data.shape, sharding, lambda share: data[share])
    return jax.random.wrap_key_data(spread, impl=jax.random.key_impl(leaf)) if is_key else spread


#: One device, whichever computes.
ALONE = Devices((None,))
