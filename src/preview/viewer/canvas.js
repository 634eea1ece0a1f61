// Layers -> pixels by canvas 2D, where there is no WebGL 2 or only a processor that does its work slowly.

class CanvasPainter {
  constructor(canvas) {
    this.canvas = canvas;
    this.front = canvas.getContext("2d");
    /** Lower layers have a picture of their own, which lasts until the view changes. */
    this.behind = document.createElement("canvas").getContext("2d");
    this.behindKey = "";
  }

  get mostBehind() {
    return 20_000;
  }

  forget() {
    this.behindKey = "";
  }

  /** As that of WebglPainter. */
  draw({ view, layer, count, below, paper, fade, instancesOf }) {
    const { width, height } = this.canvas;
    const key = [view.x, view.y, view.scale, width, height, below].join();
    if (key !== this.behindKey) {
      Object.assign(this.behind.canvas, { width, height });
      this.begin(this.behind, view);
      const faded = (rgb) => mixed(rgb, paper, fade);
      for (const lower of below) this.drawLayer(instancesOf(lower), Infinity, false, view.scale, faded);
    }
    this.behindKey = key;
    this.begin(this.front, view);
    const floats = instancesOf(layer);
    for (const thin of [false, true]) this.drawLayer(floats, count, thin, view.scale, (rgb) => rgb);
  }

  /** Takes up a context, cleared, and lets it measure in mm. */
  begin(context, { x, y, scale }) {
    const { width, height } = this.canvas;
    this.context = context;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, width, height);
    if (context === this.front) context.drawImage(this.behind.canvas, 0, 0);
    context.setTransform(scale, 0, 0, -scale, width / 2 - x * scale, height / 2 + y * scale);
    context.lineCap = context.lineJoin = "round";
  }

  /** Neighbours that look the same are one path. */
  drawLayer(floats, count, thin, scale, shade) {
    const { context } = this;
    const colours = new Uint8Array(floats.buffer);
    const inks = new Uint32Array(floats.buffer);
    const end = Math.min(count, floats.length / INSTANCE);
    let [first, width, ink] = [0, 0, 0];
    const stroke = () => {
      if (ink === 0) return;
      const at = 4 * (INSTANCE * first + 5);
      this.strokePath(shade([...colours.subarray(at, at + 3)]), thin ? -width / scale : width, thin);
    };
    context.beginPath();
    for (let i = 0; i < end; i++) {
      const at = INSTANCE * i;
      const own = floats[at + 4];
      if (inks[at + 5] === 0 || own < 0 !== thin) continue;
      if (own !== width || inks[at + 5] !== ink) {
        stroke();
        context.beginPath();
        [first, width, ink] = [i, own, inks[at + 5]];
      }
      context.moveTo(floats[at], floats[at + 1]);
      context.lineTo(floats[at + 2], floats[at + 3]);
    }
    stroke();
  }

  /** Lines have a darker edge, so that neighbours can be distinguished. */
  strokePath(rgb, width, thin) {
    const { context } = this;
    const rings = thin ? [[rgb, width]] : [[mixed(rgb, [0, 0, 0], 0.2), width], [rgb, 0.75 * width]];
    for (const [colour, wide] of rings) {
      context.strokeStyle = hexOf(colour);
      context.lineWidth = wide;
      context.stroke();
    }
  }
}
