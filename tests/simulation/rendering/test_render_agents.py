"""Moving agents in images: positions, labels, and no image of absent agents."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from tests.support.agent_appearances import BOXES, with_box_agents
from tests.support.box_bank import KERB, box_bank
from urbanverse_mjx.datatypes import AgentMotion, ValidationError
from urbanverse_mjx.robots import make_coco
from urbanverse_mjx.simulation.rendering.renderer import AGENT_LABEL, Renderer

from . import render_cases as cases

CAMERA_POSITION = np.array([20.0, 6.0, KERB + 1.0])


def standing(*places: tuple[float, float, float, bool]) -> AgentMotion:
    """Agents at x, y (m), heading (rad), present or not, on the pavement."""
    x, y, heading, present = (np.array(column) for column in zip(*places, strict=True))
    position = np.stack([x, y, np.full(len(x), KERB)], -1)
    still = jnp.zeros_like(position)
    return AgentMotion(jnp.asarray(position), jnp.asarray(heading), still, still[:, 0], jnp.asarray(present, bool))


@pytest.fixture(scope="module")
def renderer() -> Renderer:
    bank = with_box_agents(box_bank(1, num_objects=1))
    names = bank.agents["kind"]
    appearances = [names.index("pedestrian"), names.index("car")]
    return Renderer(bank, make_coco(), 36, 64, outputs=("depth", "category", "object"), agents=appearances)


@pytest.mark.extended
def test_agents_are_seen_where_they_stand(renderer: Renderer) -> None:
    """The middle ray of a camera at 1 m height along the street, three streets at once."""
    people = [
        standing((25.0, 6.0, 0.0, True), (40.0, -2.0, 0.0, True)),
        standing((25.0, 6.0, np.pi / 2, True), (30.0, 6.0, 0.0, True)),
        standing((25.0, 6.0, 0.0, False), (30.0, 6.0, np.pi / 2, True)),
    ]
    agents = jax.tree.map(lambda *x: jnp.asarray(np.stack(x)), *people)
    view = jax.jit(jax.vmap(lambda a: renderer.view(0, CAMERA_POSITION, cases.AHEAD, 0.9, agents=a)))
    seen = {name: np.asarray(x)[:, 18, 32] for name, x in view(agents).items()}
    (length, width, _), (_, car_width, _) = BOXES["pedestrian"], BOXES["car"]
    np.testing.assert_allclose(seen["depth"], [5.0 - length / 2, 5.0 - width / 2, 10.0 - car_width / 2], atol=2e-3)
    np.testing.assert_array_equal(seen["object"], [AGENT_LABEL, AGENT_LABEL, AGENT_LABEL - 1])
    names = renderer.bank.meta["categories"]
    assert [names[i] for i in seen["category"]] == ["agent:pedestrian", "agent:pedestrian", "agent:car"]


@pytest.mark.extended
def test_nobody_is_seen_where_nobody_is(renderer: Renderer) -> None:
    alone = jax.jit(lambda: renderer.view(0, CAMERA_POSITION, cases.AHEAD, 0.9))()
    assert not (np.asarray(alone["object"]) <= AGENT_LABEL).any()
    plain = Renderer(renderer.bank, make_coco(), 36, 64, outputs=("depth", "category", "object"))
    same = jax.jit(lambda: plain.view(0, CAMERA_POSITION, cases.AHEAD, 0.9))()
    for name, x in same.items():
        np.testing.assert_array_equal(np.asarray(x), np.asarray(alone[name]), err_msg=name)


def test_an_appearance_that_no_bank_has_is_refused() -> None:
    with pytest.raises(ValidationError, match="agents"):
        Renderer(box_bank(1, num_objects=1), None, 8, 8, agents=[3])
