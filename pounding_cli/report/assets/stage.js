// A kept scene: its series and impacts, and the drawing of its buildings and of the strips below them at one instant.

/** A contact is an impact from this share of the hardest one. */
const HARD = 0.1;

/** The series of one scene, read from base64 when first shown. */
class Scene {
  constructor(raw) {
    Object.assign(this, raw);
    const all = new Float32Array(Uint8Array.from(atob(raw.series), (sign) => sign.charCodeAt(0)).buffer);
    let next = 0;
    const take = () => all.subarray(next * this.count, ++next * this.count), most = (series) => series.reduce((one, value) => Math.max(one, Math.abs(value) || 0), 0);
    this.ground = take();
    this.motions = raw.buildings.map(({ heights, foundation }) => ({ floors: heights.map(take), sway: foundation ? take() : null, rocking: foundation ? take() : null }));
    this.forces = raw.links.map(take);
    this.yields = raw.analysis !== 'elastic';
    this.end = (this.count - 1) * this.dt;
    this.mostGround = most(this.ground);
    this.mostMoved = Math.max(1e-9, ...this.motions.flatMap(({ floors }) => floors.map(most)));
    this.mostForce = Math.max(0, ...this.forces.map(most));
    this.contacts = this.findContacts();
    this.impacts = [];
    for (const contact of this.contacts.filter(({ force }) => force >= HARD * this.mostForce)) {
      const last = this.impacts.at(-1); // of hard contacts within 10 ms the hardest
      if (!last || contact.at - last.at > 0.01) this.impacts.push(contact);
      else if (contact.force > last.force) this.impacts[this.impacts.length - 1] = contact;
    }
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

  /** Drift of the storey below a floor over its yield drift, without what the foundation adds. */
  demand(building, floor, time) {
    const { heights, yield: limits } = this.buildings[building];
    const tilt = this.between(this.motions[building].rocking, time) * heights[floor - 1], limit = limits[floor - 1];
    return limit ? Math.abs(this.moved(building, floor, time) - this.moved(building, floor - 1, time) - tilt) / limit : 0;
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
        else if (!spell) spells.push((spell = { from: at, at, force }));
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
  const widest = Math.min(0.62 * tallest * up, ((width - 28) / count) * (count > 4 ? 0.85 : 0.72)), open = gaps.reduce((sum, gap) => sum + Math.max(gap, 0), 0);
  const fits = (one) => scene.mostMoved * one * up <= 0.45 * widest && open * one * up <= 0.25 * width;
  const chosen = scale ?? SCALES.filter(fits).at(-1) ?? 1, sideways = chosen * up;
  const between = gaps.map((gap) => (gap < 0 ? widest * 0.4 : gap * sideways)), apart = between.reduce((sum, one) => sum + one, 0);
  const wide = Math.max(8, Math.min(widest, (width - 28 - 2 * Math.min(scene.mostMoved * sideways, width * 0.2) - apart) / count));
  const starts = [(width - wide * count - apart) / 2];
  between.forEach((gap) => starts.push(starts.at(-1) + wide + gap));
  return { width, height, ground, up, sideways, scale: chosen, heights, gaps, wide, starts };
}

/** The colours of the page as the canvas needs them. */
function inks() {
  const style = getComputedStyle(document.documentElement), color = (name) => style.getPropertyValue(`--${name}`).trim();
  const named = ['ink', 'soft', 'line', 'card', 'flash', 'pull', 'slab', 'infill', 'earth', 'accent', 'bad'];
  return { ...Object.fromEntries(named.map((name) => [name, color(name)])), cases: Array.from({ length: 10 }, (_, number) => color(`case-${number}`)) };
}

/** An empty canvas as sharp as the screen, measured in CSS pixels. */
function sharp(canvas, width, height) {
  const dense = Math.min(devicePixelRatio || 1, 2);
  if (canvas.width !== Math.round(width * dense) || canvas.height !== Math.round(height * dense)) {
    [canvas.width, canvas.height, canvas.style.height] = [Math.round(width * dense), Math.round(height * dense), `${height}px`];
  }
  const pen = canvas.getContext('2d');
  pen.setTransform(dense, 0, 0, dense, 0, 0);
  pen.clearRect(0, 0, width, height);
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

/** Draw the buildings at a time; `glow`: force of every link over the largest one, fading after an impact. */
function drawStage(canvas, scene, at, time, glow, ink) {
  const pen = sharp(canvas, at.width, at.height), x = (building, floor) => at.starts[building] + scene.moved(building, floor, time) * at.sideways;
  const thick = scene.buildings.map(({ slab }, number) => Math.max(2, slab ? slab * at.up : Math.min(7, at.heights[number][1] * at.up * 0.12)));
  drawGround(pen, scene, at, time, ink);
  const faces = scene.links.map((link) => facesOf(at, link, x));
  scene.links.forEach((link, number) => drawLink(pen, scene, at, link, faces[number], thick[link.left], scene.between(scene.forces[number], time), ink));
  scene.buildings.forEach((_, number) => drawBuilding(pen, scene, at, number, time, x, thick[number], ink));
  const pressing = glow.map((each, number) => (scene.links[number].drawn === 'bar' ? 0 : each)), hardest = pressing.indexOf(Math.max(...pressing));
  pressing.forEach((each, number) => {
    if (!(each > 0.01)) return;
    const { left, right, y } = faces[number], link = scene.links[number], middle = (left + right) / 2; // a star as large and bright as the force
    const size = Math.min(5 + 22 * Math.sqrt(each), Math.max(scene.buildings[link.left].heights[Math.max(link.floor - 1, 0)] * at.up * 0.45, 6));
    pen.globalAlpha = Math.min(1, 0.3 + each);
    area(pen, ink.flash, Array.from({ length: 16 }, (_, ray) => [ray % 2 ? size * 0.42 : size, (ray * Math.PI) / 8]).map(([far, angle]) => [middle + far * Math.cos(angle), y + far * Math.sin(angle)]));
    pen.globalAlpha = 1;
    const force = scene.between(scene.forces[number], time);
    if (number !== hardest || each < 0.05 || !force) return; // nothing else would be legible in a low storey
    const text = `${asText(Math.abs(force) / 1e3, 3)} kN`;
    [pen.lineWidth, pen.lineJoin, pen.strokeStyle, pen.textAlign, pen.font] = [5, 'round', ink.card, 'center', '600 13px system-ui, sans-serif'];
    pen.strokeText(text, middle, y - size - 5);
    write(pen, ink.ink, text, middle, y - size - 5, 'center', '600 13px');
  });
}

function drawGround(pen, scene, at, time, ink) {
  for (let x = 0; x < at.width; x += 9) line(pen, ink.earth, 1, [[x, at.ground + 10], [x + 7, at.ground + 2]]);
  line(pen, ink.earth, 2, [[0, at.ground + 1], [at.width, at.ground + 1]]);
  const middle = at.width / 2, y = at.height - 18, end = middle + (scene.between(scene.ground, time) / (scene.mostGround || 1)) * Math.min(120, at.width * 0.25);
  line(pen, ink.accent, 3, [[middle, y], [end, y]]);
  if (Math.abs(end - middle) > 4) area(pen, ink.accent, [[end + Math.sign(end - middle) * 7, y], [end, y - 5], [end, y + 5]]);
  write(pen, ink.soft, 'ground acceleration', 2, y + 4, 'left');
}

function drawBuilding(pen, scene, at, number, time, x, thick, ink) {
  const heights = at.heights[number], y = (floor) => at.ground - heights[floor] * at.up, { sway, rocking } = scene.motions[number], middle = at.starts[number] + at.wide / 2;
  if (sway) {
    pen.save();
    pen.translate(x(number, 0) + at.wide / 2, at.ground - 3);
    pen.rotate(Math.max(-0.3, Math.min(0.3, scene.between(rocking, time) * at.scale)));
    pen.fillStyle = ink.soft;
    pen.fillRect(-at.wide * 0.55, -3, at.wide * 1.1, 6);
    pen.restore();
  }
  for (let floor = 1; floor < heights.length; floor++) {
    const yielding = scene.yields && scene.demand(number, floor, time) >= 1, third = (y(floor) - y(floor - 1)) / 3;
    [pen.strokeStyle, pen.lineWidth] = yielding ? [ink.bad, 3.4] : [ink.soft, 2];
    pen.beginPath();
    for (const post of at.wide > 60 ? [0.08, 0.5, 0.92] : [0.1, 0.9]) {
      const from = x(number, floor - 1) + post * at.wide, to = x(number, floor) + post * at.wide;
      pen.moveTo(from, y(floor - 1));
      pen.bezierCurveTo(from, y(floor - 1) + third, to, y(floor) - third, to, y(floor)); // clamped in both floors
    }
    pen.stroke();
  }
  pen.fillStyle = ink.slab;
  for (let floor = 1; floor < heights.length; floor++) {
    pen.fillRect(x(number, floor), y(floor) - thick / 2, at.wide, thick);
    for (const link of scene.links) { // where a floor's gap is narrower than the widest one of its pair, its slab reaches further
      const over = reach(at, link);
      if (link.left === number && link.floor === floor && link.left_at === 1) pen.fillRect(x(number, floor) + at.wide, y(floor) - thick / 2, over, thick);
      if (link.right === number && link.right_floor === floor && link.right_at === 1) pen.fillRect(x(number, floor) - over, y(floor) - thick / 2, over, thick);
    }
  }
  const { name, period } = scene.buildings[number];
  pen.font = '600 12.5px system-ui, sans-serif';
  if (pen.measureText(name).width >= at.wide * 1.15) return;
  write(pen, ink.ink, name, middle, at.ground + 25, 'center', '600 12.5px');
  write(pen, ink.soft, `${period.toFixed(2)} s`, middle, at.ground + 40);
}

/** By how much a slab reaches further; columns do not, so that the slab that strikes them does by all of it. */
const reach = (at, link) => ((at.gaps[link.left] - link.gap) / (link.left_at === link.right_at ? 2 : 1)) * at.sideways;

/** The two faces of a link, and its height in the drawing; it ends at floors, or on columns, clamped in both floors. */
function facesOf(at, link, x) {
  const over = reach(at, link), end = (building, floor, part) => x(building, floor - 1) + (x(building, floor) - x(building, floor - 1)) * part * part * (3 - 2 * part);
  const slab = link.left_at < 1 ? at.heights[link.right][link.right_floor] : at.heights[link.left][link.floor];
  return {
    left: end(link.left, link.floor, link.left_at) + at.wide + (link.left_at === 1 ? over : 0),
    right: end(link.right, link.right_floor, link.right_at) - (link.right_at === 1 ? over : 0), y: at.ground - slab * at.up,
  };
}

function drawLink(pen, scene, at, link, { left, right, y }, thick, force, ink) {
  if (link.drawn === 'filling') {
    pen.fillStyle = ink.infill; // it presses, it does not pull
    pen.fillRect(left, y - thick * 1.6, Math.max(Math.min(right, left + link.gap * at.sideways) - left, 1), thick * 3.2);
  } else if (link.drawn === 'bar') {
    line(pen, force < 0 ? ink.pull : ink.flash, 2 + 4 * Math.abs(force / (scene.mostForce || 1)), [[left - 5, y], [right + 5, y]]);
    for (const x of [left - 5, right + 5]) line(pen, ink.ink, 6, [[x, y], [x, y]]);
  }
}

// The strips under the buildings: ground motion, roofs, link forces, with a cursor at the present.

const STRIP = 56;

/** What the strips show: name, unit, series with colour, factor into the unit, and how far they go up and down. */
function stripsOf(scene, ink) {
  const roofs = scene.motions.map(({ floors }, number) => ({ series: floors.at(-1), color: ink.cases[number % 10], name: scene.buildings[number].name }));
  const strips = [{ name: 'ground acceleration', ...scene.acceleration, lines: [{ series: scene.ground, color: ink.accent }] }, { name: 'roofs', unit: 'mm', factor: 1e3, lines: roofs }];
  if (scene.forces.length) strips.push({ name: 'link forces', unit: 'kN', factor: 1e-3, lines: scene.forces.map((series) => ({ series, color: ink.flash })) });
  const most = ({ lines }, sign) => Math.max(...lines.map(({ series }) => series.reduce((one, value) => Math.max(one, sign * value || 0), 0)));
  return strips.map((strip) => ({ ...strip, up: most(strip, 1), down: most(strip, -1) }));
}

/** Draw the strips; pixels with many samples show their extremes, so that no impact is lost. */
function drawStrips(canvas, scene, strips, time, width, ink) {
  const low = STRIP * strips.length, pen = sharp(canvas, width, low + 18), x = (at) => (at / scene.end) * width;
  strips.forEach(({ name, unit, factor, lines, up, down }, number) => {
    const top = STRIP * number, room = STRIP - 22, zoom = room / (up + down || 1), middle = top + 18 + (up + down ? up * zoom : room / 2);
    line(pen, ink.line, 1, [[0, middle], [width, middle]]);
    for (const { series, color } of lines) {
      const points = Array.from({ length: Math.floor(width) }, (_, pixel) => {
        const first = Math.floor((pixel / width) * scene.count), here = series.subarray(first, Math.max(first + 1, Math.floor(((pixel + 1) / width) * scene.count)) + 1);
        return [[pixel, middle - Math.min(...here) * zoom], [pixel, middle - Math.max(...here) * zoom]];
      });
      line(pen, color, 1.2, points.flat());
    }
    write(pen, ink.ink, `${name}, up to ${asText(Math.max(up, down) * factor, 3)} ${unit}`, 2, top + 12, 'left');
    let right = width - 2;
    for (const each of lines.length > 1 && lines[0].name && width > 520 ? lines.toReversed() : []) {
      if (right < width * 0.45) break;
      write(pen, each.color, each.name, right, top + 12, 'right');
      right -= pen.measureText(each.name).width + 12;
    }
  });
  for (const tick of ticksBetween(0, scene.end, width / 90)) {
    write(pen, ink.soft, `${Number(tick.toPrecision(6))} s`, x(tick), low + 15, tick === 0 ? 'left' : x(tick) > width - 24 ? 'right' : 'center');
  }
  line(pen, ink.ink, 1.5, [[x(time), 0], [x(time), low]]);
}
