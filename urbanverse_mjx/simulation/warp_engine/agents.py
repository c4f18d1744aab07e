"""Agent slots in Warp: implements `agent_slots` and writes contacts to the arrays of MuJoCo Warp's solver."""

# Kernels are written in Warp's Python-embedded language; Warp checks their types when it compiles them. Numbers that
# change in a loop are declared by the name of their type.
# pyright: reportArgumentType=false, reportAssignmentType=false, reportAttributeAccessIssue=false, reportCallIssue=false
# pyright: reportGeneralTypeIssues=false, reportIndexIssue=false, reportOperatorIssue=false, reportReturnType=false

import warp as wp

from ..collision_slots import agent_slots
from .contact import Places, Slots, Spheres, put_contact

_FIRST_OWNER, _FRICTION = wp.constant(agent_slots.FIRST_OWNER), wp.constant(agent_slots.FRICTION)
_ON_AXIS = wp.constant(1e-6)

wp.set_module_options({"enable_backward": False, "fast_math": False})


@wp.struct
class Agents:
    """A agents in each of n worlds, moved on after every physics step, and their shapes; see `AgentMotion`.

    place (n, A) about the worlds' origins; turn (n, A) rad; present (n, A); velocity, turn_rate alike;
    radius, half, height (A,) m; hulls: slots in front of theirs; dt: s, the physics step.
    """

    place: wp.array2d[wp.vec3]
    turn: wp.array2d[float]
    velocity: wp.array2d[wp.vec3]
    turn_rate: wp.array2d[float]
    present: wp.array2d[int]
    radius: wp.array[float]
    half: wp.array[float]
    height: wp.array[float]
    hulls: int
    dt: float


@wp.kernel
def begin_agents(
    position: wp.array2d[wp.vec3],
    heading: wp.array2d[float],
    velocity: wp.array2d[wp.vec3],
    turn_rate: wp.array2d[float],
    present: wp.array2d[int],
    origin: wp.array[wp.vec3],
    slots: Slots,
    agents: Agents,
):
    """Reads where the agents are and how they move; dim (n, A)."""
    w, a = wp.tid()
    agents.place[w, a] = position[w, a] - origin[w]
    agents.turn[w, a] = heading[w, a]
    agents.velocity[w, a] = velocity[w, a]
    agents.turn_rate[w, a] = turn_rate[w, a]
    agents.present[w, a] = present[w, a]
    slots.owner[w, agents.hulls + a] = _FIRST_OWNER - a
    slots.friction[w, agents.hulls + a] = _FRICTION


@wp.func
def prism_distance(offset: wp.vec3, turn: float, radius: float, half: float, height: float) -> wp.vec4:
    """Direction (3) and distance (m) from an upright prism to a point; see `agent_slots.prism_distance`."""
    cos, sin = wp.cos(turn), wp.sin(turn)
    along = wp.clamp(cos * offset[0] + sin * offset[1], -half, half)
    x = offset[0] - along * cos
    y = offset[1] - along * sin
    rho = wp.sqrt(x * x + y * y)
    if rho < _ON_AXIS:
        x = -sin
        y = cos
    else:
        x = x / rho
        y = y / rho
    up = wp.where(offset[2] > 0.5 * height, 1.0, -1.0)
    aside = rho - radius
    above = wp.abs(offset[2] - 0.5 * height) - 0.5 * height
    if aside > 0.0 and above > 0.0:
        corner = wp.sqrt(aside * aside + above * above)
        return wp.vec4(x * aside / corner, y * aside / corner, up * above / corner, corner)
    if aside > above:
        return wp.vec4(x, y, 0.0, aside)
    return wp.vec4(0.0, 0.0, up, above)


@wp.kernel
def find_agent_contacts(spheres: Spheres, slots: Slots, agents: Agents, geom_xpos: wp.array2d[wp.vec3], places: Places):
    """Writes the contacts of all pairs of a sphere and an agent, and moves the agents by a physics step; dim (n, A)."""
    w, a = wp.tid()
    place, turn = agents.place[w, a], agents.turn[w, a]
    if agents.present[w, a] != 0:
        for s in range(spheres.geom.shape[0]):
            radius = spheres.radius[s]
            centre = geom_xpos[w, spheres.geom[s]]
            found = prism_distance(centre - place, turn, agents.radius[a], agents.half[a], agents.height[a])
            distance = found[3] - radius
            if distance < 0.0:
                inward = wp.vec3(-found[0], -found[1], -found[2])
                point = centre + inward * (radius + 0.5 * distance)
                put_contact(spheres, slots, places, w, s, agents.hulls + a, distance, point, inward)
    agents.place[w, a] = place + agents.dt * agents.velocity[w, a]
    agents.turn[w, a] = turn + agents.dt * agents.turn_rate[w, a]
