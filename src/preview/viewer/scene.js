// Page's data -> layers that are unpacked when they are looked at, and drawn.

/** Moves that are kept unpacked. */
const MOST_UNPACKED = 1_500_000;

/** Pixels: how wide travels and marks of retractions are. */
const TRAVEL_WIDTH = 1.3;
const RETRACTION_WIDTH = 6;

/** How much of the paper's colour is in lower layers. */
const FADE = 0.72;

class Scene {
  /** `bytes` are the inflated moves. */
  constructor(bytes, canvas) {
    this.bytes = bytes;
    this.blocks = findBlocks(bytes);
    this.unpacked = new Map();
    this.unpackedMoves = 0;
    this.side = "top";
    this.painter = makePainter(canvas);
  }

  /** Number of stages; block 0 is what comes before the first. */
  get layers() {
    return this.blocks.length - 1;
  }

  countOf(layer) {
    return this.blocks[layer].count;
  }

  movesOf(layer) {
    let moves = this.unpacked.get(layer);
    if (!moves) {
      if (this.unpackedMoves > MOST_UNPACKED) {
        this.unpacked.clear();
        this.unpackedMoves = 0;
      }
      moves = unpackBlock(this.bytes, this.blocks[layer]);
      this.unpacked.set(layer, moves);
      this.unpackedMoves += moves.count;
    }
    return moves;
  }

  /** Colours, what is hidden or the side that is looked at have changed. */
  restyle({ colour, hidden, side }) {
    this.side = side;
    this.palette = rolePalette();
    this.paper = rgbOf(themeColour("paper"));
    this.mode = colour;
    this.colourOf = colouring(colour, this.palette);
    this.hidden = hidden;
    this.painter.forget();
  }

  draw(view, layer, count, withBelow) {
    this.painter.draw({
      view,
      layer,
      count: this.instancesUpTo(layer, count),
      below: withBelow ? this.layersBelow(layer) : [],
      paper: this.paper,
      fade: FADE,
      instancesOf: (one) => this.instancesOf(one),
    });
  }

  /** As many as can be drawn, the lowest first. */
  layersBelow(layer) {
    const below = [];
    // From above the highest hide the others, from a side they do not.
    let left = this.painter.mostBehind * (this.side === "top" ? 1 : 5);
    for (let lower = layer - 1; lower >= 1 && left > 0; lower--) {
      left -= this.countOf(lower);
      if (left > 0) below.unshift(lower);
    }
    return below;
  }

  /** How many instances the first `count` moves of a layer are: one each, but for those that are cut. */
  instancesUpTo(layer, count) {
    const moves = this.movesOf(layer);
    if (this.mode !== "z") return Math.min(count, moves.count);
    let sum = 0;
    for (let i = 0; i < Math.min(count, moves.count); i++) sum += piecesOf(this.mode, moves, i);
    return sum;
  }

  /** What a painter needs of a layer: see INSTANCE. */
  instancesOf(layer) {
    const moves = this.movesOf(layer);
    const floats = new Float32Array(INSTANCE * this.instancesUpTo(layer, Infinity));
    const inks = new Uint8Array(floats.buffer);
    let at = 0;
    for (let i = 0; i < moves.count; i++) {
      const pieces = piecesOf(this.mode, moves, i);
      const [[fromX, fromY], [toX, toY]] = this.endsOf(moves, i);
      const isHidden = this.hidden.has(roleOf(moves, i));
      for (let k = 0; k < pieces; k++, at += INSTANCE) {
        for (const [place, part] of [[0, k / pieces], [2, (k + 1) / pieces]]) {
          floats[at + place] = fromX + (toX - fromX) * part;
          floats[at + place + 1] = fromY + (toY - fromY) * part;
        }
        floats[at + 4] = this.widthOf(moves, i);
        if (isHidden) continue;
        inks.set(this.colourOf(moves, i, layer, (k + 0.5) / pieces), 4 * (at + 5));
        inks[4 * (at + 5) + 3] = 255;
      }
    }
    return floats;
  }

  /** Where a move begins and ends on the side that is looked at, mm: the middle of a line, from above its top. */
  endsOf(moves, i) {
    const [across, up] = SIDES[this.side];
    const sunk = up === "z" && isLine(moves, i) ? moves.height[i] / 2 : 0;
    return ["from", "to"].map((end) => [moves[across][end][i], moves[up][end][i] - sunk]);
  }

  /** How wide a line looks, mm; 0 for what is none. */
  thicknessOf(moves, i) {
    return this.side === "top" ? moves.width[i] : moves.height[i];
  }

  /** mm; below 0 in pixels. */
  widthOf(moves, i) {
    if (isLine(moves, i)) return this.thicknessOf(moves, i);
    return -devicePixelRatio * (roleOf(moves, i) === RETRACTION ? RETRACTION_WIDTH : TRAVEL_WIDTH);
  }

  /**
   * The move at a place, among the first `count` of a layer that are shown: the uppermost
   * line over it, else the nearest of what is as near as `reach` mm. -1 if there is none.
   */
  pick(layer, count, [x, y], reach) {
    const moves = this.movesOf(layer);
    let [found, best] = [-1, 0];
    for (let i = 0; i < Math.min(count, moves.count); i++) {
      if (this.hidden.has(roleOf(moves, i))) continue;
      const beyond = distance(this.endsOf(moves, i), x, y) - this.thicknessOf(moves, i) / 2;
      const beside = Math.max(beyond, 0);
      // Marks and travels lie over lines, but are hit on themselves only.
      if (beside <= reach && (found < 0 || beside <= best)) [found, best] = [i, beside];
    }
    return found;
  }
}

/** Of a point from a line between two, mm. */
function distance([[fromX, fromY], [toX, toY]], x, y) {
  const [wayX, wayY] = [toX - fromX, toY - fromY];
  const square = wayX * wayX + wayY * wayY;
  const along = square > 0 ? ((x - fromX) * wayX + (y - fromY) * wayY) / square : 0;
  const part = Math.min(Math.max(along, 0), 1);
  return Math.hypot(x - fromX - part * wayX, y - fromY - part * wayY);
}

/** WebGL where it is quick; `?webgl` and `?canvas` in the address ask for one of them. */
function makePainter(canvas) {
  try {
    if (location.search !== "?canvas") return new WebglPainter(canvas, location.search === "?webgl");
  } catch (error) {
    console.info(`Drawn by canvas 2D: ${error.message}`);
  }
  // A canvas that has had a context gives no other.
  const plain = canvas.cloneNode();
  canvas.replaceWith(plain);
  return new CanvasPainter(plain);
}
