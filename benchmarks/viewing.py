"""Measures the page of `urbanverse view` in a browser: frames a second, what a frame draws, and what the server sends.

    urbanverse scene library craftbench && python -m benchmarks.viewing     # a street of 385 objects
    python -m benchmarks.viewing park_edge --software                       # a shipped street, on the processor
    python -m benchmarks.viewing park_edge --software --undrawn             # what the page's scripts take of a frame

Chromium opens the page as a user's does. While the drive is paused and the mouse orbits the camera, `orbit` counts the
frames that were drawn, the calls and triangles of each (medians, shadow maps included), and the milliseconds of the
page's scripts in a frame (median and 95th percentile). Scripts wait for a graphics card that is behind, so these are
the page's own only with `--undrawn`, which leaves out the drawing calls themselves: culling, sorting and the state of
the card remain, pixels and vertices do not. While the policy drives,
`drive` counts frames, control steps, and the messages and kilobytes that the page receives. `opened` is the time until
all meshes and textures are on the graphics card, with the bytes received until then and the images on the card (with
their mipmaps). `renderer` names what draws: with SwiftShader or llvmpipe in it the processor does, and frames a second
are no figure for a GPU. Nothing is drawn while nothing changes, so frames a second are at most those of the display.

The result is one JSON line, printed and appended to `--append`.
"""

import argparse
import contextlib
import json
import math
import pathlib
import re
import shutil
import statistics
import sys
import threading
import time
from collections.abc import Iterator
from typing import Any

from websockets.asyncio.server import ServerConnection

from urbanverse_mjx import pipeline
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.pipeline.view_scenes import ViewScenes
from urbanverse_mjx.settings import num_threads
from urbanverse_mjx.viewer.front import FRAME

#: Of CraftBench's scenes, the one with the most objects.
_SCENE = "08_commercial_street_bike_lane_dual_sidewalks"
_BROWSERS = ("chromium", "chromium-browser", "google-chrome", "chrome")
_SOFTWARE = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist")
#: s without a new image after which all are on the card, and between two looks.
_QUIET, _LOOK_EVERY = 5.0, 0.1
_DISTANCE = re.compile(r"([\d.]+) s · ")

#: Counts what a page draws, before its own scripts run: `window.drawn` in each frame of the page.
COUNTER = """
(() => {
  const drawn = window.drawn = {frames: [], images: 0, bytes: 0, renderer: ""};
  let calls = 0, triangles = 0, scripts = 0;
  const gl = WebGL2RenderingContext.prototype;
  const before = (name, count) => {
    const own = gl[name], kept = !(name.startsWith("draw") && window.undrawn);
    gl[name] = function (...args) { count(this, ...args); if (kept) return own.apply(this, args); };
  };
  const add = (mode, corners, copies = 1) => { calls += 1; if (mode === 4) triangles += corners / 3 * copies; };
  before("drawArrays", (_, mode, first, count) => add(mode, count));
  before("drawElements", (_, mode, count) => add(mode, count));
  before("drawRangeElements", (_, mode, start, end, count) => add(mode, count));
  before("drawArraysInstanced", (_, mode, first, count, copies) => add(mode, count, copies));
  before("drawElementsInstanced", (_, mode, count, type, offset, copies) => add(mode, count, copies));
  // RGBA8 and SRGB8_ALPHA8 with mipmaps are images; shadow maps and the like have none.
  before("texStorage2D", (context, target, levels, format, width, height) => {
    if (target !== 0x0de1 || levels < 2 || ![0x8058, 0x8c43].includes(format)) return;
    const named = context.getExtension("WEBGL_debug_renderer_info");
    if (named) drawn.renderer = context.getParameter(named.UNMASKED_RENDERER_WEBGL);
    drawn.images += 1;
    for (let level = 0; level < levels; level += 1) {
      drawn.bytes += 4 * Math.max(1, width >> level) * Math.max(1, height >> level);
    }
  });
  const ask = window.requestAnimationFrame.bind(window);
  window.requestAnimationFrame = (work) => ask((now) => {
    const start = performance.now();
    try { work(now); } finally { scripts += performance.now() - start; }
  });
  // Asked before the page's own callbacks of a frame, so that it sees all of the frame before.
  const tick = (now) => {
    if (calls) drawn.frames.push([now, calls, triangles, scripts]);
    calls = triangles = scripts = 0;
    ask(tick);
  };
  ask(tick);
})();
"""


