"""Shows scenes and policies in a web page."""

import contextlib
import dataclasses
import pathlib
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from .. import settings
from ..datatypes import validation as v
from .machines import load_machine
from .view_scenes import ViewScenes

if TYPE_CHECKING:
    from ..viewer.session import Machine

#: Number of environments kept in memory, each with its compiled code.
_KEPT = 3


@dataclasses.dataclass(frozen=True)
class PageOptions:
    """Address of a page, and driving by hand in it."""

    host: str = "127.0.0.1"
    """Address to listen on; 0.0.0.0 allows access from other machines."""
    port: int = 8080
    """Port; 0 for any free one."""
    open: bool = True
    """Open the page in a browser."""
    give_back_after: float = 2.0
    """Seconds without a key after which the policy drives again; 0: only by the key T."""

    def check(self) -> None:
        """Raises ValidationError where a number is out of range."""
        v.integer(self.port, "--port", 0, 65535)
        v.number(self.give_back_after, "--give-back-after", 0.0, 60.0)


@dataclasses.dataclass(frozen=True)
class ViewOptions(PageOptions):
    """Initial contents and address of the page."""

    policy: str = "planner"
    """zero, random, go_to_goal, planner (with full knowledge of the scene), a policy or run folder, or FILE.onnx."""
    env_name: str | None = None
    """Environment whose robot is driven; default: that of the policy, else CocoNav."""
    robots: int = 1
    """Number of robots, 1 to 8, each with its own episode."""
    people: bool = False
    """With moving people and vehicles."""
    env_overrides: Mapping[str, Any] = dataclasses.field(default_factory=dict)
    """Flat dotted keys of the environment's config, such as the robot."""


class _Choices:
    """The scenes and policies that the page offers."""

    def __init__(self, scenes: ViewScenes, env_name: str | None, overrides: Mapping[str, Any]) -> None:
        self._scenes, self._env_name, self._overrides = scenes, env_name, overrides
        self._machines: dict[tuple[int, str, bool], Machine] = {}

    @property
    def scenes(self) -> list[str]:
        return self._scenes.names

    @property
    def policies(self) -> list[str]:
        """Scripted policies, and the policies that ship with a clone."""
        from .evaluation import SCRIPTED

        root = pathlib.Path("benchmarks/policies")
        return [*SCRIPTED, *(str(path.parent) for path in sorted(root.glob("*/policy.json")))]

    def cousins(self, scene: str) -> int:
        return self._scenes.cousins(scene)

    def open(self, scene: str, cousin: int, policy: str, people: bool) -> "tuple[Machine, int]":
        bank, row = self._scenes.open(scene, cousin)
        key = id(bank), policy, people
        if key not in self._machines:
            while len(self._machines) >= _KEPT:
                self._machines.pop(next(iter(self._machines)))
            self._machines[key] = load_machine(policy, bank, people, self._env_name, overrides=self._overrides)
        return self._machines[key], row


def view(
    scene: str | None = None,
    options: ViewOptions | None = None,
    on_ready: Callable[[str], None] = lambda _: None,
    until: Callable[[], bool] = lambda: False,
) -> None:
    """Serves the page until it is interrupted, which is the normal end: once the page can be opened, a
    `KeyboardInterrupt` closes it and returns; before that, it is raised.

    Args:
      scene: a shipped street, a scene of the built library, a graph.json, a compiled scene's folder or a bank;
        None for the first shipped street kept for tests.
      on_ready: called with the page's address once it can be opened.
      until: called between two frames; the page is closed when it returns True.

    Raises:
      ValidationError: no such scene or policy, or the port is in use.
    """
    import webbrowser

    from ..progress import Progress
    from ..viewer.front import served
    from ..viewer.page import Page
    from ..viewer.teleop import Teleop
    from .view_library import ViewLibrary

    options = options or ViewOptions()
    options.check()
    v.integer(options.robots, "--robots", 1, 8)
    settings.use_compilation_cache()
    scenes = ViewScenes([scene] if scene is not None else [])
    choices = _Choices(scenes, options.env_name, options.env_overrides)
    teleop = Teleop(options.give_back_after)
    # Started first, so that a port in use is detected before loading scenes.
    with served(options.host, options.port, teleop) as (server, front):
        name = scenes.first[0] if scenes.first else scenes.names[0]
        scenes.open(name)  # compiles what is missing, with a report of its own
        with Progress() as progress:
            progress.task("opening", 1, unit="streets", note="preparing the page")
            page = Page(server, choices, name, options.policy, options.robots, options.people, teleop)
        front.show(page)
        front.library = ViewLibrary(scenes, page.open_scene).answer
        with contextlib.suppress(KeyboardInterrupt):
            on_ready(front.address)
            if options.open:
                webbrowser.open(front.address)
            page.run(until)
