"""Entry point of the process of one source of a batch: `python -m urbanverse_mjx.pipeline.generation.one_source JSON`.

Like `urbanverse gen`, it exits with status 2 and one sentence on standard error if the source is invalid.
"""

import dataclasses
import json
import sys
from collections.abc import Sequence

from ...process_pool import end_with_parent
from ..errors import refusal
from .executors import Job
from .stages import GenerationOptions, generate
from .video_options import VideoOptions


def argument(job: Job, parent: int) -> str:
    """The command line's argument for a job whose process is started by the process with the id `parent`."""
    options = dataclasses.asdict(job.options)
    return json.dumps({"source": str(job.source), "out": str(job.out), "options": options, "parent": parent})


def main(argv: Sequence[str]) -> int:
    """Makes the cousins of the argument's job."""
    asked = json.loads(argv[0])
    end_with_parent(asked["parent"])
    options = asked["options"]
    try:
        generate(
            asked["source"],
            asked["out"],
            GenerationOptions(**{**options, "video": VideoOptions(**options["video"])}),
        )
    except Exception as error:
        sentence = refusal(error)
        if sentence is None:
            raise
        sys.stderr.write(f"error: {sentence}\n")
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