class Sent:
    """Messages and bytes that a `Front` sends to viser's client."""

    def __init__(self) -> None:
        self.messages = self.bytes = 0

    @contextlib.contextmanager
    def counted(self) -> Iterator[None]:
        """Counts within the block."""
        own = ServerConnection.send

        async def send(connection: ServerConnection, message: Any, *args: Any, **kwargs: Any) -> None:
            if connection.request is not None and connection.request.path.startswith(FRAME):
                self.messages, self.bytes = self.messages + 1, self.bytes + len(message)
            await own(connection, message, *args, **kwargs)

        ServerConnection.send = send  # type: ignore[method-assign]
        try:
            yield
        finally:
            ServerConnection.send = own  # type: ignore[method-assign]


@contextlib.contextmanager
def tab_of(software: bool, window: bool, size: tuple[int, int], undrawn: bool = False) -> Iterator[Any]:
    """A tab of Chromium that counts what it draws; size: px, width and height; undrawn: without drawing it.

    Raises:
      ValidationError: no Chromium.
    """
    from playwright.sync_api import sync_playwright

    found = next(filter(None, map(shutil.which, _BROWSERS)), None)
    if found is None:
        raise ValidationError(
            f"browser: found none of {', '.join(_BROWSERS)} on the PATH, needed one; install Chromium."
        )
    arguments = ["--no-sandbox", *(_SOFTWARE if software else ())]
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=found, args=arguments, headless=not window)
        try:
            tab = chromium.new_page(viewport={"width": size[0], "height": size[1]})
            tab.set_default_timeout(300_000)
            tab.add_init_script(f"window.undrawn = {json.dumps(undrawn)};{COUNTER}")
            yield tab
        finally:
            chromium.close()


@contextlib.contextmanager
def page_of(scene: str, policy: str) -> Iterator[str]:
    """Runs `urbanverse view` in a thread; yields its address.

    Raises:
      ValidationError: as `pipeline.view`.
    """
    ready, done = threading.Event(), threading.Event()
    found: list[str] = []
    failed: list[ValidationError] = []

    def opened_at(address: str) -> None:
        found.append(address)
        ready.set()

    def run() -> None:
        options = pipeline.ViewOptions(policy=policy, port=0, open=False)
        try:
            pipeline.view(scene, options, opened_at, done.is_set)
        except ValidationError as error:
            failed.append(error)
        finally:
            ready.set()

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    ready.wait()
    if not found:
        thread.join()
        raise failed[0] if failed else RuntimeError("the page ended before it could be opened")
    try:
        yield found[0]
    finally:
        done.set()
        thread.join(60.0)


def drawn(tab: Any) -> dict[str, Any]:
    """What viser's frame of the tab has drawn so far, see `COUNTER`."""
    (frame,) = (frame for frame in tab.frames if FRAME in frame.url)
    return frame.evaluate("window.drawn")


def frame_figures(frames: list[list[float]], seconds: float) -> dict[str, Any]:
    """Figures of frames (ms, calls, triangles, ms of scripts) that were drawn within a time."""
    _, calls, triangles, scripts = zip(*frames, strict=True) if frames else ((), (0,), (0,), (0.0,))
    return {
        "frames": len(frames),
        "frames_per_s": round(len(frames) / seconds, 2),
        "draw_calls": int(statistics.median(calls)),
        "triangles": int(statistics.median(triangles)),
        "scripts_ms": round(statistics.median(scripts), 2),
        "scripts_ms_95": round(sorted(scripts)[math.ceil(0.95 * len(scripts)) - 1], 2),
    }


def opened(tab: Any, address: str, sent: Sent) -> dict[str, Any]:
    """Opens the page and waits until no image has come to the graphics card for `_QUIET` seconds."""
    start = time.monotonic()
    tab.goto(address)
    tab.frame_locator("#viser").get_by_role("button", name="Play").wait_for(timeout=300_000)
    # What came while the page was waited for is complete only now, at the earliest.
    before, state, changed = (), drawn(tab), time.monotonic()
    while time.monotonic() - changed < _QUIET or not state["images"]:
        time.sleep(_LOOK_EVERY)
        state = drawn(tab)
        if before != (now := (state["images"], sent.bytes)):
            before, changed = now, time.monotonic()
    return {
        "seconds": round(changed - start, 1),
        "megabytes": round(sent.bytes / 1e6, 2),
        "images": state["images"],
        "images_mib": round(state["bytes"] / 2**20, 1),
    }


