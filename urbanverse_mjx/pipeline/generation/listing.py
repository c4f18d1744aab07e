"""Lists the categories in a capture by an OpenAI-compatible vision endpoint (the paper uses GPT-4.1).

Every third frame is shown once, several in a request. Answers are kept in the cache, so that another run on the same
frames sends nothing.
"""

import base64
import dataclasses
import hashlib
import io
import json
import pathlib
import sys
from collections.abc import Callable, Sequence
from typing import Any

from PIL import Image

from ...assets.categories import ontology
from ...assets.importing.vision import VisionError, post
from ...datatypes import validation as v
from ...settings import VisionEndpoint, cache_dir

#: One frame of so many is shown, as in the paper; frames in a request; pixels of an image's longer side.
EVERY, PER_REQUEST, SIDE = 3, 8, 768
#: Tokens that an image of `SIDE` pixels counts for at most by OpenAI's tiles of 512 pixels (170 each, and 85).
TOKENS_PER_IMAGE = 85 + 4 * 170
LETTERS_PER_TOKEN = 4
ASK = """These frames are from one walk or drive through a street. Name every kind of object that stands, is parked or
moves in it. Answer with one JSON object with the single field "categories": a list of names, taken from this list
where one fits. Categories: {leaves}"""


@dataclasses.dataclass(frozen=True)
class Cost:
    """What a listing costs before it is made: requests and images to send, their bytes, and tokens by a rule of thumb;
    cached: requests whose answers are known."""

    requests: int
    images: int
    size: int
    tokens: int
    cached: int

    def sentence(self, endpoint: VisionEndpoint) -> str:
        """The cost for the user."""
        known = f"; {self.cached} answers are in the cache" if self.cached else ""
        if not self.requests:
            return f"{endpoint.model}: nothing to send{known}."
        return (
            f"{endpoint.model} at {endpoint.url}: {self.requests} requests with {self.images} images, "
            f"{self.size / 1e6:.1f} MB, about {self.tokens:,} tokens{known}."
        )


def _say(sentence: str) -> None:
    sys.stderr.write(f"{sentence}\n")
    sys.stderr.flush()


def list_categories(
    endpoint: VisionEndpoint, images: Sequence[pathlib.Path], say: Callable[[str], None] = _say
) -> list[str]:
    """Leaves of the ontology that the endpoint finds in every third image, those named most often first.

    Args:
      say: gets a sentence with the cost before anything is sent; by default it goes to standard error.

    Raises:
      VisionError: there is no answer, it is not JSON, or no answer names a leaf.
    """
    shown = list(images[EVERY // 2 :: EVERY] or images[:1])
    bodies = [
        request(endpoint.model, [_small(p) for p in shown[k : k + PER_REQUEST]])
        for k in range(0, len(shown), PER_REQUEST)
    ]
    say(cost_of(bodies, endpoint).sentence(endpoint))
    counts: dict[str, int] = {}
    for body in bodies:
        for leaf in _answered(endpoint, body):
            counts[leaf] = counts.get(leaf, 0) + 1
    if not counts:
        raise VisionError("the endpoint's answers name no category of the ontology")
    return sorted(counts, key=lambda leaf: -counts[leaf])


def cost_of(bodies: Sequence[dict[str, Any]], endpoint: VisionEndpoint) -> Cost:
    """The cost of requests, less those whose answers are in the cache."""
    new = [body for body in bodies if not _cached(endpoint, body).is_file()]
    texts = [body["messages"][0]["content"][0]["text"] for body in new]
    images = sum(len(body["messages"][0]["content"]) - 1 for body in new)
    tokens = images * TOKENS_PER_IMAGE + sum(map(len, texts)) // LETTERS_PER_TOKEN
    size = sum(len(json.dumps(body)) for body in new)
    return Cost(len(new), images, size, tokens, len(bodies) - len(new))


def _answered(endpoint: VisionEndpoint, body: dict[str, Any]) -> list[str]:
    """The leaves in the answer to a request, from the cache or the endpoint."""
    path = _cached(endpoint, body)
    if path.is_file():
        try:
            return [leaf for leaf in v.read_json(path, "answer")["leaves"] if leaf in ontology.categories()]
        except (v.ValidationError, KeyError, TypeError):
            path.unlink()  # cut off; it is asked again
    leaves = leaves_of(post(endpoint, body))
    path.parent.mkdir(parents=True, exist_ok=True)
    v.write_json(path, {"leaves": leaves})
    return leaves


def _cached(endpoint: VisionEndpoint, body: dict[str, Any]) -> pathlib.Path:
    digest = hashlib.sha256(json.dumps([endpoint.url, body], sort_keys=True).encode()).hexdigest()
    return cache_dir("vision") / f"{digest[:32]}.json"


def _small(path: pathlib.Path) -> bytes:
    """A frame as JPEG with at most `SIDE` pixels on its longer side."""
    with Image.open(path) as image:
        small = image.convert("RGB")
    small.thumbnail((SIDE, SIDE))
    body = io.BytesIO()
    small.save(body, "JPEG", quality=85)
    return body.getvalue()


def request(model: str, images: Sequence[bytes]) -> dict[str, Any]:
    """The request with JPEG images, in the format of OpenAI's chat completions."""
    content: list[dict[str, Any]] = [{"type": "text", "text": ASK.format(leaves=", ".join(ontology.categories()))}]
    for image in images:
        url = "data:image/jpeg;base64," + base64.b64encode(image).decode()
        content.append({"type": "image_url", "image_url": {"url": url}})
    return {
        "model": model,
        "temperature": 0,
        "response_format": {"type": "json_object"},
        "messages": [{"role": "user", "content": content}],
    }


def leaves_of(answer: Any) -> list[str]:
    """The leaves in an answer; other names are matched to the nearest leaf or skipped. A frame may show none.

    Raises:
      VisionError: see `list_categories`.
    """
    try:
        text = answer["choices"][0]["message"]["content"]
        named = json.loads(text[text.index("{") : text.rindex("}") + 1])["categories"]
    except (KeyError, IndexError, TypeError, ValueError, AttributeError, RecursionError) as error:
        raise VisionError("the endpoint's answer holds no JSON object with a list of categories") from error
    if not isinstance(named, list):
        raise VisionError("the endpoint's answer holds no JSON object with a list of categories")
    leaves: dict[str, None] = {}
    for name in map(str, named):
        try:
            leaves[ontology.guess_leaf(name)] = None
        except ontology.UnknownLabelError:
            continue
    return list(leaves)
