"use strict";

// The page's data -> facts, and the moves of a layer. The format of the moves is that of packed.rs.

/** See facts.rs. */
const FACTS = JSON.parse(document.getElementById("facts-json").textContent);

/** Bit of a role: the line is printed for several layers. */
const THICK = 0x80;

const [TRAVEL, RETRACTION] = ["travel", "retraction"].map((name) => FACTS.roles.findIndex((role) => role.name === name));

const SKIN = FACTS.roles.findIndex((role) => role.name === "non-planar skin");

/**
 * The page is looked through by stages: layers, and patches of non-planar skin, each after its layer.
 * Without patches the stages are the layers. Stages and layers are counted from 1.
 */
const LAYERS = FACTS.layers.at(-1)?.number ?? FACTS.layers.length;

function layerOf(stage) {
  return FACTS.layers[stage - 1]?.number ?? stage;
}

function skinOf(stage) {
  return FACTS.layers[stage - 1]?.skin ?? null;
}

/** The first stage of a layer, or the patch `skin` after it. Beyond the layers it is beyond the stages. */
function stageOf(layer, skin = null) {
  const at = FACTS.layers.findIndex((_, k) => layerOf(k + 1) === layer && (skin === null || skinOf(k + 1) === skin));
  if (at >= 0) return at + 1;
  return layer > LAYERS ? FACTS.layers.length : layer;
}

/** What a view's two axes are: from above, from the front and from the right. */
const SIDES = { top: ["x", "y"], front: ["x", "z"], right: ["y", "z"] };

/** Bytes of a base64 text. */
function bytesOfBase64(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < bytes.length; i++) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

/** Undoes the deflating. */
async function inflate(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Reads numbers one after the other. */
class Numbers {
  constructor(bytes, at) {
    this.bytes = bytes;
    this.at = at;
  }

  unsigned() {
    let value = 0;
    let shift = 0;
    for (;;) {
      const byte = this.bytes[this.at++];
      value |= (byte & 0x7f) << shift;
      if (byte < 0x80) return value >>> 0;
      shift += 7;
    }
  }

  signed() {
    const value = this.unsigned();
    return (value >>> 1) ^ -(value & 1);
  }

  /** n differences, summed up and scaled. */
  sums(n, scale, array) {
    let sum = 0;
    for (let i = 0; i < n; i++) array[i] = (sum += this.signed()) * scale;
    return array;
  }

  raw(n) {
    this.at += n;
    return this.bytes.subarray(this.at - n, this.at);
  }
}

/** Where each block begins, and how many moves it has. */
function findBlocks(bytes) {
  const blocks = [];
  for (let at = 0; at < bytes.length; ) {
    const numbers = new Numbers(bytes, at);
    const length = numbers.unsigned();
    at = numbers.at + length;
    blocks.push({ at: numbers.at, count: numbers.unsigned() });
  }
  return blocks;
}

/** Move at which a start stands -> its place, in µm. */
function readStarts(numbers) {
  const starts = new Map();
  let move = 0;
  for (let left = numbers.unsigned(); left > 0; left--) {
    move += numbers.unsigned();
    starts.set(move, [numbers.signed(), numbers.signed(), numbers.signed()]);
  }
  return starts;
}

/** Where moves begin and end along one axis, mm. */
function readAxis(numbers, n, starts, axis) {
  const from = new Float32Array(n);
  const to = new Float32Array(n);
  let at = 0;
  for (let i = 0; i < n; i++) {
    if (starts.has(i)) at = starts.get(i)[axis];
    from[i] = at / 1000;
    at += numbers.signed();
    to[i] = at / 1000;
  }
  return { from, to };
}

function readFilament(numbers, n) {
  const filament = new Float32Array(n);
  for (let i = 0; i < n; i++) filament[i] = numbers.signed() / 1e5;
  return filament;
}

/** The moves of a block: one array for each of their properties. */
function unpackBlock(bytes, block) {
  const numbers = new Numbers(bytes, block.at);
  const n = numbers.unsigned();
  const starts = readStarts(numbers);
  const roles = numbers.raw(n);
  const [x, y, z] = [0, 1, 2].map((axis) => readAxis(numbers, n, starts, axis));
  return {
    count: n,
    roles,
    x,
    y,
    z,
    filament: readFilament(numbers, n),
    speed: numbers.sums(n, 1 / 60, new Float32Array(n)),
    width: numbers.sums(n, 1 / 1000, new Float32Array(n)),
    height: numbers.sums(n, 1 / 1000, new Float32Array(n)),
    line: numbers.sums(n, 1, new Uint32Array(n)),
  };
}

function roleOf(moves, i) {
  return moves.roles[i] & ~THICK;
}

function isLine(moves, i) {
  return moves.width[i] > 0;
}

/** Way of the nozzle, mm. */
function lengthOf(moves, i) {
  return Math.hypot(
    moves.x.to[i] - moves.x.from[i],
    moves.y.to[i] - moves.y.from[i],
    moves.z.to[i] - moves.z.from[i],
  );
}
