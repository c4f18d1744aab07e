"""Appearances of moving people and vehicles: a few meshes for each kind of agent, part of every bank.

In:   recipes. Out: `AgentAppearance`s, ordered within a kind as they are assigned to agents. When: when a bank is
packed.

Meshes of vehicles are scaled to the sides of their kind in `crowds.kinds`, so that appearance and avoidance agree;
meshes of people are not scaled.
"""

import dataclasses
import functools

import numpy as np

from urbanverse_mjx.datatypes import AgentAppearance, ValidationError

from .recipe import all_recipes

#: Kind, leaf and variants. Walking poses come first, because few agents stand.
_APPEARANCES = (
    ("pedestrian", "pedestrian adult", (0, 1, 3, 5, 2, 4)),
    ("pedestrian", "elderly person", (0,)),
    ("wheelchair", "wheelchair user", (0, 1)),
    ("scooter", "electric scooter rider", (0, 1)),
    ("cyclist", "cyclist", (0, 1)),
    ("car", "sedan", (0, 1, 2)),
)
#: m, length and width of the scaled kinds: 2 (half_length + radius) and 2 radius in `crowds.kinds`.
_SIDES = {"car": (4.74, 1.76), "cyclist": (1.80, 0.75)}


@functools.cache
def agent_appearances() -> tuple[AgentAppearance, ...]:
    """Builds the appearances of all kinds of agents, once: their arrays are shared by all who ask.

    Raises:
      ValidationError: a recipe does not exist.
    """
    recipes = {recipe.leaf: recipe for recipe in all_recipes()}
    appearances = []
    for kind, leaf, variants in _APPEARANCES:
        if leaf not in recipes:
            raise ValidationError(
                f"agent {kind!r}: found no recipe for {leaf!r}, needed one; fix assets/meshes/agents.py."
            )
        for variant in variants:
            mesh = recipes[leaf].build(variant).mesh
            if kind in _SIDES:
                length, width = _SIDES[kind]
                along, across, _ = mesh.extent
                # The height is scaled like the length, so that wheels stay round seen from the side.
                factor = np.array([length / along, min(width / across, 1.0), length / along])
                mesh = dataclasses.replace(mesh, vertices=mesh.vertices * factor)
            appearances.append(AgentAppearance(kind, leaf, mesh))
    return tuple(appearances)
