// Keys, pointer, sliders and time -> changes of the state.

/** Times as fast as the printer. */
const pace = () => Number(byId("pace").value);

function setPlaying(on) {
  if (state.playing === on) return;
  state.playing = on;
  byId("play").textContent = on ? "⏸" : "▶";
  byId("play").ariaPressed = String(on);
  if (!on) return redraw();
  const atEnd = state.move >= scene.countOf(state.layer);
  if (atEnd) goToLayer(state.layer < scene.layers ? state.layer + 1 : lowest(), 0);
  let [before, left] = [performance.now(), 0];
  const step = (now) => {
    if (!state.playing) return;
    left = play(left + (pace() * Math.max(now - before, 0)) / 1000);
    before = now;
    requestAnimationFrame(step);
  };
  requestAnimationFrame(step);
}

/** Shows as many moves more as there is time for, s; gives the time that is left. */
function play(time) {
  let moves = scene.movesOf(state.layer);
  for (;;) {
    if (state.move >= moves.count) {
      if (state.layer >= scene.layers) {
        setPlaying(false);
        return 0;
      }
      goToLayer(state.layer + 1, 0);
      moves = scene.movesOf(state.layer);
      continue;
    }
    const way = lengthOf(moves, state.move) || Math.abs(moves.filament[state.move]);
    const needed = way / Math.max(moves.speed[state.move], 0.1);
    if (needed > time) return time;
    time -= needed;
    goToMove(state.move + 1);
  }
}

const KEYS = {
  ArrowUp: ({ shiftKey }) => goToLayer(state.layer + (shiftKey ? 10 : 1)),
  ArrowDown: ({ shiftKey }) => goToLayer(state.layer - (shiftKey ? 10 : 1)),
  PageUp: () => goToLayer(state.layer + 10),
  PageDown: () => goToLayer(state.layer - 10),
  ArrowLeft: ({ shiftKey }) => goToMove(state.move - (shiftKey ? 10 : 1)),
  ArrowRight: ({ shiftKey }) => goToMove(state.move + (shiftKey ? 10 : 1)),
  Home: ({ ctrlKey }) => (ctrlKey ? goToLayer(lowest()) : goToMove(0)),
  End: ({ ctrlKey }) => (ctrlKey ? goToLayer(scene.layers) : goToMove(Infinity)),
  " ": () => setPlaying(!state.playing),
  t: () => setHidden([TRAVEL, RETRACTION], !state.hidden.has(TRAVEL)),
  b: () => setBelow(!state.below),
  f: fit,
  s: turn,
  "+": () => zoom(1.25),
  "=": () => zoom(1.25),
  "-": () => zoom(0.8),
  "?": () => byId("help").showModal(),
};
Object.keys(MODES).forEach((mode, k) => (KEYS[k + 1] = () => setColour(mode)));

function onKey(event) {
  const { target, key } = event;
  // What is typed into is left alone; so is a button that space would press.
  const types = target.matches("select, textarea, input:not([type=range], [type=checkbox])");
  const presses = key === " " && target.matches("button, summary, input[type=checkbox]");
  const command = event.altKey || event.metaKey || (event.ctrlKey && key !== "Home" && key !== "End");
  if (types || presses || command || byId("help").open || !KEYS[key]) return;
  event.preventDefault();
  KEYS[key](event);
}

/** Where an event is, in CSS pixels of the stage. */
function onStage(event) {
  const { left, top } = byId("stage").getBoundingClientRect();
  return [event.clientX - left, event.clientY - top];
}

function pointAt(pixels) {
  const stage = byId("stage");
  state.at = toPlace(pixels, state.view, stage.clientWidth, stage.clientHeight);
  redraw();
}

/** Middle of the pointers that are down, and how far apart they are. */
function grip(held) {
  const points = [...held.values()];
  const [x, y] = [0, 1].map((axis) => points.reduce((sum, point) => sum + point[axis], 0) / points.length);
  const apart = points.length < 2 ? 0 : Math.hypot(points[0][0] - points[1][0], points[0][1] - points[1][1]);
  return { x, y, apart };
}

/** Drags, with one pointer or two, and hovering. */
function listenToPointers(stage) {
  const held = new Map();
  const release = (event) => {
    held.delete(event.pointerId);
    stage.classList.toggle("held", held.size > 0);
  };
  stage.addEventListener("pointerdown", (event) => {
    if (event.target.closest("button")) return;
    stage.setPointerCapture(event.pointerId);
    held.set(event.pointerId, onStage(event));
    stage.classList.add("held");
    pointAt(onStage(event));
  });
  stage.addEventListener("pointermove", (event) => {
    if (!held.has(event.pointerId)) return pointAt(onStage(event));
    const before = grip(held);
    held.set(event.pointerId, onStage(event));
    const now = grip(held);
    state.fits = false;
    state.view.x -= (now.x - before.x) / state.view.scale;
    state.view.y += (now.y - before.y) / state.view.scale;
    if (before.apart && now.apart) zoom(now.apart / before.apart, [now.x, now.y]);
    redraw();
  });
  stage.addEventListener("pointerup", release);
  stage.addEventListener("pointercancel", release);
  stage.addEventListener("pointerleave", (event) => {
    if (event.pointerType === "touch") return;
    state.at = null;
    redraw();
  });
  stage.addEventListener("wheel", (event) => {
    event.preventDefault();
    // Firefox may count lines, others pixels.
    const pixels = event.deltaMode === 1 ? 30 * event.deltaY : event.deltaY;
    zoom(Math.exp(-clamp(pixels, -300, 300) / 400), onStage(event));
  }, { passive: false });
}

function listen() {
  const on = (id, name, act) => byId(id).addEventListener(name, act);
  on("layer", "input", (event) => goToLayer(Number(event.target.value)));
  on("which", "change", (event) => goToLayer(stageOf(Math.round(Number(event.target.value)))));
  on("move", "input", (event) => goToMove(Number(event.target.value)));
  on("colour", "change", (event) => setColour(event.target.value));
  on("below", "change", (event) => setBelow(event.target.checked));
  on("play", "click", () => setPlaying(!state.playing));
  on("fit", "click", fit);
  on("side", "click", turn);
  on("ask", "click", () => byId("help").showModal());
  on("toggle", "click", togglePanel);
  listenToPointers(byId("stage"));
  addEventListener("keydown", onKey);
  addEventListener("hashchange", readAddress);
  // At once: at the next frame the old picture would be seen stretched.
  new ResizeObserver(draw).observe(byId("stage"));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", restyle);
}
