"""Page of `urbanverse record --teleop`, which shows given episodes one after another, each until its end."""

from collections.abc import Callable
from typing import Literal

import viser

from .drive_page import NOBODY, DrivePage
from .session import Session
from .teleop import Teleop


class RecordPage(DrivePage):
    """One page on a port.

    Args:
      server: viser's.
      teleop: lets a person take over.
    """

    _takes_held_keys = False  # an episode follows the last one by itself, in another street

    def __init__(self, server: viser.ViserServer, teleop: Teleop) -> None:
        super().__init__(server, teleop)
        self._wanted: Literal["again", "end"] | None = None
        self._note = ""
        self._restart.label = "Discard and begin again"
        self._order(self._end, lambda: self._want("end"))

    def drive(self, make: Callable[[], Session], note: str, until: Callable[[], bool]) -> Session | None:
        """Shows an episode until it ends; restarts it if the person discards it.

        Args:
          make: a session at the episode's beginning.
          note: shown on the page.
          until: called often; the recording ends when it returns True.

        Returns:
          the session, or None where the recording ends before it.
        """
        self._note = note
        while self._wanted != "end":
            going, self._wanted = self.playing, None
            session = make()
            self.begin(session)
            # A policy continues with the next episode; without one the next episode waits for a key.
            if going and session.machine.policy.name != NOBODY:
                self._run()
            self.run(lambda session=session: session.over or self._wanted is not None or until())
            # A click during the last step is about this episode.
            self._obey()
            if self._wanted != "again":
                return session if session.over else None
        return None

    def show_note(self, text: str, last: bool = False) -> None:
        """Shows a message while no episode runs.

        Args:
          last: the page ends with it, so that browsers keep it when the connection ends.
        """
        self._say(text)
        self.state = {**self.state, "mode": "policy", "who": text, "note": "", "last": last}

    def _tell(self) -> None:
        super()._tell()
        self.state["note"] = " · ".join(filter(None, (self._note, self.state["note"])))

    def _begin(self) -> None:
        self._want("again")

    def _want(self, what: Literal["again", "end"]) -> None:
        self._wanted = what

    def _build_choices(self, gui: viser.GuiApi) -> None:
        with gui.add_folder("Recording"):
            self._end = gui.add_button("End the recording", hint="Without the episode that is being driven.")
