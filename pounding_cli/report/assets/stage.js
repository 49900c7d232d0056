// A kept time history: its series and impacts, and the drawing of its buildings and of the strips below them at one instant.

/** A contact is an impact from this share of the hardest one. */
const HARD = 0.1;

/** The series of one scene, read from base64 when first shown. */
class Scene {
  constructor(raw) {
    Object.assign(this, raw);
    const all = new Float32Array(Uint8Array.from(atob(raw.series), (sign) => sign.charCodeAt(0)).buffer);
    let next = 0;
    const take = () => all.subarray(next * this.count, ++next * this.count);
    const most = (series) => series.reduce((one, value) => Math.max(one, Math.abs(value) || 0), 0);
    this.ground = take();
    this.motions = raw.buildings.map(({ heights, foundation }) => ({ floors: heights.map(take), sway: foundation ? take() : null, rocking: foundation ? take() : null }));
    this.turns = raw.buildings.map(({ heights, plan }) => (plan?.turns ? heights.map(take) : null));
    this.forces = raw.links.map(take);
    this.yields = raw.analysis !== 'elastic';
    this.end = (this.count - 1) * this.dt;
    this.mostGround = most(this.ground);
    this.mostMoved = Math.max(1e-9, ...this.motions.flatMap(({ floors }) => floors.map(most)));
    this.mostTurned = Math.max(0, ...this.turns.flatMap((floors) => floors?.map(most) ?? []));
    this.mostReached = Math.max(this.mostMoved, ...raw.buildings.flatMap(({ plan }, building) =>
      (this.turns[building] ?? []).flatMap((series, floor) => [plan.low, plan.high].map((y) =>
        series.reduce((one, turn, at) => Math.max(one, Math.abs(this.motions[building].floors[floor][at] - (y - plan.centre) * turn)), 0)))));
    this.twists = raw.buildings.some(({ plan }) => plan);
    this.mostForce = Math.max(0, ...this.forces.map(most));
    this.contacts = this.findContacts();
    this.impacts = this.contacts.filter(({ force }) => force >= HARD * this.mostForce);
  }

  /** A series at a time between samples; 0 of none. */
  between(series, time) {
    if (!series) return 0;
    const place = Math.max(0, Math.min(time / this.dt, this.count - 1)), before = Math.floor(place), after = Math.min(before + 1, this.count - 1);
    return series[before] + (series[after] - series[before]) * (place - before);
  }

  /** Displacement of a floor, from 1, at a time [m]; 0 is the foundation. */
  moved(building, floor, time) {
    const { floors, sway } = this.motions[building];
    return this.between(floor ? floors[floor - 1] : sway, time);
  }

  /** Rotation of a floor, from 1, at a time [rad], the right side up along the street; 0 of what does not twist. */
  turned(building, floor, time) {
    return this.between(this.turns[building]?.[floor - 1], time);
  }

  /** By how much a place of a floor moves further along the row than its centre of mass [m]; `street`: of the place [m]. */
  swung(building, floor, street, time) {
    return this.turns[building] ? -(street - this.buildings[building].plan.centre) * this.turned(building, floor, time) : 0;
  }

  /** Drift of the storey below a floor over its yield drift, without what the foundation adds; of frame lines the largest. */
  demand(building, floor, time) {
    const { heights, yield: limits, plan } = this.buildings[building], over = (drift, limit) => (limit ? Math.abs(drift) / limit : 0);
    const drift = this.drift(building, floor, time);
    if (!this.turns[building]) return over(drift, limits[floor - 1]);
    return Math.max(...plan.lines.map((one) => this.lineDemand(building, floor, one, time)), ...plan.across.map((one) => this.lineDemand(building, floor, one, time, true)));
  }

  /** Drift of the storey below a floor at its centre of mass, without what the foundation adds [m]. */
  drift(building, floor, time) {
    const tilt = this.between(this.motions[building].rocking, time) * this.buildings[building].heights[floor - 1];
    return this.moved(building, floor, time) - this.moved(building, floor - 1, time) - tilt;
  }