def orbit(tab: Any, seconds: float) -> dict[str, Any]:
    """Turns the camera with the mouse for a time while nothing drives."""
    tab.mouse.move(300, 300)
    tab.mouse.down()
    before, start, moves = len(drawn(tab)["frames"]), time.monotonic(), 0
    while time.monotonic() - start < seconds:
        moves += 1
        tab.mouse.move(300 + 200 * math.sin(moves / 40), 300 + 30 * math.cos(moves / 40))
    frames, passed = drawn(tab)["frames"][before:], time.monotonic() - start
    tab.mouse.up()
    return frame_figures(frames, passed)


def drive(tab: Any, seconds: float, sent: Sent) -> dict[str, Any]:
    """Lets the policy drive for a time, after its first steps have been compiled."""
    inner = tab.frame_locator("#viser")
    status = inner.get_by_text(_DISTANCE).first

    def driven() -> float:
        """s of the simulation."""
        found = _DISTANCE.search(status.inner_text())
        return float(found[1]) if found else 0.0

    inner.get_by_role("button", name="Play").click()
    end = time.monotonic() + 600.0
    while driven() < 0.5:
        if time.monotonic() > end:
            raise ValidationError("drive: found no step within 600 s, needed the policy to drive.")
        time.sleep(_LOOK_EVERY)
    frames, was, start = len(drawn(tab)["frames"]), driven(), time.monotonic()
    messages, size = sent.messages, sent.bytes
    time.sleep(seconds)
    passed, simulated = time.monotonic() - start, driven() - was
    return {
        **frame_figures(drawn(tab)["frames"][frames:], passed),
        "simulated_s_per_s": round(simulated / passed, 2),
        "kilobytes_per_simulated_s": round((sent.bytes - size) / 1e3 / simulated, 1) if simulated else None,
        "messages_per_s": round((sent.messages - messages) / passed, 1),
        "kilobytes_per_s": round((sent.bytes - size) / 1e3 / passed, 1),
    }


def measured(args: argparse.Namespace) -> dict[str, Any]:
    """One row: the page of one scene.

    Raises:
      ValidationError: no such scene or policy, no Chromium, or a policy that does not drive.
    """
    scene = args.scene
    bank, row = ViewScenes([scene]).open(scene)
    sent = Sent()
    chromium = tab_of(args.software, args.window, args.size, args.undrawn)
    with sent.counted(), page_of(scene, args.policy) as address, chromium as tab:
        first = opened(tab, address, sent)
        return {
            "scene": scene,
            "objects": int((bank.slot_mesh[row] >= 0).sum()),
            "renderer": drawn(tab)["renderer"],
            "cores": num_threads(),
            "size": args.size,
            "undrawn": args.undrawn,
            "opened": first,
            "orbit": orbit(tab, args.seconds),
            "drive": drive(tab, args.seconds, sent),
        }


def main(argv: list[str] | None = None) -> int:
    """Measures one page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.viewing", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    add = parser.add_argument
    add("scene", nargs="?", default=_SCENE, help="as `urbanverse view` takes it")
    add("--policy", default="planner")
    add("--seconds", type=float, default=10.0, help="that each measurement lasts")
    add("--size", type=int, nargs=2, default=[1440, 900], metavar=("W", "H"), help="px of the page")
    add("--software", action="store_true", help="draw on the processor")
    add("--undrawn", action="store_true", help="count drawing calls without making them, for the time of scripts")
    add("--window", action="store_true", help="show the browser, which some machines need to use their GPU")
    add("--append", type=pathlib.Path, help="file to which the result is appended as a line")
    args = parser.parse_args(argv)
    try:
        row = measured(args)
    except ValidationError as error:
        print(error, file=sys.stderr)
        return 2
    print(json.dumps(row))
    if args.append:
        with args.append.open("a", encoding="utf-8") as out:
            out.write(json.dumps(row) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
