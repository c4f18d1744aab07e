"""Episodes that a person drives in a web page, in the form in which policies drive them in batches."""

import contextlib
import time
import webbrowser
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

import jax
import numpy as np

from ... import table_arguments
from ...datatypes import RESULTS
from ...evaluation.agents import episode_data
from ...evaluation.rollouts import EpisodeSet
from ...viewer.front import served
from ...viewer.record_page import RecordPage
from ...viewer.session import Session
from ...viewer.teleop import Teleop
from .driving import Driven, Steps

if TYPE_CHECKING:
    from ...viewer.session import Machine
    from ..viewing import PageOptions

#: s for which the page says that the recording has ended.
_LAST_WORD = 0.5


class HandDrive:
    """Lets people drive episodes one after another; in place of `BatchDrive`.

    Args:
      machine: the environment, and the policy that drives while no person does.
      options: of the page.
      on_ready: called with the page's address once it can be opened.
      until: called often; the recording ends when it returns True.
    """

    def __init__(
        self,
        machine: "Machine",
        options: "PageOptions",
        on_ready: Callable[[str], None] = lambda _: None,
        until: Callable[[], bool] = lambda: False,
    ) -> None:
        self._machine, self._options, self._on_ready, self._until = machine, options, on_ready, until
        env = machine.env
        self._sensed = table_arguments.jit(jax.vmap(lambda nav: env.named_observations(nav, env.observe(nav))["state"]))

    def run(self, episodes: EpisodeSet, first: int = 0) -> Iterator[list[Driven]]:
        """Serves the page until all episodes from `first` on are driven, or the person ends the recording: with the
        page's button, or by a `KeyboardInterrupt` while an episode is shown, which drops that episode like the button.

        Yields:
          each episode as soon as it has ended, alone; the page waits meanwhile.

        Raises:
          ValidationError: the port is in use.
        """
        # Of all episodes together, so that they have one shape and the policy is compiled once.
        agent: Any = self._machine.policy.agent
        known = () if self._machine.policy.outside else episode_data(agent, episodes.scenes, episodes.episodes)
        teleop = Teleop(self._options.give_back_after)
        with served(self._options.host, self._options.port, teleop) as (server, front):
            page = RecordPage(server, teleop)
            front.show(page)
            shown = self._session(episodes, first, known)
            page.begin(shown)
            page.show_note("compiling the first step")
            self._on_ready(front.address)
            if self._options.open:
                webbrowser.open(front.address)
            shown.compile()
            for i in range(first, len(episodes)):
                note = f"episode {i + 1} of {len(episodes)}"
                done = None
                with contextlib.suppress(KeyboardInterrupt):
                    done = page.drive(lambda i=i: self._session(episodes, i, known), note, self._until)
                if done is None:
                    break
                page.show_note(f"writing {note}")
                yield [self._driven(done, episodes, i)]
            page.show_note("the recording has ended", last=True)
            time.sleep(_LAST_WORD)

    def _session(self, episodes: EpisodeSet, i: int, known: Any) -> Session:
        own = jax.tree.map(lambda x: x[i : i + 1], known)
        scene, row = int(episodes.scenes[i]), int(episodes.episodes[i])
        return Session(self._machine, scene, [row], keys=episodes.keys()[i : i + 1], known=own)

    def _driven(self, session: Session, episodes: EpisodeSet, i: int) -> Driven:
        assert episodes.seeds is not None
        steps = self._steps(session)
        return Driven(
            scene=session.scene,
            row=session.rows[0],
            seed=int(episodes.seeds[i]),
            steps=steps,
            result=RESULTS[int(steps.result[-1]) - 1],
            route_completion=float(np.clip(steps.route_share[-1], 0.0, 1.0)),
            by_hand=session.by_hand(len(session) - 1),
        )

    def _steps(self, session: Session) -> Steps:
        """The steps of the only robot, fields (T, ...)."""
        before, after = session.frames[:-1], session.frames[1:]
        sensed = np.concatenate([np.asarray(self._sensed(frame.nav)) for frame in before])
        agents = [self._machine.agents(frame.nav) for frame in before]

        def joined(*parts: Any) -> np.ndarray:
            return np.concatenate([np.asarray(part) for part in parts])

        def of(frames: list[Any], field: Callable[[Any], Any]) -> Any:
            return jax.tree.map(joined, *[field(frame.nav) for frame in frames])

        action = of(after, lambda nav: nav.last_action)
        length = np.maximum(of(after, lambda nav: nav.route_length), 1e-6)
        return Steps(
            running=np.ones(len(before), bool),
            goal=sensed[:, :2],
            proprio=sensed[:, 2:],
            action=action,
            answer=action,
            reward=joined(*(frame.reward for frame in after)),
            result=of(after, lambda nav: nav.result),
            hit=of(after, lambda nav: nav.sim.contacts.hit),
            xpos=of(before, lambda nav: nav.sim.xpos),
            xquat=of(before, lambda nav: nav.sim.xquat),
            agents=jax.tree.map(joined, *agents),
            bodies=of(before, lambda nav: nav.sim.bodies),
            appearance_seed=of(before, lambda nav: nav.appearance_seed),
            route_share=of(after, lambda nav: nav.route_done) / length,
            qvel=of(before, lambda nav: nav.sim.qvel),
            contacts=of(after, lambda nav: nav.sim.contacts),
        )