  /** Drift of a frame line in the storey below a floor over its yield drift. */
  lineDemand(building, floor, { place, yield: limits }, time, isAcross = false) {
    const twist = this.turned(building, floor, time) - (floor > 1 ? this.turned(building, floor - 1, time) : 0), limit = limits[floor - 1];
    const drift = isAcross ? place * twist : this.drift(building, floor, time) - (place - this.buildings[building].plan.centre) * twist;
    return limit ? Math.abs(drift) / limit : 0;
  }

  /** Largest size of a link's force between two times [N]: nothing is missed between two drawn frames. */
  force(link, from, to) {
    const first = Math.max(0, Math.floor(from / this.dt)), last = Math.ceil(to / this.dt) + 1;
    return this.forces[link].subarray(first, last).reduce((most, value) => Math.max(most, Math.abs(value)), 0);
  }

  /** Contacts: spells in which a link that can open presses; from, at (its largest force) [s], force [N]. */
  findContacts() {
    const spells = [];
    this.forces.forEach((series, number) => {
      let spell = null;
      for (let place = 0; place < this.count && this.links[number].drawn !== 'bar'; place++) {
        const force = Math.abs(series[place]), at = place * this.dt;
        if (!(force > 0)) spell = null;
        else if (!spell) spells.push((spell = { from: at, at, force, link: number }));
        else if (force > spell.force) Object.assign(spell, { force, at });
      }
    });
    return spells.sort((one, other) => one.at - other.at);
  }
}

const SCALES = [1, 2, 3, 5, 7, 10, 15, 20, 30, 50, 70, 100, 150, 200, 300, 500, 700, 1000];

/** Where everything stands in a drawing of the given width: pixels a metre, widths, places. */
function layout(scene, width, scale) {
  const heights = scene.buildings.map(({ heights: each }) => each.reduce((all, one) => [...all, all.at(-1) + one], [0]));
  const tallest = Math.max(...heights.map((each) => each.at(-1))), count = scene.buildings.length;
  const height = Math.round(Math.max(220, Math.min(440, width * 0.52, innerHeight - 560))); // strips and buttons fit below
  const ground = height - 74, up = (ground - 44) / tallest;
  const gaps = scene.buildings.slice(1).map((_, number) => Math.max(...scene.links.filter((link) => link.left === number).map((link) => link.gap), -1));
  const widest = Math.min(0.62 * tallest * up, ((width - 28) / count) * 0.8), open = gaps.reduce((sum, gap) => sum + Math.max(gap, 0), 0);
  const fits = (one) => scene.mostReached * one * up <= 0.45 * widest && open * one * up <= 0.25 * width;
  const chosen = scale ?? SCALES.filter(fits).at(-1) ?? 1, sideways = chosen * up;
  const between = gaps.map((gap) => (gap < 0 ? widest * 0.4 : gap * sideways)), apart = between.reduce((sum, one) => sum + one, 0);
  const wide = Math.max(8, Math.min(widest, (width - 28 - 2 * Math.min(scene.mostReached * sideways, width * 0.2) - apart) / count));
  const starts = [(width - wide * count - apart) / 2];
  between.forEach((gap) => starts.push(starts.at(-1) + wide + gap));
  return { width, height, ground, up, sideways, scale: chosen, heights, gaps, wide, starts };
}

/** The colours of the page as the canvas needs them. */
function inks() {
  const style = getComputedStyle(document.documentElement), color = (name) => style.getPropertyValue(`--${name}`).trim();
  const named = ['ink', 'soft', 'line', 'flash', 'pull', 'slab', 'infill', 'earth', 'accent', 'bad'];
  return { ...Object.fromEntries(named.map((name) => [name, color(name)])), cases: Array.from({ length: 10 }, (_, number) => color(`case-${number}`)) };
}

/** An empty canvas as sharp as the screen, measured in CSS pixels. */
function sharp(canvas, width, height) {
  const dense = Math.min(devicePixelRatio || 1, 2);
  [canvas.width, canvas.height, canvas.style.height] = [Math.round(width * dense), Math.round(height * dense), `${height}px`];
  const pen = canvas.getContext('2d');
  pen.scale(dense, dense);
  pen.lineCap = 'round';
  return pen;
}

function line(pen, color, width, points) {
  [pen.strokeStyle, pen.lineWidth] = [color, width];
  pen.beginPath();
  points.forEach(([x, y]) => pen.lineTo(x, y));
  pen.stroke();
}

