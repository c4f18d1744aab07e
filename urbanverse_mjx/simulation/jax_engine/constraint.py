"""Contact and joint-limit constraints as rows, and the solver that finds the acceleration.

In:   contacts, MJX's smooth dynamics.
Out:  acceleration, constraint force and the contacts' normal forces.
When: every physics step, per env, inside jit.

The physics is MuJoCo's: soft constraints with solref and solimp, friction as a pyramid of four edges per contact,
the acceleration that minimises  1/2 (a - a0)' M (a - a0) + 1/2 sum D_i min(0, J_i a - aref_i)^2.
All sizes are fixed; a row that does not act has D = 0.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import mujoco

from ..collision_slots.hull_contact import SphereContacts
from ..collision_slots.static_slots import both_surfaces
from ..physics_model import LimitTable, SphereTable

#: Tolerance within which a step of length 1 ends at the minimum of the quadratic.
_FULL_STEP_TOLERANCE = 1e-3
#: Step length relative to the acceleration below which the solver stops; otherwise rows with nearly zero force could be
#: added and removed forever.
_MIN_STEP_RATIO = 1e-6
#: The line search ends when the slope is below this share of that at its start.
_SLOPE_TOLERANCE = 1e-4


class Rows(NamedTuple):
    """Constraint rows: jacobian (n, nv), stiffness D (n,), reference acceleration aref (n,)."""

    jacobian: Any
    stiffness: Any
    reference: Any


def _impedance(solimp: Any, depth: Any) -> Any:
    """MuJoCo's impedance curve at a violation of `depth` (n,) m or rad; solimp (n, 5)."""
    low = jnp.clip(solimp[:, 0], mujoco.mjMINIMP, mujoco.mjMAXIMP)
    high = jnp.clip(solimp[:, 1], mujoco.mjMINIMP, mujoco.mjMAXIMP)
    middle = jnp.clip(solimp[:, 3], mujoco.mjMINIMP, mujoco.mjMAXIMP)
    power = jnp.maximum(solimp[:, 4], 1.0)
    x = jnp.clip(jnp.abs(depth) / jnp.maximum(solimp[:, 2], mujoco.mjMINVAL), 0.0, 1.0)
    rising = x**power / middle ** (power - 1.0)
    falling = 1.0 - (1.0 - x) ** power / (1.0 - middle) ** (power - 1.0)
    return low + jnp.where(x < middle, rising, falling) * (high - low)


def _spring(solref: Any, solimp: Any, depth: Any, timestep: float) -> tuple[Any, Any, Any]:
    """Stiffness, damping and impedance (n,) of constraints; positive solref alone (time constant, damping ratio)."""
    high = jnp.clip(solimp[:, 1], mujoco.mjMINIMP, mujoco.mjMAXIMP)
    constant = jnp.maximum(solref[:, 0], 2.0 * timestep)
    stiffness = 1.0 / (high * constant * solref[:, 1]) ** 2
    return stiffness, 2.0 / (high * constant), _impedance(solimp, depth)


def tangents(normal: Any) -> tuple[Any, Any]:
    """Two unit vectors (n, 3) that complete the normals (n, 3), chosen as MuJoCo chooses them."""
    sideways = jnp.abs(normal[:, 1:2]) < 0.5
    guess = jnp.where(sideways, jnp.array([0.0, 1.0, 0.0]), jnp.array([0.0, 0.0, 1.0]))
    first = guess - normal * jnp.sum(guess * normal, axis=1, keepdims=True)
    first = first / jnp.linalg.norm(first, axis=1, keepdims=True)
    return first, jnp.cross(normal, first)


def contact_rows(
    contacts: SphereContacts,
    spheres: SphereTable,
    slot_friction: Any,
    friction_scale: Any,
    motion: Any,
    centre: Any,
    qvel: Any,
    timestep: float,
    pushed: "Pushed | None" = None,
    least: bool = False,
) -> Rows:
    """Four rows per contact.

    Args:
      pushed: what the contacts do to bodies, whose 6 W velocities then follow the robot's in qvel; None = no bodies.
      least: see `both_surfaces`.
      slot_friction: (C,) of the hulls.
      friction_scale: () factor on the friction of each contact.
      motion: (nv, 6) MJX's cdof, angular then linear, about `centre` (3,).
      qvel: (nv,).
    """
    sphere = contacts.sphere
    acts = contacts.distance < 0
    depth = jnp.where(acts, contacts.distance, 0.0)
    arm = contacts.position - centre
    velocity = motion[None, :, 3:] + jnp.cross(motion[None, :, :3], arm[:, None, :])
    velocity = velocity * jnp.asarray(spheres.dof_mask, jnp.float32)[sphere][..., None]
    first, second = tangents(contacts.normal)
    axes = jnp.stack([contacts.normal, first, second], axis=1)
    relative = jnp.einsum("nki,nvi->nkv", axes, velocity)
    if pushed is not None:
        relative = jnp.concatenate([relative, -pushed.columns(axes, contacts.position)], axis=-1)

    own, slippery = jnp.asarray(spheres.own_friction)[sphere], jnp.asarray(spheres.slippery)[sphere]
    friction = jnp.asarray(spheres.friction, jnp.float32)[sphere]
    friction = jnp.where(own, friction, both_surfaces(least, friction, slot_friction[contacts.slot]))
    friction = jnp.where(slippery, 0.0, friction * friction_scale)[:, None]
    solref = jnp.asarray(spheres.solref, jnp.float32)[sphere]
    solimp = jnp.asarray(spheres.solimp, jnp.float32)[sphere]
    weight = jnp.asarray(spheres.invweight, jnp.float32)[sphere]
    if pushed is not None:
        weight = weight + pushed.weight()
    return pyramid_rows(relative, friction, slippery, acts, depth, solref, solimp, weight, qvel, timestep)


