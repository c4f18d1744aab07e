"""Shapes that public functions of the environments are annotated with: checked here, never at run time for users."""

import pathlib
import subprocess
import sys
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import pytest
from beartype import beartype
from jaxtyping import TypeCheckError, jaxtyped

from urbanverse_mjx.datatypes import SceneBank
from urbanverse_mjx.envs.heights import GroundHeights
from urbanverse_mjx.envs.joystick import terms as walking
from urbanverse_mjx.envs.navigation import terms
from urbanverse_mjx.envs.navigation.encounters import route_pose
from urbanverse_mjx.envs.navigation.surroundings import Surroundings

ROUTE = ((2,), (3,), (5, 3))
#: A function, the shapes of its f32 arguments, and which of them gets which wrong shape.
CASES: list[tuple[Callable[..., Any], tuple[tuple[int, ...], ...], int, tuple[int, ...]]] = [
    (terms.to_body, ((2,), ()), 0, (3,)),
    (terms.to_world, ((7, 5, 2), ()), 0, (7, 5, 3)),
    (terms.to_world, ((2,), ()), 1, (1,)),
    (terms.route_length, ROUTE[1:], 1, (5, 2)),
    (terms.route_position, ROUTE, 0, (3,)),
    (terms.route_completed, (*ROUTE, (), (), ()), 4, (2,)),
    (terms.reward_velocity_cosine, ((2,), (2,)), 1, (3,)),
    (terms.reward_progress, ((), ()), 1, (3,)),
    (route_pose, ((4,), (5, 3), ()), 1, (5, 2)),
    (walking.is_moving, ((3,),), 0, (2,)),
]


def shapes_of(function: Callable[..., Any], shapes: tuple[tuple[int, ...], ...], *before: Any) -> Any:
    """The function's result under the shape checks, traced and not computed."""
    checked = jaxtyped(typechecker=beartype)(function)
    return jax.eval_shape(lambda *a: checked(*before, *a), *(jax.ShapeDtypeStruct(s, jnp.float32) for s in shapes))


@pytest.mark.parametrize(("function", "shapes", "wrong", "shape"), CASES, ids=lambda x: getattr(x, "__name__", None))
def test_terms_take_their_shapes_and_no_others(
    function: Callable[..., Any], shapes: tuple[tuple[int, ...], ...], wrong: int, shape: tuple[int, ...]
) -> None:
    shapes_of(function, shapes)
    with pytest.raises(TypeCheckError):
        shapes_of(function, tuple(shape if i == wrong else s for i, s in enumerate(shapes)))


@pytest.mark.extended
def test_look_ups_keep_the_axes_of_the_places(small_bank: SceneBank) -> None:
    for look_up, last in ((Surroundings(small_bank, 1.0).distances, (2,)), (GroundHeights(small_bank).__call__, ())):
        scene = jnp.int32(0)
        for axes in ((), (4,), (3, 4)):
            assert shapes_of(look_up, ((*axes, 2),), scene).shape == (*axes, *last)
        with pytest.raises(TypeCheckError):
            shapes_of(look_up, ((4, 3),), scene)
        with pytest.raises(TypeCheckError):
            shapes_of(look_up, ((4, 2),), jnp.float32(0.0))


#: Every annotation of `envs` is checked while a reset and a step of each task are traced.
TRACE = """
import gc
gc.disable()  # a fifth of the time, and the process ends soon
from jaxtyping import install_import_hook
with install_import_hook("urbanverse_mjx.envs", "beartype.beartype"):
    import urbanverse_mjx.envs.registry
import jax, jax.numpy as jnp
from jaxtyping import TypeCheckError
from tests.support.box_bank import box_bank
from tests.support.unicycle import unicycle_env
from urbanverse_mjx.envs import registry, wrap_for_training
from urbanverse_mjx.scene.terrain import terrain_bank

navigation = unicycle_env(box_bank(1), {"observations.proprio": True, "observations.privileged_map": True}, vision=True)
overrides = {"preset": "cpu", "impl": "warp"}  # traced in a third of the time: physics is one call
walking = registry.load("Go2Joystick", config_overrides=overrides, bank=terrain_bank(0, 1))
for env in (navigation, walking):
    wrapped = wrap_for_training(env, env.config.episode_length)
    state = jax.eval_shape(wrapped.reset, jax.random.split(jax.random.key(0), 2))
    action = jax.ShapeDtypeStruct((2, env.action_size), jnp.float32)
    jax.eval_shape(wrapped.step, state, action)
    one = jax.eval_shape(env.reset, jax.random.PRNGKey(0))
    jax.eval_shape(env.step, one, jax.ShapeDtypeStruct((env.action_size,), jnp.float32))
    try:
        jax.eval_shape(env.step, one, action)
    except TypeCheckError:
        print("refused")
"""


@pytest.mark.extended
def test_what_flows_through_the_tasks_has_the_annotated_shapes() -> None:
    root = pathlib.Path(__file__).parents[2]
    done = subprocess.run([sys.executable, "-c", TRACE], cwd=root, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-3000:]
    assert done.stdout.split() == ["refused", "refused"]
