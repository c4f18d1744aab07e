"""`ScenePlaces`: scenes of a folder that come and go while a training runs.

In:   an environment on a `PlacedBank`. Out: other scenes in its places, between two iterations of a trainer.
When: every `schedule.exchange_steps` env-steps; the next scenes are prepared by a process and copied to the device
ahead of that, a few megabytes at a time.

Which scene is in which place follows from the seed and the env-steps (`PlacedBank.coming`), so that nothing has to be
stored for a training that is resumed.
"""

import concurrent.futures
import concurrent.futures.process
import contextlib
import os
import pathlib
import time
from collections.abc import Callable, Iterator
from typing import Any, Self

import jax
import jax.numpy as jnp
import numpy as np

from ... import settings
from ...datatypes import PlacedBank, ValidationError
from ...process_pool import results_in_order, worker_pool, workers_for
from ...work_folder import work_folder
from .env import NavEnv
from .place_scenes import Recipe, load, prepare

#: Scenes that are prepared ahead, each in a file of its own.
_AHEAD = 2
#: Cores from which on they are prepared at the same time, by processes of 1 to 2 GB each.
_CORES_FOR_TWO = 8
#: Share of the time in which scenes are copied to the device ahead of their exchange.
_SHARE = 0.004
#: What a training waits for, see `ScenePlaces.spent`.
_SPENT = ("wait", "copy", "exchange", "begin")
#: Added to the niceness of the process that prepares scenes.
_NICENESS = 10


