// Facts -> the panel: sums, switches of roles, the scale and the file's settings.

const byId = (id) => document.getElementById(id);

/** An element with properties and children. */
function make(name, properties = {}, ...children) {
  const element = Object.assign(document.createElement(name), properties);
  element.append(...children);
  return element;
}

/** Hours, minutes and seconds, as far as there are any. */
function clock(seconds) {
  if (seconds == null) return "?";
  if (seconds < 60) return `${seconds.toFixed(1)} s`;
  const whole = Math.round(seconds);
  const two = (number) => String(number).padStart(2, "0");
  const [hours, minutes] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60];
  return hours ? `${hours} h ${two(minutes)} min` : `${minutes} min ${two(whole % 60)} s`;
}

/** With at most so many decimals. */
function decimals(value, most) {
  return String(Number(Number(value).toFixed(most)));
}

function grouped(number) {
  return String(number).replace(/\B(?=(\d{3})+$)/g, " ");
}

function showFacts() {
  const { layers, bounds } = FACTS;
  const skins = layers.filter((one) => one.skin !== undefined).length;
  const rows = [
    ["time", clock(FACTS.seconds), "without heating and homing"],
    ["layers", grouped(LAYERS)],
    ...(skins ? [["skins", grouped(skins), "patches of non-planar skin"]] : []),
    ["filament", `${decimals(FACTS.filament_mm / 1000, 2)} m, ${decimals(FACTS.filament_cm3, 2)} cm³`],
    ["moves", grouped(FACTS.moves)],
  ];
  if (bounds) {
    const size = bounds[0].map((least, axis) => decimals(bounds[1][axis] - least, 1));
    rows.splice(1, 0, ["size", `${size.join(" × ")} mm`]);
  }
  if (FACTS.scales.flow) rows.push(["highest flow", `${decimals(FACTS.scales.flow[1], 1)} mm³/s`]);
  for (const [name, value, title = ""] of rows) {
    byId("facts").append(make("dt", { textContent: name, title }), make("dd", { textContent: value, title }));
  }
  byId("head").textContent = FACTS.head;
  byId("head").hidden = !FACTS.head;
}

/** A switch for each role that occurs; `change(role, shown)` is called. */
function showRoles(hidden, change) {
  FACTS.roles.forEach((role, index) => {
    if (role.moves === 0) return;
    const box = make("input", { type: "checkbox", checked: !hidden.has(index) });
    box.dataset.role = index;
    box.addEventListener("change", () => change(index, box.checked));
    const swatch = make("span", { className: "swatch" }, make("i"), make("i"));
    const share = FACTS.seconds > 0 ? `${((100 * role.seconds) / FACTS.seconds).toFixed(1)} %` : "";
    const title = `${clock(role.seconds)}, ${decimals(role.filament_mm / 1000, 2)} m of filament`;
    const shown = make("span", { className: "share", textContent: share });
    byId("roles").append(make("label", { className: "switch", title }, box, swatch, role.name, shown));
  });
}

/** Switches and swatches as the state has them. */
function updateRoles({ hidden, colour }, palette) {
  for (const box of byId("roles").querySelectorAll("input")) {
    const index = Number(box.dataset.role);
    box.checked = !hidden.has(index);
    const { thin, thick } = palette[index];
    const [left, right] = box.nextElementSibling.children;
    left.style.background = hexOf(thin);
    right.style.background = hexOf(thick);
    const marks = index === TRAVEL || index === RETRACTION || hexOf(thin) === hexOf(thick);
    box.nextElementSibling.classList.toggle("unused", colour !== "role" && index !== TRAVEL && index !== RETRACTION);
    right.hidden = marks || !FACTS.layers.length || !someThick();
  }
}

/** Whether lines are higher than layers: then thick ones have a colour of their own. */
function someThick() {
  const highest = FACTS.highest ?? FACTS.scales.height?.[1] ?? 0;
  return FACTS.layers.some((layer) => highest > 1.5 * layer.height);
}

function updateScale(mode) {
  const scale = FACTS.scales[mode];
  byId("scale").hidden = !scale;
  if (!scale) return;
  byId("ramp").style.background = `linear-gradient(to right, ${RAMP.map(hexOf).join(", ")})`;
  const [least, most] = scale;
  const places = most - least < 0.2 ? 3 : most - least < 20 ? 2 : 0;
  const ticks = [0, 0.25, 0.5, 0.75, 1].map((part) => decimals(least + part * (most - least), places));
  ticks[4] += ` ${MODES[mode].unit}`;
  byId("ticks").replaceChildren(...ticks.map((textContent) => make("span", { textContent })));
}

function showSettings() {
  if (!FACTS.settings.length) return;
  byId("settings").hidden = false;
  const rows = FACTS.settings.map(([key, value]) =>
    make("tr", {}, make("td", { textContent: key }), make("td", { textContent: value })),
  );
  byId("values").append(...rows);
  byId("find").addEventListener("input", () => {
    const wanted = byId("find").value.toLowerCase();
    for (const row of rows) row.hidden = !row.textContent.toLowerCase().includes(wanted);
  });
}

/** Bars beside the slider: how long each layer takes. */
function drawTimes(layer) {
  const canvas = byId("times");
  const height = fitCanvas(canvas).height;
  const context = canvas.getContext("2d");
  context.clearRect(0, 0, canvas.width, height);
  const longest = FACTS.scales.time?.[1];
  if (!longest) return;
  const each = height / FACTS.layers.length;
  const [bar, here] = [themeColour("rule"), themeColour("accent")];
  FACTS.layers.forEach(({ seconds, skin }, k) => {
    const now = k + 1 === layer;
    context.fillStyle = now ? here : skin === undefined ? bar : FACTS.roles[SKIN].colour;
    const thick = Math.max(each, now ? 2 * devicePixelRatio : 0.5);
    context.fillRect(0, height - (k + 1) * each, (canvas.width * seconds) / longest, thick);
  });
}

/** Gives a canvas as many pixels as it has on the screen. */
function fitCanvas(canvas) {
  const width = Math.max(1, Math.round(canvas.clientWidth * devicePixelRatio));
  const height = Math.max(1, Math.round(canvas.clientHeight * devicePixelRatio));
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
  return { width, height };
}

/** What a move is, for people. The first line is its role. */
function describe(moves, i) {
  const role = FACTS.roles[roleOf(moves, i)].name;
  const length = lengthOf(moves, i);
  const speed = moves.speed[i];
  const lines = [moves.roles[i] & THICK ? `${role}, thick` : role];
  if (isLine(moves, i)) lines.push(`${decimals(moves.width[i], 3)} mm wide, ${decimals(moves.height[i], 3)} mm high`);
  lines.push(`${decimals(speed, 1)} mm/s (F${Math.round(60 * speed)})`);
  if (isLine(moves, i)) lines.push(`${decimals(flowOf(moves, i), 2)} mm³/s`);
  if (length > 0) lines.push(`${decimals(length, 3)} mm long`);
  if (moves.filament[i] !== 0) lines.push(`E ${moves.filament[i] > 0 ? "+" : ""}${decimals(moves.filament[i], 5)} mm`);
  const to = ["x", "y", "z"].map((axis) => `${axis.toUpperCase()}${decimals(moves[axis].to[i], 3)}`);
  lines.push(`to ${to.join(" ")}`, `line ${moves.line[i]} of the file`);
  return lines.join("\n");
}
