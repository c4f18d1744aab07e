"""The viewer's page in a thread, and a browser's tab with it, for tests that drive by hand."""

import contextlib
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np

from tests.support.browser import browser
from urbanverse_mjx.viewer.front import Front, served
from urbanverse_mjx.viewer.page import Page
from urbanverse_mjx.viewer.session import Machine
from urbanverse_mjx.viewer.teleop import Teleop


class DrivenPage(NamedTuple):
    """A page that runs; tab: Playwright's."""

    page: Page
    teleop: Teleop
    front: Front
    tab: Any


class Streets:
    """The streets of a machine's bank, without a choice."""

    policies = ("go_to_goal",)

    def __init__(self, machine: Machine) -> None:
        self.machine, self.scenes = machine, machine.env.bank.scene_ids

    def cousins(self, scene: str) -> int:
        del scene
        return 1

    def open(self, scene: str, cousin: int, policy: str, people: bool) -> tuple[Machine, int]:
        del cousin, policy, people
        return self.machine, self.scenes.index(scene)


@contextlib.contextmanager
def driven_page(
    machine: Machine, give_back_after: float, script: str, size: tuple[int, int], with_image: bool = True
) -> Iterator[DrivenPage]:
    """A page whose thread ends with the block.

    Args:
      script: that a page of the browser runs before its own.
      size: px, width and height of the tab.
      with_image: whether the page shows the robot's camera.
    """
    teleop, streets = Teleop(give_back_after), Streets(machine)
    with served("127.0.0.1", 0, teleop) as (server, front):
        page = Page(server, streets, streets.scenes[0], "go_to_goal", teleop=teleop)
        page._sees.value = with_image
        front.show(page)
        thread = threading.Thread(target=page.run, daemon=True)
        thread.start()
        try:
            with browser() as chromium:
                tab = chromium.new_page(viewport=dict(zip(("width", "height"), size, strict=True)))
                tab.add_init_script(script)
                tab.goto(front.address)
                tab.frame_locator("#viser").get_by_role("button", name="Play").wait_for(timeout=240_000)
                yield DrivenPage(page, teleop, front, tab)
        finally:
            page.stop()
            thread.join(60.0)
    assert not thread.is_alive()


def wait(until: Callable[[], bool], seconds: float = 60.0) -> None:
    end = time.monotonic() + seconds
    while not until():
        assert time.monotonic() < end
        time.sleep(0.02)


def speeds(page: Page) -> np.ndarray:
    """(T, 2) m/s, rad/s of all steps."""
    velocities = np.array([np.asarray(f.nav.sim.qvel)[0] for f in page.session.frames[1:]])
    return np.stack([np.linalg.norm(velocities[:, :2], axis=1), velocities[:, 5]], 1)
