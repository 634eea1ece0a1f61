// Moves -> colours: by role, or by a number on a scale.

/** From least to most: lightness rises all the way, so that the order is seen without colour, too. */
const RAMP = ["#482878", "#3e4989", "#31688e", "#26828e", "#1f9e89", "#35b779", "#6ece58", "#b5de2b", "#f0e51c"]
  .map(rgbOf);

/** What lines can be coloured by, in the order of the keys 1 to 7; the last only where there are skins. */
const MODES = {
  role: { name: "role" },
  speed: { name: "speed", unit: "mm/s", value: (moves, i) => moves.speed[i] },
  flow: { name: "flow", unit: "mm³/s", value: flowOf },
  time: { name: "layer time", unit: "s", value: (moves, i, layer) => FACTS.layers[layer - 1]?.seconds },
  width: { name: "line width", unit: "mm", value: (moves, i) => moves.width[i] },
  height: { name: "line height", unit: "mm", value: (moves, i) => moves.height[i] },
  z: {
    name: "height of skins",
    unit: "mm",
    value: (moves, i, layer, part) => moves.z.from[i] + (moves.z.to[i] - moves.z.from[i]) * part,
  },
};
if (!FACTS.scales.z) delete MODES.z;

/** `#rrggbb` as three numbers from 0 to 255. */
function rgbOf(hex) {
  return [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));
}

function hexOf(rgb) {
  return "#" + rgb.map((part) => Math.round(part).toString(16).padStart(2, "0")).join("");
}

function mixed(a, b, part) {
  return a.map((value, i) => value + (b[i] - value) * part);
}

/** What comes out of the nozzle in a second, mm³. */
function flowOf(moves, i) {
  const length = lengthOf(moves, i);
  return length > 0 ? (moves.filament[i] * FACTS.filament_area * moves.speed[i]) / length : 0;
}

/** A colour of the scale; `part` from 0 to 1. */
function onRamp(part) {
  const at = Math.min(Math.max(part, 0), 1) * (RAMP.length - 1);
  const below = Math.min(Math.floor(at), RAMP.length - 2);
  return mixed(RAMP[below], RAMP[below + 1], at - below);
}

/** A CSS colour that the page's theme names. */
function themeColour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

function lightness([r, g, b]) {
  return 0.3 * r + 0.59 * g + 0.11 * b;
}

/** The palette is made for white paper: on dark paper greys change sides, and dark colours are made lighter. */
function readable(rgb, onDark) {
  if (!onDark) return rgb;
  const [r, g, b] = rgb;
  if (r === g && g === b) return rgb.map((part) => 255 - 0.62 * part);
  const dark = 85 - lightness(rgb);
  return dark > 0 ? mixed(rgb, [255, 255, 255], 0.1 + dark / 200) : rgb;
}

/** The colours of roles on this paper, thin and thick. */
function rolePalette() {
  const onDark = lightness(rgbOf(themeColour("paper"))) < 128;
  return FACTS.roles.map((role) => ({
    thin: readable(rgbOf(role.colour), onDark),
    thick: readable(rgbOf(role.thick), onDark),
  }));
}

/** Pieces that a line which rises over the whole scale is cut into, to be coloured by z. */
const BANDS = 24;

/** How many pieces of a move have a colour of their own. */
function piecesOf(mode, moves, i) {
  if (mode !== "z" || !isLine(moves, i)) return 1;
  const [least, most] = FACTS.scales.z;
  const rise = Math.abs(moves.z.to[i] - moves.z.from[i]) / Math.max(most - least, 1e-3);
  return Math.min(Math.max(Math.ceil(rise * BANDS), 1), BANDS);
}

/** Gives the function (moves, i, layer, part of the way along the move) -> colour for a mode. */
function colouring(mode, palette) {
  const byRole = (moves, i) => {
    const { thin, thick } = palette[roleOf(moves, i)];
    return moves.roles[i] & THICK ? thick : thin;
  };
  const { value } = MODES[mode];
  const scale = FACTS.scales[mode];
  if (!value || !scale) return byRole;
  const [least, most] = scale;
  const steps = Array.from({ length: 256 }, (_, k) => onRamp(k / 255));
  return (moves, i, layer, along) => {
    if (!isLine(moves, i)) return byRole(moves, i);
    const part = most > least ? ((value(moves, i, layer, along) ?? least) - least) / (most - least) : 0.5;
    return steps[Math.round(255 * Math.min(Math.max(part, 0), 1)) || 0];
  };
}