function area(pen, color, points) {
  pen.fillStyle = color;
  pen.beginPath();
  points.forEach(([x, y]) => pen.lineTo(x, y));
  pen.fill();
}

function write(pen, color, text, x, y, align = 'center', font = '12px') {
  [pen.fillStyle, pen.textAlign, pen.font] = [color, align, `${font} system-ui, sans-serif`];
  pen.fillText(text, x, y);
}

/** Width of a name that is written below a building of any width, where it stands clear of others [pixels]. */
const SHORT_NAME = 36;

/** Write the first of some texts that fits into a width and stands clear of the text left of it at the same height. */
function writeApart(pen, color, texts, x, y, width, font = '12px') {
  pen.font = `${font} system-ui, sans-serif`;
  const half = (text) => pen.measureText(text).width / 2;
  const text = texts.find((one) => 2 * half(one) < width && x - half(one) > (pen.textEnds[y] ?? -Infinity) + 4);
  if (text === undefined) return false;
  pen.textEnds[y] = x + half(text);
  write(pen, color, text, x, y, 'center', font);
  return true;
}

/** Draw the buildings at a time; `glow`: force of every link over the largest one, fading after an impact. */
function drawStage(canvas, scene, at, time, glow, ink) {
  const pen = sharp(canvas, at.width, at.height), x = (building, floor) => at.starts[building] + scene.moved(building, floor, time) * at.sideways;
  pen.textEnds = {};
  const thick = scene.buildings.map(({ slab }, number) => Math.max(2, slab ? slab * at.up : Math.min(7, at.heights[number][1] * at.up * 0.12)));
  const middle = at.width / 2, end = middle + (scene.between(scene.ground, time) / (scene.mostGround || 1)) * Math.min(120, at.width * 0.25);
  line(pen, ink.earth, 3, [[0, at.ground + 1], [at.width, at.ground + 1]]);
  line(pen, ink.accent, 4, [[middle, at.height - 18], [end, at.height - 18]]);
  write(pen, ink.soft, 'ground acceleration', 2, at.height - 14, 'left');
  const faces = scene.links.map((link) => facesOf(scene, at, link, x, time));
  const drawLinks = (isBar) => scene.links.forEach((link, number) => {
    if ((link.drawn === 'bar') === isBar) drawLink(pen, scene, at, link, faces[number], thick[link.left], scene.between(scene.forces[number], time), ink);
  });
  drawLinks(false);
  scene.buildings.forEach((_, number) => drawBuilding(pen, scene, at, number, time, x, thick[number], ink));
  drawLinks(true); // their ends stand in front of the slabs that they are bolted to
  faces.forEach(({ left, right, y }, number) => {
    if (scene.links[number].drawn !== 'bar') drawStar(pen, ink, (left + right) / 2, y, glow[number]);
  });
}

/** A star as large and bright as a contact force, whose share of the largest one is `glow`; none where that is too small. */
function drawStar(pen, ink, x, y, glow) {
  if (!(glow > 0.01)) return;
  const size = 5 + 20 * Math.sqrt(glow), rays = Array.from({ length: 16 }, (_, ray) => [ray % 2 ? size * 0.42 : size, (ray * Math.PI) / 8]);
  pen.globalAlpha = Math.min(1, 0.3 + glow);
  area(pen, ink.flash, rays.map(([far, angle]) => [x + far * Math.cos(angle), y + far * Math.sin(angle)]));
  pen.globalAlpha = 1;
}

