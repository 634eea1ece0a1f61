// Layers -> pixels by canvas 2D, for browsers without WebGL 2: slower, and beads are flat.

class CanvasPainter {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
  }

  get mostBehind() {
    return 20_000;
  }

  forget() {}

  /** As that of WebglPainter. */
  draw({ view, layer, count, below, paper, fade, instancesOf }) {
    const { context, canvas } = this;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, canvas.width, canvas.height);
    const { x, y, scale } = view;
    context.setTransform(scale, 0, 0, -scale, canvas.width / 2 - x * scale, canvas.height / 2 + y * scale);
    context.lineCap = context.lineJoin = "round";
    const faded = (rgb) => mixed(rgb, paper, fade);
    for (const lower of below) this.drawLayer(instancesOf(lower), Infinity, false, scale, faded);
    const floats = instancesOf(layer);
    for (const thin of [false, true]) this.drawLayer(floats, count, thin, scale, (rgb) => rgb);
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

  /** Lines have a darker edge, so that neighbours are told apart. */
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
