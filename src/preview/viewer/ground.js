// The view -> what is under and over the lines: a grid, the nozzle, the move under the pointer.

/** A place in mm -> CSS pixels of the stage. */
function toScreen([x, y], view, width, height) {
  return [width / 2 + (x - view.x) * view.scale, height / 2 - (y - view.y) * view.scale];
}

/** The other way. */
function toPlace([x, y], view, width, height) {
  return [view.x + (x - width / 2) / view.scale, view.y - (y - height / 2) / view.scale];
}

/** The least of 1, 2 and 5 times a power of ten that is at least so many pixels wide, mm. */
function roundStep(view, pixels) {
  const least = pixels / view.scale;
  const power = 10 ** Math.floor(Math.log10(least));
  return power * [1, 2, 5, 10].find((factor) => factor * power >= least * 0.999);
}

/** A canvas that is measured in CSS pixels, empty. */
function cleared(canvas) {
  fitCanvas(canvas);
  const context = canvas.getContext("2d");
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.clearRect(0, 0, canvas.width, canvas.height);
  context.scale(devicePixelRatio, devicePixelRatio);
  return context;
}

/** Grid lines with their coordinates. */
function drawGround(canvas, view) {
  const context = cleared(canvas);
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  const step = roundStep(view, 60);
  const [left, bottom] = toPlace([0, height], view, width, height);
  const [right, top] = toPlace([width, 0], view, width, height);
  context.font = "11px system-ui, sans-serif";
  context.fillStyle = themeColour("faint");
  context.lineWidth = 1;
  const rule = (value, line, text) => {
    context.strokeStyle = themeColour(value === 0 ? "axis" : "grid");
    context.beginPath();
    context.moveTo(...line[0]);
    context.lineTo(...line[1]);
    context.stroke();
    if (text) context.fillText(decimals(value, 3), ...text);
  };
  for (let k = Math.ceil(left / step); k * step <= right; k++) {
    const x = Math.round(toScreen([k * step, 0], view, width, height)[0]) + 0.5;
    rule(k * step, [[x, 0], [x, height]], [x + 3, height - 5]);
  }
  for (let k = Math.ceil(bottom / step); k * step <= top; k++) {
    const y = Math.round(toScreen([0, k * step], view, width, height)[1]) + 0.5;
    // The lowest corner is the other axis's.
    rule(k * step, [[0, y], [width, y]], y < height - 18 && [4, y - 3]);
  }
}

/** The move that is pointed at, and the nozzle where not all moves are shown. */
function drawMarks(canvas, { view, move }, scene, moves, hit) {
  const context = cleared(canvas);
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  const place = (at) => toScreen(at, view, width, height);
  if (hit >= 0) {
    const [from, to] = scene.endsOf(moves, hit).map(place);
    outline(context, from, to, Math.max(scene.thicknessOf(moves, hit) * view.scale, 4));
  }
  if (move > 0 && move < moves.count) nozzle(context, place(scene.endsOf(moves, move - 1)[1]));
}

/** A ring about the line, and where it ends. */
function outline(context, from, to, wide) {
  context.lineCap = "round";
  const along = Math.atan2(to[1] - from[1], to[0] - from[0]);
  const quarter = Math.PI / 2;
  context.beginPath();
  context.arc(...to, wide / 2 + 1, along - quarter, along + quarter);
  context.arc(...from, wide / 2 + 1, along + quarter, along + 3 * quarter);
  context.closePath();
  for (const [colour, line] of [["paper", 5], ["accent", 2.5]]) {
    context.strokeStyle = themeColour(colour);
    context.lineWidth = line;
    context.stroke();
  }
  context.fillStyle = themeColour("accent");
  context.beginPath();
  context.arc(...to, 4, 0, 2 * Math.PI);
  context.fill();
}

function nozzle(context, [x, y]) {
  for (const [colour, line] of [["paper", 4], ["ink", 2]]) {
    context.strokeStyle = themeColour(colour);
    context.lineWidth = line;
    context.beginPath();
    context.arc(x, y, 7, 0, 2 * Math.PI);
    for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
      context.moveTo(x + 4 * dx, y + 4 * dy);
      context.lineTo(x + 12 * dx, y + 12 * dy);
    }
    context.stroke();
  }
}
