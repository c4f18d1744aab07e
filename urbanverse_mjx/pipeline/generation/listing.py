"""Lists the categories in a capture by an OpenAI-compatible vision endpoint (the paper uses GPT-4.1)."""

import base64
import json
import pathlib
from collections.abc import Sequence
from typing import Any

from ...assets.categories import ontology
from ...assets.importing.vision import VisionError, post
from ...settings import VisionEndpoint

#: Number of frames sent to the endpoint, evenly spaced over the capture.
FRAMES = 8
_ASK = """These frames are from one walk or drive through a street. Name every kind of object that stands, is parked or
moves in it. Answer with one JSON object with the single field "categories": a list of names, taken from this list
where one fits. Categories: {leaves}"""


def list_categories(endpoint: VisionEndpoint, images: Sequence[pathlib.Path]) -> list[str]:
    """Leaves of the ontology that the endpoint finds in some of the images, in its order.

    Raises:
      VisionError: there is no answer, it is not JSON, or it names no leaf.
    """
    step = max(1, len(images) // FRAMES)
    answer = post(endpoint, request(endpoint.model, [p.read_bytes() for p in images[step // 2 :: step][:FRAMES]]))
    return leaves_of(answer)


def request(model: str, images: Sequence[bytes]) -> dict[str, Any]:
    """The request with PNG images, in the format of OpenAI's chat completions."""
    content: list[dict[str, Any]] = [{"type": "text", "text": _ASK.format(leaves=", ".join(ontology.categories()))}]
    for image in images:
        url = "data:image/png;base64," + base64.b64encode(image).decode()
        content.append({"type": "image_url", "image_url": {"url": url}})
    return {
        "model": model,
        "temperature": 0,
        "response_format": {"type": "json_object"},
        "messages": [{"role": "user", "content": content}],
    }


def leaves_of(answer: Any) -> list[str]:
    """The leaves in an answer; other names are matched to the nearest leaf or skipped.

    Raises:
      VisionError: see `list_categories`.
    """
    try:
        text = answer["choices"][0]["message"]["content"]
        named = json.loads(text[text.index("{") : text.rindex("}") + 1])["categories"]
        names = [str(name) for name in named] if isinstance(named, list) else []
    except (KeyError, IndexError, TypeError, ValueError, AttributeError, RecursionError) as error:
        raise VisionError("the endpoint's answer holds no JSON object with a list of categories") from error
    leaves: dict[str, None] = {}
    for name in names:
        try:
            leaves[ontology.guess_leaf(name)] = None
        except ontology.UnknownLabelError:
            continue
    if not leaves:
        raise VisionError("the endpoint's answer names no category of the ontology")
    return list(leaves)
