// Layers -> pixels by WebGL 2: each move is one instance of a capsule, a line with round ends.

/** Floats of an instance: where it begins and ends, its width, its colour in the bits of one. */
const INSTANCE = 6;

/** Instances that are kept in buffers. */
const MOST_UPLOADED = 2_000_000;

const VERTEX = `#version 300 es
precision highp float;
layout(location = 0) in vec4 ends;    // mm
layout(location = 1) in float width;  // mm; below 0: pixels
layout(location = 2) in vec4 colour;
uniform vec3 view;                    // middle in mm, pixels per mm
uniform vec2 size;                    // pixels
uniform bool thin;                    // whether what has a width in pixels is drawn, or the rest
out vec2 place;                       // pixels, along and across
flat out vec2 shape;                  // pixels: length, half the width
flat out vec4 ink;
void main() {
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  if (colour.a == 0.0 || (width < 0.0) != thin) return;
  vec2 from = (ends.xy - view.xy) * view.z;
  vec2 to = (ends.zw - view.xy) * view.z;
  float along = length(to - from);
  vec2 way = along > 0.0 ? (to - from) / along : vec2(1.0, 0.0);
  float radius = 0.5 * (thin ? -width : width * view.z);
  // A line finer than a pixel is drawn as wide as one, but fainter.
  float drawn = max(radius, 0.5);
  float beyond = drawn + 1.0;
  float u = float(gl_VertexID & 1);
  float v = float(gl_VertexID >> 1) * 2.0 - 1.0;
  place = vec2(mix(-beyond, along + beyond, u), v * beyond);
  shape = vec2(along, drawn);
  ink = vec4(colour.rgb, radius / drawn);
  gl_Position = vec4((from + way * place.x + vec2(-way.y, way.x) * place.y) * 2.0 / size, 0.0, 1.0);
}`;

const FRAGMENT = `#version 300 es
precision highp float;
in vec2 place;
flat in vec2 shape;
flat in vec4 ink;
uniform vec4 paper;   // colour and how much of it is mixed in
uniform vec2 depths;  // of the middle and of the edge of a line
out vec4 pixel;
void main() {
  float away = length(vec2(place.x - clamp(place.x, 0.0, shape.x), place.y));
  float cover = clamp(shape.y - away + 0.5, 0.0, 1.0);
  if (cover == 0.0) discard;
  // Where lines overlap, the one whose middle is nearer is on top: as beads that run into
  // each other, and pieces of a bend look like one line.
  float out_ = min(away / shape.y, 1.0);
  gl_FragDepth = mix(depths.x, depths.y, out_);
  // Round beads are darker at their edges, once they are wide enough to show it.
  float round_ = smoothstep(1.0, 3.0, shape.y);
  float light = mix(0.93, 1.06 - 0.38 * out_ * out_, round_);
  vec3 colour = mix(min(ink.rgb * light, 1.0), paper.rgb, paper.a);
  pixel = vec4(colour, 1.0) * cover * ink.a;
}`;

class WebglPainter {
  /** Throws where there is no WebGL 2, or, unless `forced`, only a slow one. */
  constructor(canvas, forced) {
    this.canvas = canvas;
    const options = { antialias: false, premultipliedAlpha: true, preserveDrawingBuffer: true };
    this.gl = canvas.getContext("webgl2", options);
    if (!this.gl) throw new Error("no WebGL 2");
    if (!forced && isSoftware(this.gl)) throw new Error("WebGL without a graphics card");
    this.prepare();
    canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
    canvas.addEventListener("webglcontextrestored", () => {
      this.prepare();
      restyle();
    });
  }

  prepare() {
    const { gl } = this;
    this.program = makeProgram(gl);
    this.places = {};
    for (const name of ["view", "size", "thin", "paper", "depths"]) {
      this.places[name] = gl.getUniformLocation(this.program, name);
    }
    this.uploaded = new Map();
    this.uploads = 0;
    this.behind = null;
    this.behindKey = "";
  }

  /** How many moves of lower layers are drawn at most. */
  get mostBehind() {
    return 400_000;
  }

  /** Forgets what was uploaded: colours have changed. */
  forget() {
    for (const { array, buffer } of this.uploaded.values()) {
      this.gl.deleteVertexArray(array);
      this.gl.deleteBuffer(buffer);
    }
    this.uploaded.clear();
    this.uploads = 0;
    this.behindKey = "";
  }

