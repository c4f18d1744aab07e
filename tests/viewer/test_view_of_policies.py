"""`urbanverse view` in a real browser with what its environments run: a trained checkpoint, and the Go2 by keys."""

import contextlib
import itertools
import pathlib
import threading
from collections.abc import Iterator
from typing import Any

import jax
import numpy as np
import pytest

from tests.support.browser import browser
from tests.support.driven_page import wait
from urbanverse_mjx import pipeline
from urbanverse_mjx.datatypes import SceneBank
from urbanverse_mjx.pipeline.viewing import ViewOptions
from urbanverse_mjx.training.policy import load_policy
from urbanverse_mjx.viewer import page as page_module
from urbanverse_mjx.viewer.page import Page

pytestmark = pytest.mark.slow
CHECKPOINT = pathlib.Path(__file__).parents[2] / "benchmarks/policies/coco_paper"
#: The episode goes on whatever the robot touches.
FREE = {"terminate_on_hit": False, "terminate_off_traversable": False, "success_radius": 1e-3}
SECONDS = 600.0


@contextlib.contextmanager
def viewed(
    bank: SceneBank, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch, **options: Any
) -> Iterator[tuple[Page, Any]]:
    """The command's page and a browser's tab with it."""
    bank.save(tmp_path / "boxes.npz")
    pages: list[Page] = []

    class Kept(Page):
        def __init__(self, *args: Any, **kwargs: Any) -> None:
            super().__init__(*args, **kwargs)
            pages.append(self)

    monkeypatch.setattr(page_module, "Page", Kept)
    ready: list[str] = []
    stop = threading.Event()
    chosen = ViewOptions(port=0, open=False, env_overrides={"impl": "jax", **FREE}, **options)
    arguments = (str(tmp_path / "boxes.npz"), chosen, ready.append, stop.is_set)
    thread = threading.Thread(target=pipeline.view, args=arguments, daemon=True)
    thread.start()
    try:
        wait(lambda: bool(ready) or not thread.is_alive(), SECONDS)
        with browser() as chromium:
            tab = chromium.new_page(viewport={"width": 700, "height": 500})
            tab.goto(ready[0])
            tab.frame_locator("#viser").get_by_role("button", name="Play").wait_for(timeout=240_000)
            yield pages[0], tab
    finally:
        stop.set()
        thread.join(SECONDS)
    assert not thread.is_alive()


def test_a_checkpoint_drives_the_page(
    small_bank: SceneBank, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With the actions that its network gives for what the robot observes."""
    with viewed(small_bank, tmp_path, monkeypatch, policy=str(CHECKPOINT)) as (page, tab):
        tab.frame_locator("#viser").get_by_role("button", name="Play").click()
        tab.get_by_text("coco_paper drives").wait_for(timeout=60_000)
        wait(lambda: len(page.session) > 6, SECONDS)
        frames, env = page.session.frames[:7], page.session.machine.env
    agent, _ = load_policy(CHECKPOINT)
    observe, answer = jax.jit(jax.vmap(env.observe)), jax.jit(jax.vmap(lambda obs: agent(obs, jax.random.key(0))))
    for before, after in itertools.pairwise(frames):
        np.testing.assert_allclose(after.action, np.clip(answer(observe(before.nav)), -1.0, 1.0), atol=1e-3)
    driven = np.asarray(frames[-1].nav.sim.qpos)[0, :2] - np.asarray(frames[0].nav.sim.qpos)[0, :2]
    assert np.linalg.norm(driven) > 0.1
    assert np.ptp([frame.action for frame in frames[1:]], axis=0).max() > 1e-3


def test_the_go2_walks_by_keys(small_bank: SceneBank, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with viewed(small_bank, tmp_path, monkeypatch, policy="zero", env_name="Go2Nav") as (page, tab):
        robot = page.session.machine.env.robot
        assert robot.name == "go2"

        def velocity() -> tuple[float, float]:
            """m/s over the ground and rad/s, means of the last second."""
            frames = page.session.frames[-round(1.0 / page.session.machine.env.dt) :]
            speeds = np.array([np.asarray(frame.nav.sim.qvel)[0] for frame in frames])
            return float(np.linalg.norm(speeds[:, :2], axis=1).mean()), float(speeds[:, 5].mean())

        def hold(key: str, until: Any) -> None:
            """A key that is held while the step compiles is forgotten, so it is pressed again."""
            steps = len(page.session)
            tab.keyboard.down(key)
            wait(lambda: len(page.session) > steps, SECONDS)
            tab.keyboard.up(key)
            tab.keyboard.down(key)
            wait(until, SECONDS)
            tab.get_by_text("you drive").wait_for(timeout=60_000)
            tab.keyboard.up(key)

        hold("w", lambda: velocity()[0] > 0.6 * robot.max_speed)
        wait(lambda: not page._teleop.held, SECONDS)
        tab.get_by_text("nobody drives").or_(tab.get_by_text("paused")).wait_for(timeout=60_000)
        hold("a", lambda: velocity()[1] > 0.4 * robot.max_yaw_rate)
        driven = page.session.by_hand(len(page.session) - 1)
        assert driven.any()
        heights = [float(np.asarray(frame.nav.sim.qpos)[0, 2]) for frame in page.session.frames]
        assert min(heights) > heights[0] - 0.15, "it walks, and does not lie"
