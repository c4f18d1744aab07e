"""The kernel of the fused step: one warp of the GPU, or one call on a CPU, takes an env through a control step."""

# Warp's types in annotations are values; Warp itself checks them.
# pyright: reportAssignmentType=false, reportGeneralTypeIssues=false, reportInvalidTypeForm=false, reportReturnType=false

import functools
from collections.abc import Sequence
from typing import Any

import warp as wp

from .. import contact, kernels
from . import native

_ENV = """
    urbanverse::Env e;
    e.qpos = qpos.data + w * qpos.shape[1], e.qvel = qvel.data + w * qvel.shape[1];
    e.warm = warm.data + w * warm.shape[1], e.ctrl = ctrl.data + w * ctrl.shape[1];
    e.centre = reinterpret_cast<const float*>(centre.data + w);
    e.friction_scale = friction.data[w], e.mass_scale = mass.data[w];
    const int first = w * slots.hull.shape[1];
    e.slot_hull = slots.hull.data + first, e.slot_owner = slots.owner.data + first;
    e.slot_position = reinterpret_cast<const float*>(slots.position.data + first);
    e.slot_rotation = reinterpret_cast<const float*>(slots.rotation.data + first);
    e.slot_friction = slots.friction.data + first;
    const int agent = w * urbanverse::NUM_AGENTS;
    e.agent_present = agents.present.data + agent;
    e.agent_position = reinterpret_cast<const float*>(agents.place.data + agent);
    e.agent_heading = agents.turn.data + agent;
    e.agent_velocity = reinterpret_cast<const float*>(agents.velocity.data + agent);
    e.agent_turn_rate = agents.turn_rate.data + agent;
    e.agent_radius = agents.radius.data, e.agent_half = agents.half.data, e.agent_height = agents.height.data;
    e.missing = nearby.missing.data + 2 * w;
    e.qpos_out = qpos_out.data + w * qpos.shape[1], e.qvel_out = qvel_out.data + w * qvel.shape[1];
    e.warm_out = warm_out.data + w * warm.shape[1];
    e.xpos = reinterpret_cast<float*>(xpos.data + w * xpos.shape[1]);
    e.xquat = reinterpret_cast<float*>(xquat.data + w * xquat.shape[1]);
    e.force = force.data + w, e.foot = foot.data + w * urbanverse::NUM_FEET, e.touch = touch.data + 5 * w;
    e.path = path.data + w * path.shape[1] * path.shape[2], e.hit = hit.data + w * hit.shape[1];
    const urbanverse::Hulls faces = {
        hulls.plane_start.data, hulls.edge_start.data, reinterpret_cast<const float*>(hulls.normal.data),
        hulls.offset.data, reinterpret_cast<const float*>(hulls.start.data),
        reinterpret_cast<const float*>(hulls.edge.data), reinterpret_cast<const float*>(hulls.centre.data),
        reinterpret_cast<const float*>(hulls.half.data)
    };
    const urbanverse::Settings set = {
        static_cast<int>(slots.hull.shape[1]), slots.least, substeps, static_cast<int>(hit.shape[1]), iterations,
        line_steps
    };
#if defined(__CUDA_ARCH__)
    __shared__ urbanverse::Work work;
#else
    urbanverse::Work work;
#endif
    urbanverse::control_step(work, *reinterpret_cast<const urbanverse::Robot*>(robot.data), faces, e, set);
"""


@wp.struct
class Agents:
    """Agents of n worlds as JAX passes them, see `AgentMotion`; (n, A), and (A,) radius, half and height in m."""

    place: wp.array2d[wp.vec3]
    turn: wp.array2d[float]
    velocity: wp.array2d[wp.vec3]
    turn_rate: wp.array2d[float]
    present: wp.array2d[int]
    radius: wp.array[float]
    half: wp.array[float]
    height: wp.array[float]


@functools.cache
def make_step(source: str, before: str = "") -> Any:
    """The kernel of a program, to be launched with dim (n,) and blocks of `native.LANES`, for worlds from `first` on.

    Args:
      source: see `program.RobotProgram`.
      before: C++ in front of it; for tests.
    """
    text = before + source
    options = wp.ModuleBuildOptions(extra_cuda_preamble=text, extra_cpu_preamble=text)

    # Warp names functions in C++ by the decorator's name.
    @wp.func_native(_ENV)
    def advance(
        w: int,
        robot: wp.array[float],
        hulls: contact.Hulls,
        slots: contact.Slots,
        nearby: kernels.Nearby,
        agents: Agents,
        substeps: int,
        iterations: int,
        line_steps: int,
        centre: wp.array[wp.vec3],
        qpos: wp.array2d[float],
        qvel: wp.array2d[float],
        warm: wp.array2d[float],
        ctrl: wp.array2d[float],
        friction: wp.array[float],
        mass: wp.array[float],
        qpos_out: wp.array2d[float],
        qvel_out: wp.array2d[float],
        warm_out: wp.array2d[float],
        xpos: wp.array2d[wp.vec3],
        xquat: wp.array2d[wp.vec4],
        force: wp.array[float],
        touch: wp.array2d[int],
        foot: wp.array2d[float],
        path: wp.array3d[float],
        hit: wp.array2d[int],
    ):
        """Takes one env through its control step."""

    @wp.kernel(
        module="unique",
        module_options={"enable_backward": False, "fast_math": False, "extra_build_options": options},
        enable_backward=False,
        grid_stride=False,
        launch_bounds=native.LANES,
    )
    def step(
        first: int,
        robot: wp.array[float],
        hulls: contact.Hulls,
        slots: contact.Slots,
        nearby: kernels.Nearby,
        agents: Agents,
        substeps: int,
        iterations: int,
        line_steps: int,
        centre: wp.array[wp.vec3],
        qpos: wp.array2d[float],
        qvel: wp.array2d[float],
        warm: wp.array2d[float],
        ctrl: wp.array2d[float],
        friction: wp.array[float],
        mass: wp.array[float],
        qpos_out: wp.array2d[float],
        qvel_out: wp.array2d[float],
        warm_out: wp.array2d[float],
        xpos: wp.array2d[wp.vec3],
        xquat: wp.array2d[wp.vec4],
        force: wp.array[float],
        touch: wp.array2d[int],
        foot: wp.array2d[float],
        path: wp.array3d[float],
        hit: wp.array2d[int],
    ):
        w, _ = wp.tid()
        advance(
            first + w, robot, hulls, slots, nearby, agents, substeps, iterations, line_steps, centre, qpos, qvel, warm,
            ctrl, friction, mass, qpos_out, qvel_out, warm_out, xpos, xquat, force, touch, foot, path, hit,
        )  # fmt: skip

    return step


def load_steps(steps: Sequence[Any], threads: int) -> None:
    """Compiles kernels of `make_step` on Warp's current device, several at the same time."""
    modules = list(dict.fromkeys(step.module for step in steps))
    wp.force_load(wp.get_device(), modules, block_dim=native.LANES, max_workers=threads)