function drawBuilding(pen, scene, at, number, time, x, thick, ink) {
  const heights = at.heights[number], y = (floor) => at.ground - heights[floor] * at.up, { sway, rocking } = scene.motions[number], middle = at.starts[number] + at.wide / 2;
  if (sway) {
    const tilt = Math.max(-0.3, Math.min(0.3, scene.between(rocking, time) * at.scale)), half = at.wide * 0.55, base = x(number, 0) + at.wide / 2;
    line(pen, ink.soft, 6, [[base - half, at.ground - 3 - half * tilt], [base + half, at.ground - 3 + half * tilt]]);
  }
  for (let floor = 1; floor < heights.length; floor++) {
    const yielding = scene.yields && scene.demand(number, floor, time) >= 1, third = (y(floor) - y(floor - 1)) / 3;
    [pen.strokeStyle, pen.lineWidth] = yielding ? [ink.bad, 3.4] : [ink.soft, 2];
    pen.beginPath();
    for (const post of [0.08, 0.5, 0.92]) {
      const from = x(number, floor - 1) + post * at.wide, to = x(number, floor) + post * at.wide;
      pen.moveTo(from, y(floor - 1));
      pen.bezierCurveTo(from, y(floor - 1) + third, to, y(floor) - third, to, y(floor)); // clamped in both floors
    }
    pen.stroke();
  }
  pen.fillStyle = ink.slab;
  for (let floor = 1; floor < heights.length; floor++) {
    if (scene.turns[number]) { // from the side one sees a turned floor from its one corner to the other
      const { low, high } = scene.buildings[number].plan, ends = [low, high].map((street) => scene.swung(number, floor, street, time) * at.sideways);
      pen.globalAlpha = 0.35;
      pen.fillRect(x(number, floor) + Math.min(...ends), y(floor) - thick / 2, at.wide + Math.abs(ends[0] - ends[1]), thick);
      pen.globalAlpha = 1;
    }
    pen.fillRect(x(number, floor), y(floor) - thick / 2, at.wide, thick);
    for (const link of scene.links) { // where a floor's gap is narrower than the widest one of its pair, its slab reaches further
      const over = reach(at, link);
      if (link.left === number && link.floor === floor && link.left_at === 1) pen.fillRect(x(number, floor) + at.wide, y(floor) - thick / 2, over, thick);
      if (link.right === number && link.right_floor === floor && link.right_at === 1) pen.fillRect(x(number, floor) - over, y(floor) - thick / 2, over, thick);
    }
  }
  const { name, period } = scene.buildings[number];
  const isNamed = writeApart(pen, ink.ink, [name], middle, at.ground + 25, Math.max(at.wide * 1.15, SHORT_NAME), '600 12.5px');
  if (period && isNamed) writeApart(pen, ink.soft, [`${period.toFixed(2)} s`], middle, at.ground + 40, Infinity);
}

/** By how much a slab reaches further; columns do not, so that the slab that strikes them does by all of it. */
const reach = (at, link) => ((at.gaps[link.left] - link.gap) / (link.left_at === link.right_at ? 2 : 1)) * at.sideways;

/** The two faces of a link, their heights in the drawing, and the middle of these; it ends at floors, or on columns, clamped in both floors, or at a wall, which moves as one. */
function facesOf(scene, at, link, x, time) {
  const between = (building, floor, part) => x(building, floor - 1) + (x(building, floor) - x(building, floor - 1)) * part * part * (3 - 2 * part);
  const isWall = (building) => scene.buildings[building].wall, end = (building, floor, part) => (isWall(building) ? x(building, 1) : between(building, floor, part));
  const level = (building, floor, part) => (floor ? part * at.heights[building][floor] + (1 - part) * at.heights[building][floor - 1] : 0);
  const ends = [level(link.left, link.floor, link.left_at), level(link.right, link.right_floor, link.right_at)];
  const swing = (building, floor, side) => (link.places && floor ? scene.swung(building, floor, link.places[side], time) * at.sideways : 0);
  const low = isWall(link.left) ? ends[1] : ends[0], high = isWall(link.right) ? ends[0] : ends[1];
  return {
    left: end(link.left, link.floor, link.left_at) + swing(link.left, link.floor, 0) + at.wide + (link.left_at === 1 ? reach(at, link) : 0),
    right: end(link.right, link.right_floor, link.right_at) + swing(link.right, link.right_floor, 1) - (link.right_at === 1 ? reach(at, link) : 0),
    leftY: at.ground - low * at.up, rightY: at.ground - high * at.up, y: at.ground - ((low + high) / 2) * at.up,
  };
}