def pyramid_rows(
    relative: Any,
    friction: Any,
    slippery: Any,
    acts: Any,
    depth: Any,
    solref: Any,
    solimp: Any,
    weight: Any,
    qvel: Any,
    timestep: float,
) -> Rows:
    """The four edges of the friction pyramid of n contacts.

    Args:
      relative: (n, 3, nv) velocity of the first surface against the second along the normal and both tangents.
      friction: (n, 1).
      slippery, acts: (n,) bool, without friction; touching.
      depth: (n,) m, negative where it acts.
      solref: (n, 2), solimp: (n, 5), weight: (n,) 1/kg.
    """
    along, side, up = jnp.moveaxis(relative, 1, 0)
    jacobian = jnp.stack(
        [along + friction * side, along - friction * side, along + friction * up, along - friction * up], 1
    )
    stiffness, damping, impedance = _spring(solref, solimp, depth, timestep)
    square = friction[:, 0] ** 2
    # A frictionless contact is one row in MuJoCo; here it is the same row four times with a quarter of the stiffness.
    diagonal = jnp.where(slippery, 4.0 * weight, 2.0 * square * (1.0 + square) * weight)
    resistance = jnp.maximum(diagonal * (1.0 - impedance) / impedance, mujoco.mjMINVAL)
    reference = -damping[:, None] * (jacobian @ qvel) - (stiffness * impedance * depth)[:, None]
    return Rows(
        jnp.where(acts[:, None, None], jacobian, 0.0).reshape(-1, qvel.shape[0]),
        jnp.repeat(jnp.where(acts, 1.0 / resistance, 0.0), 4),
        jnp.where(acts[:, None], reference, 0.0).reshape(-1),
    )


def limit_rows(limits: LimitTable, qpos: Any, qvel: Any, timestep: float) -> Rows:
    """One row per limited joint, for the end of its range that is nearer."""
    value = qpos[limits.qpos]
    span = jnp.asarray(limits.range, jnp.float32)
    below, above = value - span[:, 0], span[:, 1] - value
    depth = jnp.minimum(below, above)
    sign = jnp.where(below < above, 1.0, -1.0)
    acts = depth < 0
    jacobian = jnp.zeros((len(limits.dof), qvel.shape[0])).at[jnp.arange(len(limits.dof)), limits.dof].set(sign)
    solref, solimp = jnp.asarray(limits.solref, jnp.float32), jnp.asarray(limits.solimp, jnp.float32)
    stiffness, damping, impedance = _spring(solref, solimp, depth, timestep)
    resistance = jnp.maximum(
        jnp.asarray(limits.invweight, jnp.float32) * (1.0 - impedance) / impedance, mujoco.mjMINVAL
    )
    reference = -damping * (jacobian @ qvel) - stiffness * impedance * depth
    return Rows(jacobian, jnp.where(acts, 1.0 / resistance, 0.0), reference)


def join(first: Rows, second: Rows) -> Rows:
    return Rows(*(jnp.concatenate([a, b]) for a, b in zip(first, second, strict=True)))


class Pushed(NamedTuple):
    """Effect of n contacts on W bodies.

    Attributes:
      body: (n,) i32 body that each contact pushes, -1 = none.
      place: (W, 3) m, centres of mass.
      inverse: (W,) 1/kg.
    """

    body: Any
    place: Any
    inverse: Any

    def columns(self, axes: Any, position: Any) -> Any:
        """(n, 3, 6 W): velocity at position (n, 3) m along axes (n, 3, 3) for each of the bodies' velocities."""
        mine = (self.body[:, None] == jnp.arange(len(self.place))).astype(jnp.float32)
        arm = position[:, None] - self.place
        turn = jnp.cross(arm[:, None], axes[:, :, None])
        both = jnp.concatenate([jnp.broadcast_to(axes[:, :, None], turn.shape), turn], axis=-1)
        return (both * mine[:, None, :, None]).reshape(*axes.shape[:2], -1)

    def weight(self) -> Any:
        """(n,) 1/kg of the bodies."""
        return jnp.where(self.body >= 0, self.inverse[jnp.maximum(self.body, 0)], 0.0)


