"""Base class of viewer pages: main loop, controls and the robot's camera; subclasses choose the episodes.

viser's callbacks run in separate threads and only queue requests; one loop (`DrivePage.run`) processes them.
"""

import contextlib
import queue
import threading
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import viser

from ..datatypes import ValidationError
from ..viz.video import CAPTIONS
from .recording import html_recording, set_initial_view
from .session import Session
from .stage import LAYERS, Stage, chase_view
from .street import StreetMeshes
from .teleop import Command, Teleop, status

#: Camera views while an episode runs.
VIEWS = ("behind the robot", "from above", "free")
SPEEDS = ("1x", "2x", "4x", "as fast as possible")
_FACTOR = {"1x": 1.0, "2x": 2.0, "4x": 4.0}
_IDLE_PAUSE = 0.02  # s
_ABOVE_HEIGHT = 28.0  # m, of the view from above
#: Name of the policy that stands still.
NOBODY = "zero"
#: px, least width of the robot's camera image on the page.
_WIDTH = 320
#: Name of the threads that compile a session ahead.
COMPILE = "compile"
_RELEASE = "release the key and press it again to take over"
_COMPILING = "compiling the simulation: about 30 s the first time, once for each policy and bank of streets"


def _compile_ahead(session: Session) -> None:
    """Compiles a session's step in a thread, so that the first step finds it ready while the page already answers.

    The thread is no daemon: a process must not end in the middle of a compilation, which ends it with a crash.
    """

    def compile_quietly() -> None:
        # The first step meets the same error, and shows it.
        with contextlib.suppress(ValidationError, OSError):
            session.compile()

    threading.Thread(target=compile_quietly, name=COMPILE).start()