function drawLink(pen, scene, at, link, { left, right, leftY, rightY, y }, thick, force, ink) {
  if (link.drawn === 'filling') {
    pen.fillStyle = ink.infill; // it presses, it does not pull
    pen.fillRect(left, y - thick * 1.6, Math.max(Math.min(right, left + link.gap * at.sideways) - left, 1), thick * 3.2);
  } else if (link.drawn === 'bar') {
    const into = link.damper || leftY !== rightY ? 14 : 5, color = force < 0 ? ink.pull : ink.flash; // how far its ends reach into the buildings
    const ends = [[left - into, leftY], [right + into, rightY]], width = 2 + 4 * Math.abs(force / (scene.mostForce || 1));
    if (link.damper) drawDamper(pen, color, width, ...ends);
    else line(pen, color, width, ends);
  }
}

/** A damper between two points: a cylinder, open to the right, and the piston in it. */
function drawDamper(pen, color, width, [left, leftY], [right, rightY]) {
  const long = Math.hypot(right - left, rightY - leftY) || 1, along = [(right - left) / long, (rightY - leftY) / long], half = 5;
  const point = (part, off = 0) => [left + part * (right - left) - off * along[1], leftY + part * (rightY - leftY) + off * along[0]];
  line(pen, color, width, [point(0), point(0.3)]);
  line(pen, color, 2, [point(0.7, half), point(0.3, half), point(0.3, -half), point(0.7, -half)]);
  line(pen, color, 2, [point(0.55, half - 2), point(0.55, 2 - half)]);
  line(pen, color, width, [point(0.55), point(1)]);
}

const STRIP = 56;

/** The strips under the buildings: ground motion, roofs, link forces, each with what it goes up to; a line at the present. */
function drawStrips(canvas, scene, time, width, ink) {
  const roofs = scene.motions.map(({ floors }, number) => ({ series: floors.at(-1), color: ink.cases[number % 10], name: scene.buildings[number].name }));
  const strips = [
    { name: 'ground acceleration', unit: scene.acceleration.unit, most: scene.mostGround * scene.acceleration.factor, lines: [{ series: scene.ground, color: ink.accent }] },
    { name: `roofs (${roofs.map(({ name }) => name).join(', ')})`, unit: 'mm', most: 1e3 * scene.mostMoved, lines: roofs },
    { name: `turns of roofs (${scene.buildings.filter((_, number) => scene.turns[number]).map(({ name }) => name).join(', ')})`, unit: 'mrad', most: 1e3 * scene.mostTurned, lines: scene.turns.flatMap((floors, number) => (floors ? [{ series: floors.at(-1), color: ink.cases[number % 10] }] : [])) },
    { name: 'link forces', unit: 'kN', most: scene.mostForce / 1e3, lines: scene.forces.map((series) => ({ series, color: ink.flash })) },
  ].filter(({ lines }) => lines.length);
  const low = STRIP * strips.length, pen = sharp(canvas, width, low + 18), x = (at) => (at / scene.end) * width;
  strips.forEach(({ name, unit, most, lines }, number) => {
    const top = STRIP * number, room = STRIP - 20, every = lines.flatMap(({ series }) => [series.reduce((a, b) => Math.max(a, b), 0), series.reduce((a, b) => Math.min(a, b), 0)]);
    const up = Math.max(...every), zoom = room / (up - Math.min(...every) || 1), y = (value) => top + 16 + (up - value) * zoom;
    line(pen, ink.line, 1, [[0, y(0)], [width, y(0)]]);
    for (const { series, color } of lines) {
      const points = Array.from({ length: Math.floor(width) }, (_, pixel) => { // the extremes of a pixel: no impact is lost
        const first = Math.floor((pixel / width) * scene.count), here = series.subarray(first, Math.max(first + 1, Math.floor(((pixel + 1) / width) * scene.count)) + 1);
        return [[pixel, y(Math.min(...here))], [pixel, y(Math.max(...here))]];
      });
      line(pen, color, 1.2, points.flat());
    }
    write(pen, ink.ink, `${name}, up to ${asText(most, 3)} ${unit}`, 2, top + 12, 'left');
  });
  for (const tick of ticksBetween(0, scene.end, width / 90)) write(pen, ink.soft, `${Number(tick.toPrecision(6))} s`, Math.min(Math.max(x(tick), 8), width - 16), low + 15);
  line(pen, ink.ink, 1.5, [[x(time), 0], [x(time), low]]);
}
