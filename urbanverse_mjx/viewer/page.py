"""The page of `urbanverse view`: any episode of any scene, driven by any policy."""

from collections.abc import Sequence
from typing import Protocol

import viser

from .drive_page import DrivePage
from .session import Machine, Session
from .teleop import Teleop


class Choices(Protocol):
    """The choices of the page."""

    @property
    def scenes(self) -> Sequence[str]:
        """Names of scenes."""
        ...

    @property
    def policies(self) -> Sequence[str]:
        """Names or paths of policies."""
        ...

    def cousins(self, scene: str) -> int:
        """Returns the number of cousins of a scene."""
        ...

    def open(self, scene: str, cousin: int, policy: str, people: bool) -> tuple[Machine, int]:
        """Returns the environment with its policy, and the scene's row in its bank.

        Raises:
          ValidationError: no such scene, cousin or policy.
        """
        ...


class Page(DrivePage):
    """One page on a port.

    Args:
      server: viser's.
      choices: available scenes and policies.
      scene, policy: shown first.
      robots: number of robots at once.
      people: whether people and vehicles are present.
      teleop: lets a person take over the shown robot; None disables driving by hand.
    """

    def __init__(
        self,
        server: viser.ViserServer,
        choices: Choices,
        scene: str,
        policy: str,
        robots: int = 1,
        people: bool = False,
        teleop: Teleop | None = None,
    ) -> None:
        self._choices, self._first = choices, (scene, policy, robots, people)
        self._machine, self._row = choices.open(scene, 0, policy, people)
        super().__init__(server, teleop)
        self._order(self._which, lambda: self._go(self.index))
        self._order(self._opener, self._open)
        self._order(self._episode, self._begin)
        self._begin()

    def open_scene(self, name: str) -> None:
        """Opens a scene with the chosen policy, as its button does; from any thread."""

        def order() -> None:
            self._scene.value, self._cousin.value = name, 0
            self._open()

        self._orders.put(order)

    def _robot(self) -> int:
        return min(int(self._which.value) - 1, self.session.num_robots - 1)

    def _begin(self) -> None:
        """Begins a new session of the selection; the page shows its first frame."""
        bank = self._machine.env.bank
        number = int(bank.num_episodes[self._row])
        self._episode.max = max(1, number - 1)
        first = min(int(self._episode.value), number - 1)
        self._episode.value = first
        count = int(self._robots.value)
        self._which.max = max(2, count)
        self._which.disabled = count == 1
        self._which.value = min(int(self._which.value), count)
        rows = [(first + i) % number for i in range(min(count, number))]
        self.begin(Session(self._machine, self._row, rows))

    def _open(self) -> None:
        """Opens the chosen scene with the chosen policy."""
        self._pause()
        scene, policy = self._scene.value, self._path.value.strip() or self._policy.value
        self._work(f"opening {scene}", f"opening {scene}, driven by {policy}")
        cousin = min(int(self._cousin.value), self._choices.cousins(scene) - 1)
        self._machine, self._row = self._choices.open(scene, cousin, policy, self._people.value)
        self._begin()

    def _build_choices(self, gui: viser.GuiApi) -> None:
        choices, (scene, policy, robots, people) = self._choices, self._first
        with gui.add_folder("Choose"):
            self._scene = gui.add_dropdown("scene", list(choices.scenes), initial_value=scene)
            self._cousin = gui.add_number("cousin", 0, min=0, max=63, step=1, hint="Same places, other assets and sky.")
            self._episode = gui.add_slider("episode", 0, 1, 1, 0)
            names = list(dict.fromkeys([*choices.policies, policy]))
            self._policy = gui.add_dropdown("policy", names, initial_value=policy)
            self._path = gui.add_text("or a file", "", hint="A policy folder or an ONNX file; empty takes the list's.")
            self._people = gui.add_checkbox("people", people)
            self._robots = gui.add_slider("robots", 1, 8, 1, robots, hint="Each drives an episode of its own.")
            self._which = gui.add_slider("robot shown", 1, 2, 1, 1, disabled=True)
            self._opener = gui.add_button("Open")
