"""The benchmark of the viewer's page: what it counts is what a page draws and what a server sends."""

import asyncio
import types
from typing import Any

import numpy as np
import pytest
from websockets.asyncio.server import ServerConnection

from benchmarks import viewing
from urbanverse_mjx.datatypes import ValidationError

#: Draws 12 triangles, 3 copies of 2, a line, 5 triangles and a point in each of three frames, in two callbacks that
#: take 20 ms and 5 ms, with an image of 64 x 32 and a target without mipmaps; then nothing. `painted` says whether the
#: point was drawn.
_PAGE = """data:text/html,<canvas id=c></canvas><script>
const gl = document.getElementById("c").getContext("webgl2");
const program = gl.createProgram();
const add = (kind, text) => {
  const shader = gl.createShader(kind);
  gl.shaderSource(shader, text);
  gl.compileShader(shader);
  gl.attachShader(program, shader);
};
add(gl.VERTEX_SHADER, "void main() { gl_Position = vec4(0, 0, 0, 1); gl_PointSize = 99.0; }");
add(gl.FRAGMENT_SHADER, "void main() { gl_FragColor = vec4(1); }");
gl.linkProgram(program);
gl.useProgram(program);
const spend = (ms) => { const end = performance.now() + ms; while (performance.now() < end); };
const texture = (levels) => {
  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  gl.texStorage2D(gl.TEXTURE_2D, levels, gl.RGBA8, 64, 32);
};
texture(7); texture(1);
let left = 3;
const draw = () => {
  gl.drawArrays(gl.TRIANGLES, 0, 36);
  gl.drawArraysInstanced(gl.TRIANGLES, 0, 6, 3);
  gl.drawArrays(gl.LINES, 0, 2);
  gl.drawElements(gl.TRIANGLES, 15, gl.UNSIGNED_SHORT, 0);
  gl.drawArrays(gl.POINTS, 0, 1);
  const pixel = new Uint8Array(4);
  gl.readPixels(gl.drawingBufferWidth / 2, gl.drawingBufferHeight / 2, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
  window.painted = pixel[0] === 255;
  spend(20);
  if (left -= 1) { requestAnimationFrame(draw); requestAnimationFrame(() => spend(5)); } else window.done = true;
};
requestAnimationFrame(draw); requestAnimationFrame(() => spend(5));
</script>"""


@pytest.mark.extended
@pytest.mark.parametrize("undrawn", [False, True])
def test_a_page_is_counted_as_it_draws(undrawn: bool) -> None:
    """Or as it would, where its drawing calls are left out."""
    try:
        with viewing.tab_of(software=True, window=False, size=(300, 200), undrawn=undrawn) as tab:
            tab.goto(_PAGE)
            tab.wait_for_function("window.done && window.drawn.frames.length === 3")
            found = tab.evaluate("window.drawn")
            assert tab.evaluate("window.painted") is not undrawn
    except ValidationError as error:
        pytest.skip(str(error))
    assert [row[1:3] for row in found["frames"]] == [[5, 12 + 3 * 2 + 5]] * 3
    assert min(row[3] for row in found["frames"]) >= 25.0, "both callbacks of a frame"
    times = np.array(found["frames"])[:, 0]
    assert (np.diff(times) > 0).all()
    # Seven levels, from 64 x 32 to 1 x 1.
    levels = [(64, 32), (32, 16), (16, 8), (8, 4), (4, 2), (2, 1), (1, 1)]
    assert (found["images"], found["bytes"]) == (1, 4 * sum(w * h for w, h in levels))
    assert "SwiftShader" in found["renderer"]


def test_figures_are_of_the_frames_within_the_time() -> None:
    figures = viewing.frame_figures([[0, 10, 100, 4.0], [16, 30, 300, 2.0], [33, 20, 500, 9.0]], 1.5)
    assert figures == {
        "frames": 3,
        "frames_per_s": 2.0,
        "draw_calls": 20,
        "triangles": 300,
        "scripts_ms": 4.0,
        "scripts_ms_95": 9.0,
    }
    assert set(viewing.frame_figures([], 2.0).values()) == {0}


def test_only_what_goes_to_viser_is_counted_and_it_still_arrives(monkeypatch: pytest.MonkeyPatch) -> None:
    arrived: list[Any] = []

    async def send(_: Any, message: Any) -> None:
        arrived.append(message)

    monkeypatch.setattr(ServerConnection, "send", send)
    sent = viewing.Sent()

    def say(path: str, message: bytes) -> None:
        connection = types.SimpleNamespace(request=types.SimpleNamespace(path=path))
        asyncio.run(ServerConnection.send(connection, message))  # type: ignore[arg-type]

    with sent.counted():
        say("/viser/", b"abc")
        say("/drive", b"state")
        say("/viser/?x", b"defgh")
    say("/viser/", b"after")
    assert (sent.messages, sent.bytes) == (2, 8)
    assert arrived == [b"abc", b"state", b"defgh", b"after"]


def test_bad_input_is_one_sentence(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    assert viewing.main(["no_such_scene"]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.startswith("scene: found no 'no_such_scene', needed a shipped street")
    assert said.err.count("\n") == 1
