// The page itself: what is looked at, and what keys, pointer, sliders and address do to it.

/** What is looked at. `layer` is the stage (see unpack.js), `side` the side that is seen, `move` is how many moves of the layer are shown. */
const state = {
  layer: 1,
  move: 0,
  colour: "role",
  hidden: new Set([TRAVEL, RETRACTION]),
  below: true,
  side: "top",
  view: null,
  /** Whether the view is to hold the whole print, whatever the window's size. */
  fits: true,
  /** Where the pointer is, mm. */
  at: null,
  playing: false,
  /** How often colours have changed. */
  styles: 0,
};

let scene = null;
let wanted = false;
let lastAddress = "";

/** The least number of the layer slider: 0 is what comes before the first layer. */
function lowest() {
  return scene.countOf(0) > 0 || scene.layers === 0 ? 0 : 1;
}

function clamp(value, least, most) {
  return Math.min(Math.max(value, least), most);
}

/** Draws at the screen's next frame. */
function redraw() {
  if (wanted || !scene) return;
  wanted = true;
  requestAnimationFrame(() => {
    wanted = false;
    draw();
  });
}

/** What was drawn last, by the name of the part: parts that would look the same are left. */
const drawn = {};

function drawIfNew(part, looks, act) {
  const key = JSON.stringify(looks);
  if (drawn[part] === key) return;
  drawn[part] = key;
  act();
}

function draw() {
  const size = fitCanvas(byId("lines"));
  if (state.fits) state.view = fitted(size);
  const { view, layer, move, below, styles } = state;
  const scale = view.scale * devicePixelRatio;
  drawIfNew("lines", [view, layer, move, below, styles, size, devicePixelRatio], () => {
    scene.draw({ ...view, scale }, layer, move, below);
  });
  drawIfNew("ground", [view, styles, size], () => drawGround(byId("ground"), view));
  const hit = state.at ? scene.pick(layer, move, state.at, 4 / view.scale) : -1;
  drawMarks(byId("marks"), state, scene, scene.movesOf(layer), hit);
  showTip(hit);
  drawIfNew("times", [layer, styles, size], () => drawTimes(layer));
  showState(hit);
}

/** The view that holds the whole print. */
function fitted({ width, height }) {
  const bounds = FACTS.bounds ?? [[0, 0, 0], [100, 100, 100]];
  const axes = SIDES[state.side].map((axis) => "xyz".indexOf(axis));
  const [[x0, y0], [x1, y1]] = bounds.map((corner) => axes.map((axis) => corner[axis]));
  const margin = 40 * devicePixelRatio;
  const room = [Math.max(width - 2 * margin, 50), Math.max(height - 2 * margin, 50)];
  const scale = Math.min(room[0] / Math.max(x1 - x0, 1), room[1] / Math.max(y1 - y0, 1)) / devicePixelRatio;
  return { x: (x0 + x1) / 2, y: (y0 + y1) / 2, scale };
}

function showTip(hit) {
  const tip = byId("tip");
  tip.hidden = hit < 0;
  if (hit < 0) return;
  tip.textContent = describe(scene.movesOf(state.layer), hit);
  const stage = byId("stage");
  const [x, y] = toScreen(state.at, state.view, stage.clientWidth, stage.clientHeight);
  const left = x + 16 + tip.offsetWidth > stage.clientWidth ? x - 16 - tip.offsetWidth : x + 16;
  const top = clamp(y + 16, 4, stage.clientHeight - tip.offsetHeight - 4);
  tip.style.translate = `${Math.max(left, 4)}px ${top}px`;
}

/** Sliders and texts, and for programs `data-state` of the body. */
function showState(hit) {
  const { layer, move } = state;
  const count = scene.countOf(layer);
  const facts = FACTS.layers[layer - 1];
  const moves = scene.movesOf(layer);
  const [number, skin] = [layerOf(layer), skinOf(layer)];
  byId("layer").value = layer;
  if (document.activeElement !== byId("which")) byId("which").value = number;
  Object.assign(byId("move"), { max: count, value: move });
  const least = skin === null ? "" : `skin ${skin}\n${decimals(facts.low, 3)} to\n`;
  const z = facts ? `${least}${decimals(facts.z, 3)} mm` : "start";
  const time = facts ? clock(facts.seconds) : clock(FACTS.start_seconds);
  byId("top").textContent = `${z}\n${time}`;
  byId("layer").ariaValueText = facts ? `layer ${number}, ${z.replace(/\n/g, " ")}` : "before the first layer";
  const line = move > 0 ? `, line ${grouped(moves.line[move - 1])}` : "";
  byId("status").textContent = `move ${grouped(move)} of ${grouped(count)}${line}`;
  document.body.dataset.state = JSON.stringify({
    layers: LAYERS,
    layer: number,
    skin,
    side: state.side,
    moves: count,
    move,
    colour: state.colour,
    painter: scene.painter.constructor.name,
    tip: hit < 0 ? "" : byId("tip").textContent,
  });
  writeAddress();
}

/** Colours, switches and the scale are as the state says. */
function restyle() {
  scene.restyle(state);
  state.styles++;
  byId("colour").value = state.colour;
  byId("below").checked = state.below;
  byId("side").textContent = state.side[0].toUpperCase() + state.side.slice(1);
  updateRoles(state, scene.palette);
  updateScale(state.colour);
  redraw();
}

function goToLayer(layer, move = Infinity) {
  state.layer = clamp(Math.round(layer) || 0, lowest(), scene.layers);
  goToMove(move);
}

