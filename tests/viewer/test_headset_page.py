"""Driving with a headset that is simulated in a real browser: what it shows, its controllers, browsers without one."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from PIL import Image

from tests.support.box_machine import box_machine
from tests.support.driven_page import DrivenPage, driven_page, speeds, wait
from urbanverse_mjx.datatypes import SceneBank

pytestmark = pytest.mark.slow
#: A view of 90 degrees at the origin that looks along -z, on a canvas of the page. `window.xr` is set by the test.
_HEADSET = """
window.xr = {supported: true, visibility: "visible", sources: [], pixels: null, wanted: false};
const identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
const [near, far] = [0.1, 100];
const view = {
  eye: "left", transform: {inverse: {matrix: new Float32Array(identity)}},
  projectionMatrix: new Float32Array(
    [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0, 2 * far * near / (near - far), 0]),
};
const button = (pressed) => ({pressed, touched: pressed, value: +pressed});
const source = ({axes, buttons}) => ({gamepad: {mapping: "xr-standard", axes, buttons: buttons.map(button)}});
class Session extends EventTarget {
  get inputSources() { return window.xr.sources.map(source); }
  get visibilityState() { return window.xr.visibility; }
  updateRenderState(state) { this.renderState = state; }
  async requestReferenceSpace(kind) { window.xr.space = kind; return {}; }
  async end() { this.ended = true; this.dispatchEvent(new Event("end")); }
  requestAnimationFrame(work) {
    requestAnimationFrame((time) => {
      if (this.ended) return;
      work(time, {getViewerPose: () => ({views: [view]})});
      if (!window.xr.wanted) return;
      const {gl} = this.renderState.baseLayer;
      const pixels = new Uint8Array(4 * 240 * 240);
      gl.readPixels(0, 0, 240, 240, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
      [window.xr.pixels, window.xr.wanted] = [[...pixels], false];
    });
  }
}
window.XRWebGLLayer = class {
  constructor(session, gl) {
    [this.gl, this.framebuffer] = [gl, null];
    [gl.canvas.width, gl.canvas.height] = [240, 240];
  }
  getViewport() { return {x: 0, y: 0, width: 240, height: 240}; }
};
const system = {
  isSessionSupported: async (mode) => mode === "immersive-vr" && window.xr.supported,
  requestSession: async () => {
    if (window.xr.fails) throw new Error("it is in use");
    return window.xr.session = new Session();
  },
};
Object.defineProperty(navigator, "xr", {configurable: true, get: () => window.xr.absent ? undefined : system});
"""


#: (36, 64, 3) what the robot's camera shows: one bright quarter, at the top left.
IMAGE = np.full((36, 64, 3), 40, np.uint8)
IMAGE[:18, :32] = 230, 180, 60


@pytest.fixture(scope="module")
def worn(small_bank: SceneBank) -> Iterator[DrivenPage]:
    """A page with a headset that is simulated, for which alone the image is drawn."""
    machine = box_machine(small_bank)
    machine.camera_image = lambda nav: IMAGE.copy()  # type: ignore[method-assign]
    script = f"if (window === top) {{ {_HEADSET} }}"
    with driven_page(machine, 0.0, script, (700, 500), with_image=False) as found:
        yield found


def pixels(tab: Any) -> np.ndarray:
    """(240, 240, 3) of the view in its next frame, the top row first."""
    tab.evaluate("window.xr.pixels = null; window.xr.wanted = true")
    tab.wait_for_function("window.xr.pixels !== null", timeout=60_000)
    return np.array(tab.evaluate("window.xr.pixels"), np.uint8).reshape(240, 240, 4)[::-1, :, :3]


def test_a_browser_without_a_headset_says_so(worn: DrivenPage) -> None:
    tab = worn[3]
    for state, said in (
        ("absent = true", "This browser has no WebXR"),
        ("supported = false", "The browser finds no headset"),
        ("fails = true", "The headset did not start: it is in use"),
    ):
        tab.evaluate(f"window.xr.{state}")
        tab.get_by_role("button", name="Headset").click()
        tab.get_by_text(said).wait_for(timeout=60_000)
        tab.evaluate("Object.assign(window.xr, {absent: false, supported: true, fails: false})")
    tab.evaluate("Object.defineProperty(window, 'isSecureContext', {configurable: true, value: false})")
    tab.evaluate("window.xr.absent = true")
    tab.get_by_role("button", name="Headset").click()
    tab.get_by_text("only on https or localhost").wait_for(timeout=60_000)
    tab.evaluate("delete window.isSecureContext; window.xr.absent = false")


def test_a_headset_shows_the_camera_and_its_controllers_drive(worn: DrivenPage) -> None:
    page, teleop, front, tab = worn
    assert page.image is None
    tab.get_by_role("button", name="Headset").click()
    tab.get_by_role("button", name="Leave the headset").wait_for(timeout=60_000)
    wait(lambda: page.image is not None)
    assert front.watched
    assert page.image is not None
    # 2 m away and 2.4 m wide, of the 4 m that the view shows there: 144 of 240 pixels.
    height = 81
    sharp = np.asarray(Image.fromarray(IMAGE).resize((144, height), Image.Resampling.BILINEAR)).astype(int)

    def off(other: np.ndarray) -> float:
        top = (240 - height) // 2
        return float(np.abs(pixels(tab)[top : top + height, 48:192] - other).mean())

    wait(lambda: off(sharp) < 6.0)
    assert min(off(sharp[:, ::-1]), off(sharp[::-1])) > 12.0, "upright, and no mirror image"
    seen = pixels(tab)
    assert seen[:60].max() < 20, "dark above the screen"
    assert (seen[120 + height // 2 :].max(2) > 120).sum() > 30, "a line of text below it"

    def hold(*axes: float, a: bool = False, trigger: bool = False) -> None:
        buttons = [trigger, False, False, False, a]
        tab.evaluate("held => { window.xr.sources = [{axes: [0, 0, 0, 0], buttons: []}, held]; }",
                     {"axes": [0, 0, *axes], "buttons": buttons})  # fmt: skip

    hold(0.0, -1.0)
    wait(lambda: any(b.inputs.axes == (0.0, -1.0) for b in list(teleop._browsers.values())))
    assert not teleop.held, "a stick alone takes over nothing"
    hold(0.0, -1.0, trigger=True)
    wait(lambda: any(b.inputs.axes == (0.0, -1.0) for b in list(teleop._browsers.values())))
    assert not teleop.held, "the trigger of a controller with A is no switch"
    hold(0.0, -1.0, a=True)
    wait(lambda: len(page.session) > 1 and bool(speeds(page)[-1, 0] > 1.9))
    first = page.image
    hold(0.6, 0.0)
    wait(lambda: bool(speeds(page)[-1, 1] < -0.1))
    assert speeds(page)[-1] == pytest.approx([0.0, -(0.6 - 0.15) / 0.85], abs=0.03)
    assert page.image is not first, "each frame is drawn for the headset"
    wait(lambda: teleop.latency is not None)
    # Taken off: nothing is held, and the robot stands.
    tab.evaluate("window.xr.visibility = 'hidden'")
    wait(lambda: bool(np.abs(speeds(page)[-1]).max() < 1e-6))
    assert teleop.held
    tab.evaluate("window.xr.visibility = 'visible'")
    wait(lambda: bool(speeds(page)[-1, 1] < -0.1))
    tab.get_by_role("button", name="Leave the headset").click()
    tab.get_by_role("button", name="Headset", exact=True).wait_for(timeout=60_000)
    wait(lambda: not front.watched)
    wait(lambda: bool(np.abs(speeds(page)[-1]).max() < 1e-6))
    # A trigger switches where a controller has no other button.
    tab.evaluate("window.xr.sources = []; window.xr.session = null")
    tab.get_by_role("button", name="Headset").click()
    wait(lambda: bool(tab.evaluate("window.xr.session !== null")))
    tab.evaluate("window.xr.sources = [{axes: [0, 0], buttons: [true]}]")
    wait(lambda: not teleop.held)
    tab.evaluate("window.xr.session.end()")
    tab.get_by_role("button", name="Headset", exact=True).wait_for(timeout=60_000)
