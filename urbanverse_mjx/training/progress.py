"""Progress of a training: a progress bar, a JSONL log and TensorBoard."""

import json
import pathlib
import time
from collections.abc import Mapping
from typing import Any

from tensorboardX import SummaryWriter

from ..progress import Progress

#: What behaviour cloning reports in place of episodes.
_ERROR = "training/error"


class TrainingLog:
    """Writes the metrics of Brax's progress callbacks to logs and the progress bar.

    Args:
      folder: run folder; `log.jsonl` and TensorBoard's event file go there.
      total: env-steps of the whole run.
      start: env-steps done by earlier segments.
      quiet: whether to print no progress on standard error.
    """

    def __init__(self, folder: pathlib.Path, total: int, start: int = 0, quiet: bool = False):
        self._start = start
        self._begin = time.monotonic()
        self._last: tuple[float, int] | None = None
        self.rates: list[tuple[int, float]] = []
        self._file = (folder / "log.jsonl").open("a", encoding="utf-8")
        self._board = SummaryWriter(str(folder))
        self._progress = Progress(quiet).start()
        self._report = self._progress.task("training", total, start, "steps", "compiling")

    @property
    def steps_per_second(self) -> float:
        """Median of the measured rates without the first, which includes the compilation."""
        values = sorted(rate for _, rate in self.rates)
        return values[len(values) // 2] if values else 0.0

    def __call__(self, step: int, metrics: Mapping[str, Any]) -> None:
        """`progress_fn` of `ppo.train`: episode metrics from inside an epoch, or totals after one; or what a learner
        that iterates reports."""
        done = self._start + int(step)
        now = time.monotonic()
        values = {name: float(value) for name, value in metrics.items()}
        inside = _ERROR in values or any(name.startswith("episode/") for name in values)
        if inside:
            values = {_tidy(name): value for name, value in values.items()}
            if self._last is not None and done > self._last[1]:
                rate = (done - self._last[1]) / max(now - self._last[0], 1e-9)
                self.rates.append((done, rate))
                values["steps_per_second"] = rate
                self._report(done, note=f"{rate:,.0f} steps/s, {_metrics_text(values)}")
            self._last = (now, done)
        record = {"step": done, "seconds": round(now - self._begin, 3), **values}
        self._file.write(json.dumps(record) + "\n")
        self._file.flush()
        for name, value in values.items():
            self._board.add_scalar(name, value, done)

    def close(self) -> None:
        self._progress.stop()
        self._file.close()
        self._board.close()


def _metrics_text(values: Mapping[str, float]) -> str:
    if "episode/success" in values:
        # Imitation logs counts of results and no route completion.
        known = {"success": "success", "hit": "hit", "route": "route_completion"}
        keys = {word: f"episode/{key}" for word, key in known.items()}
        return ", ".join(f"{word} {values[key]:.0%}" for word, key in keys.items() if key in values)
    if _ERROR in values:
        return f"mean error of actions {values[_ERROR]:.3f}"
    return f"return {values.get('episode/sum_reward', 0.0):.2f}, length {values.get('episode/length', 0.0):.0f}"


def _tidy(name: str) -> str:
    """Renames metrics; Brax logs both losses and episode sums under "episode/"."""
    loss = ("total_loss", "policy_loss", "v_loss", "entropy_loss", "kl_mean", "learning_rate")
    base = name.removeprefix("episode/")
    return f"training/{base}" if base in loss else name