def spread_steps(bank: PlacedBank, steps: int, each: int) -> int:
    """The env-steps from one exchange to the next with which every scene comes once in a training of `steps` env-steps,
    or as few as iterations of `each` env-steps allow."""
    return max(steps // (len(bank.rows) - bank.num_scenes + 1), -(-each // bank.num_scenes), 1)


#: Function (state of a trainer, (N,) bool) -> the state in which envs of these places begin new episodes.
ResetGone = Callable[[Any, jax.Array], Any]


class ScenePlaces:
    """Exchanges the scenes of an environment; a context, which ends the process that prepares them.

    Args:
      env: on a `PlacedBank`, with the engine `warp-fused`. Its places are empty until `begin`.
      exchange_steps: env-steps from one exchange to the next.
      folder: for the files of prepared scenes; None for the system's folder of temporary files.

    Attributes:
      spent: s since `begin` in which a training waited: for the process that prepares scenes ("wait"), for copies to
        the device ahead of an exchange ("copy"), for what was left of them and the exchange itself ("exchange"), and
        for new episodes ("begin").
      prepared: s that the process took for each scene since `begin`.
      exchanges: number of them since `begin`.

    Raises:
      ValidationError: exchange_steps is below one, or the environment's scenes stay.
    """

    def __init__(self, env: NavEnv, exchange_steps: int, folder: pathlib.Path | None = None) -> None:
        if env.held is None or not isinstance(env.bank, PlacedBank):
            raise ValidationError("env: found one whose scenes stay; needed one on a PlacedBank.")
        if exchange_steps < 1:
            raise ValidationError(
                f"config.schedule.exchange_steps: found {exchange_steps}, needed the env-steps from one exchange of a "
                "scene to the next, 1 or more."
            )
        self.env, self.bank, self._held = env, env.bank, env.held
        self._steps, self._parent = int(exchange_steps), folder
        engine: Any = env.engine
        renderer: Any = env.renderer
        self._recipe = Recipe(
            str(self.bank.folder.path.absolute()),
            env.robot.planner_height,
            bool(engine.materials),
            None if renderer is None else renderer.settings,
            jax.default_backend() == "cpu",
        )
        self.spent = dict.fromkeys(_SPENT, 0.0)
        self.prepared: list[float] = []
        self.exchanges = 0
        self._put = jax.jit(_put_row, donate_argnums=0)
        self._coming: dict[int, concurrent.futures.Future[float]] = {}
        self._staging: Iterator[None] | None = None
        self._ready: dict[int, Callable[[], None]] = {}
        self._allowed, self._since, self._cold = 0.0, time.monotonic(), True

    def __enter__(self) -> Self:
        self._stack = contextlib.ExitStack()
        self._folder = self._stack.enter_context(work_folder("urbanverse-places-", self._parent))
        workers = 1 if settings.num_threads() < _CORES_FOR_TWO else _AHEAD
        self._pool = worker_pool(workers, _NICENESS, settings.use_processor_alone)
        self._stack.callback(self._pool.shutdown, wait=True, cancel_futures=True)
        self.env.places = self
        return self

    def __exit__(self, *error: object) -> None:
        self.env.places = None
        self._ready.clear()
        self._staging = None
        self._stack.close()

    def exchanged(self, steps: int) -> int:
        """Number of exchanges in the first env-steps of a training."""
        return max(steps, 0) // self._steps

    def begin(self, steps: int, each: int) -> None:
        """Fills all places as they are before the iteration of `each` env-steps that begins after `steps`."""
        if each > self._steps * self.bank.num_scenes:
            raise ValidationError(
                f"config.schedule.exchange_steps: found {self._steps} with iterations of {each} env-steps, needed at "
                f"least {-(-each // self.bank.num_scenes)}, so that a scene stays for one; take more, or more places."
            )
        done = self.exchanged(steps - each)
        present = self.bank.present(done)
        workers = workers_for(len(present), settings.num_threads())
        paths = [self._folder / f"first-{place}" for place in range(len(present))]
        tasks = [(self._recipe, row, str(path)) for row, path in zip(present, paths, strict=True)]
        for place, _ in enumerate(results_in_order(prepare, tasks, workers, settings.use_processor_alone)):
            for _ in self._stage(place, place, paths[place]):
                pass
            self._ready.pop(place)()
        self._next = done + 1
        self._cold = True
        self.restart_clock()
        self._order_next()

    def restart_clock(self) -> None:
        """Counts exchanges and the time that they take from now on."""
        self.exchanges, self.spent, self.prepared = 0, dict.fromkeys(_SPENT, 0.0), []
        self._begun = self._since = time.monotonic()

    def before(self, steps: int, state: Any, reset_gone: ResetGone) -> Any:
        """Makes the exchanges that are due after some env-steps, or a part of the way to the next one.

        Args:
          steps: done so far.
          state: of the trainer.
          reset_gone: gives the state in which the envs of changed places begin new episodes.
        """
        jax.block_until_ready(state)
        if self._cold:
            # Compiles the program, which changes nothing here.
            state = reset_gone(state, jnp.asarray(np.zeros(self.bank.num_scenes, bool)))
            self._cold = False
            self._begun = self._since = time.monotonic()
        begin = time.monotonic()
        self._allowed += _SHARE * (begin - self._since)
        self._since = begin
        due = range(self._next, self.exchanged(steps) + 1)
        if len(due):
            state = self._exchange(due, state, reset_gone)
            self._allowed = 0.0
        else:
            self._go_on(begin)
            took = time.monotonic() - begin
            self._allowed -= took
            self.spent["copy"] += took
        return state

    def reported(self) -> dict[str, float]:
        """Metrics for the log: exchanges, and the share of the time since `begin` in which the training waited."""
        passed = max(time.monotonic() - self._begun, 1e-9)
        return {"places/exchanges": float(self.exchanges), "places/stalled": sum(self.spent.values()) / passed}

    def num_bytes(self) -> dict[str, int]:
        """Bytes on the device of all places: of physics, looks, textures (without their smaller copies) and tables."""
        engine: Any = self.env.engine
        renderer: Any = self.env.renderer
        looks, textures = (0, 0) if renderer is None else renderer.placed_bytes
        tables = sum(int(x.nbytes) for x in jax.tree.leaves(self._held.tables))
        return {"physics": engine.placed_bytes, "looks": looks, "textures": textures, "tables": tables}

    def _exchange(self, due: range, state: Any, reset_gone: ResetGone) -> Any:
        gone = np.zeros(self.bank.num_scenes, bool)
        begin, waited = time.monotonic(), self.spent["wait"]
        for number in due:
            while number not in self._ready:
                self._advance(number, wait=True)
            self._ready.pop(number)()
            gone[self._place_of(number)[0]] = True
            self._next = number + 1
            self.exchanges += 1
            self._order_next()
        middle = time.monotonic()
        self.spent["exchange"] += middle - begin - (self.spent["wait"] - waited)
        state = jax.block_until_ready(reset_gone(state, jnp.asarray(gone)))
        self.spent["begin"] += time.monotonic() - middle
        return state

    def _place_of(self, number: int) -> tuple[int, int]:
        """Place and row of the folder of the scene that an exchange brings."""
        return self.bank.coming(self.bank.num_scenes + number - 1)

    def _order_next(self) -> None:
        """Lets the process prepare what comes next."""
        self._coming = {number: job for number, job in self._coming.items() if number >= self._next}
        for number in range(self._next, self._next + _AHEAD):
            if number not in self._coming:
                row, path = self._place_of(number)[1], self._path_of(number)
                self._coming[number] = self._pool.submit(prepare, self._recipe, row, str(path))

    def _path_of(self, number: int) -> pathlib.Path:
        return self._folder / f"scene-{number}"

    def _go_on(self, begin: float) -> None:
        """Copies parts of the next scene to the device, in the share of the time that is allowed."""
        while self._next not in self._ready and time.monotonic() - begin < self._allowed:
            if not self._advance(self._next, wait=False):
                return

    def _advance(self, number: int, wait: bool) -> bool:
        """One step towards a scene on the device; False where its file is not there yet."""
        if self._staging is None:
            job = self._coming[number]
            if not wait and not job.done():
                return False
            begin = time.monotonic()
            self.prepared.append(_result(job))
            self.spent["wait"] += time.monotonic() - begin
            self._staging = self._stage(number, self._place_of(number)[0], self._path_of(number))
        if next(self._staging, self) is self:
            self._staging = None
        return True

    def _stage(self, number: int, place: int, path: pathlib.Path) -> Iterator[None]:
        """Copies a scene to the device in parts; then `_ready` has the function that puts it in its place."""
        scene, env = load(path), self.env
        os.unlink(path)
        engine: Any = env.engine
        parts = [(yield from engine.stage(place, scene["physics"]))]
        if env.renderer is not None:
            renderer: Any = env.renderer
            parts.append((yield from renderer.stage(place, scene["looks"])))

        def commit() -> None:
            for part in parts:
                part()
            self._held.replace(self._put(self._held.tables, place, scene["tables"]))

        self._ready[number] = commit


def _put_row(tables: Any, place: jax.Array, row: Any) -> Any:
    """Tables with another row of a place; row: with a leading axis of one."""
    return jax.tree.map(lambda table, one: table.at[place].set(one[0].astype(table.dtype)), tables, row)


def _result(job: concurrent.futures.Future[float]) -> float:
    try:
        return job.result()
    except concurrent.futures.process.BrokenProcessPool as error:
        raise ValidationError(
            "config.schedule.places: found that the process that prepares scenes ended by itself, needed it; if "
            "memory is short, take fewer places or envs."
        ) from error
