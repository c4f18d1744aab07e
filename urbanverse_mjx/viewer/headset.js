"use strict";
// A headset (WebXR, https://www.w3.org/TR/webxr/): the robot's camera on a screen 2 m ahead, two lines of text below it,
// and the sticks and buttons of the controllers (https://www.w3.org/TR/webxr-gamepads-module-1/, "xr-standard").
// The rest of the world stays dark: a street that turns with the robot makes people sick, a screen does not.

const SCREEN = {distance: 2.0, width: 2.4, text: 0.22};  // m; the last is the height of two lines
const VERTEX = `
attribute vec2 corner;
uniform mat4 projection, view;
uniform vec4 place;
uniform float distance_;
varying vec2 at;
void main() {
  at = vec2(corner.x, 1.0 - corner.y);
  gl_Position = projection * view * vec4(place.xy + corner * place.zw, -distance_, 1.0);
}`;
const FRAGMENT = `
precision mediump float;
uniform sampler2D image;
varying vec2 at;
void main() { gl_FragColor = texture2D(image, at); }`;

/** Draws images on rectangles in space. */
class Panel {
  constructor(gl) {
    this.gl = gl;
    const program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.bindAttribLocation(program, 0, "corner");
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    this.program = program;
    this.at = (name) => gl.getUniformLocation(program, name);
    this.corners = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, this.corners);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array([0, 0, 1, 0, 0, 1, 1, 1]), gl.STATIC_DRAW);
  }

  /** A texture of an image of any size. */
  texture() {
    const gl = this.gl, made = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, made);
    for (const side of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, side, gl.CLAMP_TO_EDGE);
    for (const way of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, way, gl.LINEAR);
    return made;
  }

  fill(texture, image) {
    const gl = this.gl;
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, image);
  }

  begin(framebuffer) {
    const gl = this.gl;
    gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
    gl.clearColor(0.03, 0.035, 0.045, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.useProgram(this.program);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.corners);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 2, gl.FLOAT, false, 0, 0);
    gl.uniform1f(this.at("distance_"), SCREEN.distance);
  }

  /** view: of the headset; place: left, bottom, width, height in m. */
  draw(view, texture, place) {
    const gl = this.gl;
    gl.uniformMatrix4fv(this.at("projection"), false, view.projectionMatrix);
    gl.uniformMatrix4fv(this.at("view"), false, view.transform.inverse.matrix);
    gl.uniform4fv(this.at("place"), place);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
  }
}

/** The stick that is pushed farthest, and whether A, X, or the trigger of a controller without them, is held. */
function controllers(session) {
  const held = {axes: [0, 0], buttons: [false]};
  if (session.visibilityState !== "visible") return {axes: [], buttons: []};  // taken off, or in the headset's menu
  for (const source of session.inputSources) {
    const pad = source.gamepad;
    if (!pad) continue;
    const first = pad.axes.length >= 4 ? 2 : 0;  // a thumbstick after a touchpad
    const stick = [pad.axes[first] || 0, pad.axes[first + 1] || 0];
    if (Math.hypot(...stick) > Math.hypot(...held.axes)) held.axes = stick;
    const button = pad.buttons[4] || pad.buttons[0];
    held.buttons[0] ||= Boolean(button && button.pressed);
  }
  return held;
}

/** Why this browser shows no headset, as a sentence; "" where it does. */
async function withoutHeadset() {
  if (!navigator.xr && !window.isSecureContext) {
    return "Browsers allow headsets (WebXR) only on https or localhost: forward the port to the device that shows the "
      + "page, and open http://localhost there.";
  }
  if (!navigator.xr) return "This browser has no WebXR: open the page in the browser of the headset, or in Chrome or Edge.";
  if (await navigator.xr.isSessionSupported("immersive-vr")) return "";
  return "The browser finds no headset: connect one, or open the page in the browser of the headset.";
}

/**
 * Shows the camera in the headset until the person leaves it; returns the session, or null where it has ended already.
 *
 * camera: address of the socket that sends JPEGs; lines(): text below the screen; hold({axes, buttons}, time): what the
 * controllers hold, in every frame, time in ms since the page began; leave(): the session has ended.
 */
async function wear({camera, lines, hold, leave}) {
  const session = await navigator.xr.requestSession("immersive-vr");
  let ended = false;
  session.addEventListener("end", () => { ended = true; leave(); });
  try {
    await present({session, camera, lines, hold});
  } catch (error) {
    session.end();
    throw error;
  }
  return ended ? null : session;
}

/** Draws and reads in every frame of a session until its end. */
async function present({session, camera, lines, hold}) {
  const gl = document.createElement("canvas").getContext("webgl", {xrCompatible: true});
  const screen = new Panel(gl), seen = screen.texture(), said = screen.texture();
  const paper = Object.assign(document.createElement("canvas"), {width: 1536, height: 140});
  const pen = paper.getContext("2d");
  let image = null, shape = 16 / 9, written = null, shown = false;

  const socket = new WebSocket(camera);
  socket.onmessage = async ({data}) => { image = await createImageBitmap(data); };
  session.addEventListener("end", () => socket.close());
  session.updateRenderState({baseLayer: new XRWebGLLayer(session, gl)});
  const space = await session.requestReferenceSpace("local");

  function write(text) {
    pen.fillStyle = "#14171c";
    pen.fillRect(0, 0, paper.width, paper.height);
    pen.fillStyle = "#d7dbe2";
    pen.font = "40px system-ui, sans-serif";
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    text.split("\n").forEach((part, k) => pen.fillText(part, paper.width / 2, 40 + 60 * k, paper.width - 40));
    screen.fill(said, paper);
  }
  function frame(time, now) {
    session.requestAnimationFrame(frame);
    hold(controllers(session), time);
    const pose = now.getViewerPose(space), layer = session.renderState.baseLayer;
    if (!pose) return;
    if (image) {
      screen.fill(seen, image);
      shape = image.width / image.height;
      image.close();
      [image, shown] = [null, true];
    }
    if (lines() !== written) write(written = lines());
    screen.begin(layer.framebuffer);
    const height = SCREEN.width / shape;
    for (const view of pose.views) {
      const at = layer.getViewport(view);
      gl.viewport(at.x, at.y, at.width, at.height);
      if (shown) screen.draw(view, seen, [-SCREEN.width / 2, -height / 2, SCREEN.width, height]);
      screen.draw(view, said, [-SCREEN.width / 2, -height / 2 - 1.1 * SCREEN.text, SCREEN.width, SCREEN.text]);
    }
  }
  session.requestAnimationFrame(frame);
}