function goToMove(move) {
  state.move = clamp(Math.round(move), 0, scene.countOf(state.layer));
  redraw();
}

function setColour(mode) {
  state.colour = mode in MODES ? mode : "role";
  restyle();
}

function setHidden(roles, hide) {
  for (const role of roles) hide ? state.hidden.add(role) : state.hidden.delete(role);
  restyle();
}

function setBelow(on) {
  state.below = on;
  restyle();
}

/** Looks from above, from the front or from the right. */
function setSide(side) {
  if (!(side in SIDES) || side === state.side) return;
  Object.assign(state, { side, fits: true, at: null });
  restyle();
}

function turn() {
  const sides = Object.keys(SIDES);
  setSide(sides[(sides.indexOf(state.side) + 1) % sides.length]);
}

function togglePanel() {
  const wide = document.body.classList.toggle("wide");
  byId("toggle").ariaExpanded = String(!wide);
}

function fit() {
  state.fits = true;
  redraw();
}

/** Makes everything `factor` times as large; what is at a point of the screen stays there. */
function zoom(factor, [x, y] = middle()) {
  const { view } = state;
  const scale = clamp(view.scale * factor, 0.02, 5000);
  const stage = byId("stage");
  const fixed = toPlace([x, y], view, stage.clientWidth, stage.clientHeight);
  view.x = fixed[0] + ((view.x - fixed[0]) * view.scale) / scale;
  view.y = fixed[1] + ((view.y - fixed[1]) * view.scale) / scale;
  view.scale = scale;
  state.fits = false;
  redraw();
}

function middle() {
  return [byId("stage").clientWidth / 2, byId("stage").clientHeight / 2];
}

/** Reads the place that the address names; what it does not name stays. */
function readAddress() {
  const words = new URLSearchParams(location.hash.slice(1));
  lastAddress = location.hash;
  const numbers = (key, count) => {
    const values = (words.get(key) ?? "").split(",").map(Number);
    return words.has(key) && values.length === count && values.every(Number.isFinite) ? values : null;
  };
  if (words.has("hide")) {
    const names = words.get("hide").split(",");
    const hidden = FACTS.roles.flatMap((role, k) => (names.includes(role.name.replace(" ", "-")) ? [k] : []));
    state.hidden = new Set(hidden);
  }
  state.below = words.get("below") !== "0";
  setSide(words.get("side") ?? "top");
  const [x, y, scale] = numbers("view", 3) ?? [];
  if (scale > 0) Object.assign(state, { view: { x, y, scale }, fits: false });
  state.at = numbers("at", 2);
  setColour(words.get("colour") ?? state.colour);
  const [layer] = numbers("layer", 1) ?? [null];
  const [skin] = numbers("skin", 1) ?? [null];
  goToLayer(layer === null ? state.layer : stageOf(layer, skin), numbers("move", 1)?.[0]);
}

/** Browsers refuse too many changes of the address: only where one rests is written. */
const writeAddress = (() => {
  let timer = 0;
  return () => {
    clearTimeout(timer);
    timer = setTimeout(() => {
      const { layer, move, view, hidden, fits } = state;
      const names = [...hidden].sort().map((role) => FACTS.roles[role].name.replace(" ", "-"));
      const words = [`layer=${layerOf(layer)}`, `hide=${names}`];
      if (skinOf(layer) !== null) words.push(`skin=${skinOf(layer)}`);
      if (state.side !== "top") words.push(`side=${state.side}`);
      if (move < scene.countOf(layer)) words.push(`move=${move}`);
      if (state.colour !== "role") words.push(`colour=${state.colour}`);
      if (!state.below) words.push("below=0");
      if (!fits) words.push(`view=${decimals(view.x, 3)},${decimals(view.y, 3)},${decimals(view.scale, 3)}`);
      const address = `#${words.join("&")}`;
      if (address === lastAddress || state.playing) return;
      lastAddress = address;
      try {
        history.replaceState(null, "", address);
      } catch {
        // A page in a sandbox may not.
      }
    }, 400);
  };
})();

/** The layer by which half of all moves are made: it shows more than the top. */
function middleLayer() {
  let left = FACTS.moves / 2;
  const layer = scene.blocks.findIndex((block) => (left -= block.count) <= 0);
  return clamp(layer, Math.min(1, scene.layers), scene.layers);
}

/** Fills the panel and takes up the address. */
function begin() {
  const select = byId("colour");
  for (const [value, { name }] of Object.entries(MODES)) select.append(make("option", { value, textContent: name }));
  showFacts();
  showRoles(state.hidden, (role, shown) => setHidden([role], !shown));
  showSettings();
  byId("count").textContent = `of ${grouped(LAYERS)}`;
  for (const [id, max] of [["layer", scene.layers], ["which", LAYERS]]) Object.assign(byId(id), { min: lowest(), max });
  if (matchMedia("(max-width: 700px)").matches) togglePanel();
  listen();
  state.layer = middleLayer();
  readAddress();
}

async function load() {
  const data = byId("moves-data");
  try {
    const bytes = await inflate(bytesOfBase64(data.textContent.trim()));
    data.remove();
    scene = new Scene(bytes, byId("lines"));
    begin();
    byId("message").textContent = FACTS.moves ? "" : "There is no move in this file.";
    draw();
  } catch (error) {
    const old = typeof DecompressionStream === "undefined";
    byId("message").textContent = old
      ? "This browser cannot unpack the moves. Use Chromium 103, Firefox 113, Safari 16.4 or a newer one."
      : `The moves cannot be shown: ${error}`;
    throw error;
  }
}

load();