  /**
   * Draws the first `count` moves of a layer over the layers `below`, the lowest first.
   * `instancesOf(layer)` gives the floats of a layer.
   */
  draw({ view, layer, count, below, paper, fade, instancesOf }) {
    const { gl } = this;
    this.instancesOf = instancesOf;
    this.begin(view);
    const key = [view.x, view.y, view.scale, gl.canvas.width, gl.canvas.height, below, paper].join();
    if (key !== this.behindKey) this.drawBehind(below, paper, fade);
    this.behindKey = key;
    this.copyBehind();
    gl.enable(gl.DEPTH_TEST);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    this.fadeTo(paper, 0);
    gl.uniform2f(this.places.depths, 0, 1);
    this.drawLayer(layer, count, false);
    gl.disable(gl.DEPTH_TEST);
    this.drawLayer(layer, count, true);
  }

  begin(view) {
    const { gl, places } = this;
    const { width, height } = this.canvas;
    gl.viewport(0, 0, width, height);
    gl.useProgram(this.program);
    gl.uniform3f(places.view, view.x, view.y, view.scale);
    gl.uniform2f(places.size, width, height);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.depthFunc(gl.LEQUAL);
    gl.clearColor(0, 0, 0, 0);
  }

  fadeTo(paper, part) {
    this.gl.uniform4f(this.places.paper, paper[0] / 255, paper[1] / 255, paper[2] / 255, part);
  }

  /** Draws lower layers into a picture of their own, which lasts until the view changes. */
  drawBehind(below, paper, fade) {
    const { gl } = this;
    this.sizeBehind();
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.behind.frame);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    this.fadeTo(paper, fade);
    below.forEach((layer, k) => {
      const top = 1 - (k + 1) / below.length;
      gl.uniform2f(this.places.depths, top, top + 0.9 / below.length);
      this.drawLayer(layer, Infinity, false);
    });
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }

  sizeBehind() {
    const { gl, canvas } = this;
    const { width, height } = canvas;
    if (this.behind?.width === width && this.behind.height === height) return;
    if (this.behind) {
      gl.deleteFramebuffer(this.behind.frame);
      this.behind.stores.forEach((store) => gl.deleteRenderbuffer(store));
    }
    const frame = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    const store = (format, attachment) => {
      const made = gl.createRenderbuffer();
      gl.bindRenderbuffer(gl.RENDERBUFFER, made);
      gl.renderbufferStorage(gl.RENDERBUFFER, format, width, height);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, attachment, gl.RENDERBUFFER, made);
      return made;
    };
    const stores = [store(gl.RGBA8, gl.COLOR_ATTACHMENT0), store(gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT)];
    this.behind = { frame, stores, width, height };
  }

  copyBehind() {
    const { gl } = this;
    const { frame, width, height } = this.behind;
    gl.bindFramebuffer(gl.READ_FRAMEBUFFER, frame);
    gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, null);
    gl.blitFramebuffer(0, 0, width, height, 0, 0, width, height, gl.COLOR_BUFFER_BIT, gl.NEAREST);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }

  drawLayer(layer, count, thin) {
    const { gl } = this;
    const { array, instances } = this.uploadedLayer(layer);
    gl.uniform1i(this.places.thin, thin ? 1 : 0);
    gl.bindVertexArray(array);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, Math.min(count, instances));
    gl.bindVertexArray(null);
  }

  uploadedLayer(layer) {
    let found = this.uploaded.get(layer);
    if (!found) {
      if (this.uploads > MOST_UPLOADED) this.forget();
      found = uploadLayer(this.gl, this.instancesOf(layer));
      this.uploaded.set(layer, found);
      this.uploads += found.instances;
    }
    return found;
  }
}

/** Whether a processor does the work of a graphics card: then canvas 2D is faster. */
function isSoftware(gl) {
  const info = gl.getExtension("WEBGL_debug_renderer_info");
  const name = gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER);
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
}

function makeProgram(gl) {
  const program = gl.createProgram();
  for (const [kind, source] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  return program;
}

function uploadLayer(gl, floats) {
  const array = gl.createVertexArray();
  const buffer = gl.createBuffer();
  gl.bindVertexArray(array);
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  gl.bufferData(gl.ARRAY_BUFFER, floats, gl.STATIC_DRAW);
  const bytes = 4 * INSTANCE;
  gl.vertexAttribPointer(0, 4, gl.FLOAT, false, bytes, 0);
  gl.vertexAttribPointer(1, 1, gl.FLOAT, false, bytes, 16);
  gl.vertexAttribPointer(2, 4, gl.UNSIGNED_BYTE, true, bytes, 20);
  for (let place = 0; place < 3; place++) {
    gl.enableVertexAttribArray(place);
    gl.vertexAttribDivisor(place, 1);
  }
  gl.bindVertexArray(null);
  return { array, buffer, instances: floats.length / INSTANCE };
}