class DrivePage:
    """One page on a port; `begin` shows the first session.

    Args:
      server: viser's.
      teleop: lets a person take over the shown robot; None disables driving by hand.
    """

    def __init__(self, server: viser.ViserServer, teleop: Teleop | None = None) -> None:
        self._server, self._teleop = server, teleop or Teleop()
        self._orders: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        self._stopped = self._held = self._ignores_key = self._was_watched = False
        self.playing = False
        self.index = 0
        #: State shown at the page's lower edge, see `teleop.html`.
        self.state: dict[str, Any] = {}
        #: (H, W, 3) u8 of the robot's camera in the shown frame, for a headset; None while nobody looks at it.
        self.image: np.ndarray | None = None
        #: Whether a headset shows it.
        self.watched: Callable[[], bool] = lambda: False
        self.session: Session
        self.stage: Stage
        self._build()
        self._connect()

    def begin(self, session: Session) -> None:
        """Shows the first frame of a session, paused unless a held key drives, see `_takes_held_keys`."""
        self.stage = Stage(self._server, session, StreetMeshes(session.machine.env.bank, session.scene))
        self.session = session
        for layer, box in self._layers.items():
            self.stage.switch(layer, box.value, 0)
        set_initial_view(self._server, session)
        self._pause()
        self._teleop.begin_episode(self._takes_held_keys)
        self._go(0)

    # For subclasses.

    #: Whether a key that is held when an episode begins drives the robot; else only one that is pressed afterwards.
    _takes_held_keys = True

    def _build_choices(self, gui: viser.GuiApi) -> None:
        """Adds a subclass's controls between the robot's camera and the layers."""

    def _begin(self) -> None:
        """Restarts the episode."""
        raise NotImplementedError

    def _robot(self) -> int:
        """Returns the index of the shown robot."""
        return 0

    # The loop.

    def run(self, until: Callable[[], bool] = lambda: False) -> None:
        """Processes the page's requests and runs the simulation until `stop` is called, or `until` returns True."""
        late = time.monotonic()
        prepared: Session | None = None
        while not (self._stopped or until()):
            self._obey()
            if prepared is not self.session:
                prepared = self.session
                _compile_ahead(prepared)
            self._notice_headset()
            command = self._command()
            # The simulation pauses while no browser is connected.
            if not self.playing or not self._server.get_clients():
                time.sleep(_IDLE_PAUSE)
                late = time.monotonic()
                continue
            self._tick(command)
            # Driving by hand runs in real time.
            factor = _FACTOR.get(self._speed.value) if command is None else 1.0
            if factor is not None:
                late = max(late + self.session.machine.env.dt / factor, time.monotonic() - 0.5)
                time.sleep(max(0.0, late - time.monotonic()))

    def stop(self) -> None:
        """Ends `run`."""
        self._stopped = True

    def _obey(self) -> None:
        while True:
            try:
                order = self._orders.get_nowait()
            except queue.Empty:
                return
            try:
                order()
            except (ValidationError, OSError) as error:
                self._refuse(error)

    def _notice_headset(self) -> None:
        """Draws the shown frame for a headset that has been put on."""
        watched = self.watched()
        if watched and not self._was_watched:
            self._look()
        self._was_watched = watched

    def _command(self) -> Command | None:
        """Returns the current command of a person; taking over starts the simulation, and returning control to no
        policy stops it."""
        if self.session.over:
            self._teleop.give_back()
        command = self._teleop.command(time.monotonic())
        ignores_key = self._teleop.ignores_key
        if (command is not None) != self._held:
            self._held = command is not None
            if self._held:
                self._go(len(self.session) - 1)
                self._run()
            elif not self._held and self.session.machine.policy.name == NOBODY:
                self._pause()
            self._tell()
        elif ignores_key != self._ignores_key:
            self._tell()
        self._ignores_key = ignores_key
        return command

    def _tell(self) -> None:
        """Updates the state shown at the page's lower edge."""
        session = self.session
        name = session.machine.policy.name
        policy = "nobody" if name == NOBODY else name
        who, note = f"{policy} drives", ""
        if session.over:
            who, note = "the episode has ended", f"{self._restart.label} repeats it"
        elif not self.playing:
            who, note = "paused", "W drives" if name == NOBODY else f"W takes over from {policy}"
        if self._teleop.ignores_key and not session.over:
            note = _RELEASE
        self.state = {
            "mode": "hand" if self._held else "policy",
            "who": "you drive" if self._held else who,
            "note": "" if self._held else note,
            **status(self._teleop, session.by_hand(self.index, self._robot()), self.session.machine.env.dt),
        }

    def _tick(self, command: Command | None = None) -> None:
        """Advances by one frame, an existing or a new one."""
        if self.index == len(self.session) - 1:
            if self.session.over:
                self._pause()
                return
            try:
                if len(self.session) == 1:
                    self._work("compiling the simulation", _COMPILING)
                    self.session.compile()
                    # Discards keys pressed before compilation.
                    self._teleop.forget()
                self.session.step({} if command is None else {self._robot(): self.session.machine.action_of(command)})
                self._teleop.applied(time.monotonic())
            except (ValidationError, OSError) as error:
                self._refuse(error)
                return
        self._go(self.index + 1)

    def _go(self, index: int) -> None:
        """Shows a frame."""
        self.index = int(np.clip(index, 0, len(self.session) - 1))
        with self._server.atomic():
            self.stage.show(self.index)
        self._time.max = max(1, len(self.session) - 1)
        self._time.value = self.index
        self._look()
        self._report()

    def _look(self) -> None:
        """Moves the browsers' cameras to the chosen view and updates the robot's camera image."""
        robot = self._robot()
        if self._view.value != VIEWS[2]:
            position, target = chase_view(self.session, self.index, robot)
            if self._view.value == VIEWS[1]:
                position = target + [-0.3 * _ABOVE_HEIGHT, 0.0, _ABOVE_HEIGHT]
            for client in self._server.get_clients().values():
                with client.atomic():
                    client.camera.position, client.camera.look_at = position, target
        drawn = self._sees.value or self.watched()
        self.image = image = self.session.camera_image(self.index, robot) if drawn else None
        self._image.visible = image is not None and self._sees.value
        if image is not None and self._sees.value:
            # Pixels are enlarged here, because browsers would blur them.
            times = -(-_WIDTH // image.shape[1])
            self._image.image = image.repeat(times, 0).repeat(times, 1)

    def _report(self) -> None:
        robot, session = self._robot(), self.session
        nav = session.frames[self.index].nav
        seconds = float(np.asarray(nav.steps)[robot]) * self.session.machine.env.dt
        away = float(np.asarray(nav.goal_distance)[robot])
        outcome = session.outcome(self.index, robot)
        done = float(np.asarray(nav.route_done)[robot] / max(float(np.asarray(nav.route_length)[robot]), 1e-6))
        how = "under way" if outcome is None else CAPTIONS[outcome]
        self._tell()
        self._say(f"{seconds:.1f} s · {away:.1f} m to the goal · {100 * done:.0f} % of the route · **{how}**")

    def _say(self, text: str) -> None:
        self._status.content = text

    def _work(self, who: str, text: str) -> None:
        """Shows what the page does while it answers nothing else; `_tell` ends it."""
        self._say(text)
        self.state = {**self.state, "who": who, "note": ""}

    def _refuse(self, error: Exception) -> None:
        """Pauses, and shows why a request failed; the page goes on with what it shows."""
        self._pause()
        place = f"{error.filename}: " if isinstance(error, OSError) and error.filename else ""
        text = f"{place}{error.strerror or error}." if isinstance(error, OSError) else str(error)
        self._say(f"**{text}**")

    # Requests.

    def _pause(self) -> None:
        self.playing, self._held = False, False
        self._teleop.give_back()
        self._play.label = "Play"
        self._tell()

    def _run(self) -> None:
        self.playing = True
        self._play.label = "Pause"
        self._tell()

    def _toggle(self) -> None:
        (self._pause if self.playing else self._run)()

    def _step(self) -> None:
        self._pause()
        self._tick()

    def _share(self, client: viser.ClientHandle | None) -> None:
        """Sends a recording of the drive so far to the browser that requested it."""
        if client is None:
            return
        self._work("writing the recording", "writing the recording")
        bank = self.session.machine.env.bank
        page = html_recording(self.session, StreetMeshes(bank, self.session.scene), self._shown())
        name = f"{bank.scene_ids[self.session.scene]}_{self.session.machine.policy.name}.html".replace("/", "-")
        client.send_file_download(name, page.encode(), save_immediately=True)
        self._report()

    def _shown(self) -> tuple[str, ...]:
        return tuple(layer for layer, box in self._layers.items() if box.value)

    # The page's parts.

    def _order(self, handle: Any, order: Callable[[], None]) -> None:
        """Queues a request when a person clicks or changes a control."""
        register = handle.on_click if hasattr(handle, "on_click") else handle.on_update

        @register
        def _(event: Any) -> None:
            if event.client is not None:
                self._orders.put(order)

    def _build(self) -> None:
        gui = self._server.gui
        gui.configure_theme(show_logo=False, show_share_button=False)
        gui.main_panel.dock_right()
        gui.set_panel_label("UrbanVerse")
        self._status = gui.add_markdown("")
        with gui.add_folder("Drive"):
            self._play = gui.add_button("Play")
            self._forward = gui.add_button("Step")
            self._restart = gui.add_button("Begin again")
            self._time = gui.add_slider("frame", 0, 1, 1, 0, hint="Step of the drive so far; Play continues from here.")
            self._speed = gui.add_dropdown("speed", SPEEDS)
            self._view = gui.add_dropdown("view", VIEWS)
            hint = "Seconds without a key after which the policy drives again; 0: only by T."
            self._after = gui.add_number("give back after", self._teleop.give_back_after, min=0, max=60, hint=hint)
        with gui.add_folder("Robot's camera"):
            self._sees = gui.add_checkbox("shown", True)
            self._image = gui.add_image(np.zeros((9, 16, 3), np.uint8))
        self._build_choices(gui)
        with gui.add_folder("Layers"):
            self._layers = {name: gui.add_checkbox(name, shown) for name, shown in LAYERS.items()}
        with gui.add_folder("Share"):
            self._sharer = gui.add_button("Save the drive as a page")

    def _connect(self) -> None:
        self._order(self._play, self._toggle)
        self._order(self._forward, self._step)
        self._order(self._restart, lambda: self._begin())
        self._order(self._time, lambda: self._scrub(int(self._time.value)))
        self._order(self._view, self._look)
        self._order(self._after, lambda: setattr(self._teleop, "give_back_after", float(self._after.value)))
        self._order(self._sees, self._look)
        for name, box in self._layers.items():
            self._order(box, lambda name=name, box=box: self.stage.switch(name, box.value, self.index))

        @self._sharer.on_click
        def _(event: viser.GuiEvent) -> None:
            self._orders.put(lambda: self._share(event.client))

        @self._server.on_client_connect
        def _(_: viser.ClientHandle) -> None:
            self._orders.put(self._look)

    def _scrub(self, index: int) -> None:
        self._pause()
        self._go(index)