class _Search(NamedTuple):
    """State of the Newton solver.

    Attributes:
      a: (nv,) acceleration.
      gap: (n,) J a - aref.
      pushing: (n,) bool, gap < 0.
      done: () bool, a is the minimum.
      steps: () i32.
    """

    a: Any
    gap: Any
    pushing: Any
    done: Any
    steps: Any


def solve(mass: Any, free: Any, start: Any, rows: Rows, iterations: int, line_steps: int) -> tuple[Any, Any]:
    """Newton's method with an exact line search for the constrained acceleration.

    The cost is quadratic as long as the same rows push, so a step after which they do has found the minimum.

    Args:
      mass: (nv, nv), free: (nv,) unconstrained acceleration, start: (nv,) acceleration of the step before.
      iterations: at most so many Newton steps.
      line_steps: each with so many in its line search.

    Returns:
      acceleration (nv,) and row forces (n,), not negative.
    """
    jacobian, stiffness, reference = rows

    def begin(a: Any) -> tuple[Any, Any]:
        gap = jacobian @ a - reference
        short = jnp.minimum(gap, 0.0)
        return gap, 0.5 * (a - free) @ mass @ (a - free) + 0.5 * jnp.sum(stiffness * short * short)

    def improve(state: _Search) -> _Search:
        a, gap, pushing, _, steps = state
        pull = jnp.where(pushing, stiffness, 0.0)
        smooth = mass @ (a - free)
        gradient = smooth + (pull * gap) @ jacobian
        hessian = mass + (jacobian * pull[:, None]).T @ jacobian
        step = -jax.scipy.linalg.cho_solve(jax.scipy.linalg.cho_factor(hessian, lower=True), gradient)
        change = jacobian @ step
        alpha = _line_search(smooth @ step, step @ mass @ step, gap, change, stiffness, line_steps)
        a = a + alpha * step
        gap = jacobian @ a - reference
        done = jnp.all((gap < 0) == pushing) & (jnp.abs(alpha - 1.0) < _FULL_STEP_TOLERANCE)
        done |= jnp.max(jnp.abs(alpha * step)) <= _MIN_STEP_RATIO * jnp.max(jnp.abs(a))
        return _Search(a, gap, gap < 0, done, steps + 1)

    (gap_start, cost_start), (gap_free, cost_free) = begin(start), begin(free)
    better = cost_start < cost_free
    gap = jnp.where(better, gap_start, gap_free)
    state = _Search(jnp.where(better, start, free), gap, gap < 0, jnp.zeros((), bool), jnp.zeros((), jnp.int32))
    state = jax.lax.while_loop(lambda s: ~s.done & (s.steps < iterations), improve, state)
    return state.a, stiffness * jnp.maximum(-state.gap, 0.0)


class _Bracket(NamedTuple):
    """Line search: alpha (), the interval around the root (low, high), slope () at alpha, steps done."""

    alpha: Any
    low: Any
    high: Any
    slope: Any
    steps: Any


def _line_search(slope: Any, curvature: Any, gap: Any, change: Any, stiffness: Any, steps: int) -> Any:
    """Finds the minimum of the cost along a step: the root of its slope, which is increasing and piecewise linear.

    Args:
      slope, curvature: () of the smooth part at 0.
      gap, change, stiffness: (n,) of the rows.
      steps: at most so many evaluations.
    """

    def at(alpha: Any) -> tuple[Any, Any]:
        left = gap + alpha * change
        pull = jnp.where(left < 0, stiffness, 0.0) * change
        return slope + alpha * curvature + jnp.sum(pull * left), curvature + jnp.sum(pull * change)

    limit = _SLOPE_TOLERANCE * jnp.abs(at(jnp.zeros(()))[0])

    def narrow(bracket: _Bracket) -> _Bracket:
        alpha, low, high, _, count = bracket
        value, second = at(alpha)
        low, high = jnp.where(value < 0, alpha, low), jnp.where(value < 0, high, alpha)
        guess = alpha - value / jnp.maximum(second, mujoco.mjMINVAL)
        inside = (guess > low) & (guess < high)
        fallback = jnp.where(jnp.isfinite(high), 0.5 * (low + high), 2.0 * low)
        near = jnp.abs(value) <= limit
        return _Bracket(jnp.where(near, alpha, jnp.where(inside, guess, fallback)), low, high, value, count + 1)

    zero, infinite = jnp.zeros(()), jnp.full((), jnp.inf)
    start = _Bracket(jnp.ones(()), zero, infinite, infinite, jnp.zeros((), jnp.int32))
    return jax.lax.while_loop(lambda b: (jnp.abs(b.slope) > limit) & (b.steps < steps), narrow, start).alpha
