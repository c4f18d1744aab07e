"""The MJX engine over the small bank: compiled once for the tests of both engines."""

from typing import TYPE_CHECKING, Any

import jax
import pytest

from tests.support.engine_runs import CONTROL_DT
from tests.support.engine_versions import HAS_MJX
from urbanverse_mjx.datatypes import SceneBank, SimState
from urbanverse_mjx.robots import make_coco

if TYPE_CHECKING:
    from urbanverse_mjx.simulation.jax_engine import JaxEngine

#: Modules about the MJX engine alone.
collect_ignore = [] if HAS_MJX else ["jax_engine", "test_composed_scenes.py", "test_shipped_streets.py"]


@pytest.fixture(scope="session")
def jax_engine(small_bank: SceneBank) -> "JaxEngine":
    from urbanverse_mjx.simulation.jax_engine import JaxEngine

    return JaxEngine(small_bank, make_coco("differential"), control_dt=CONTROL_DT)


@pytest.fixture(scope="session")
def jax_traces() -> list[int]:
    """One entry per trace of `jax_step`."""
    return []


@pytest.fixture(scope="session")
def jax_step(jax_engine: "JaxEngine", jax_traces: list[int]) -> Any:
    """The engine's step over a batch."""

    def step(state: SimState, ctrl: Any) -> SimState:
        jax_traces.append(1)
        return jax.vmap(jax_engine.step)(state, ctrl)

    return jax.jit(step)
