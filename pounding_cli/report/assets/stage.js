// A kept scene: its series, its impacts, and the drawing of its buildings and of the strips below them at one instant.

/** A contact is an impact from this share of the hardest one. */
const HARD = 0.1;

/** The series of one scene, read from base64 when first shown. */
class Scene {
  constructor(raw) {
    Object.assign(this, raw);
    const bytes = Uint8Array.from(atob(raw.series), (sign) => sign.charCodeAt(0));
    const all = new Float32Array(bytes.buffer);
    let next = 0;
    const take = () => all.subarray(next * this.count, ++next * this.count);
    this.ground = take();
    this.motions = raw.buildings.map((building) => {
      const floors = building.heights.map(take);
      return { floors, sway: building.foundation ? take() : null, rocking: building.foundation ? take() : null };
    });
    this.forces = raw.links.map(take);
    this.yields = raw.analysis !== 'elastic';
    this.end = (this.count - 1) * this.dt;
    const extremes = (series) => series.reduce((most, value) => Math.max(most, Math.abs(value) || 0), 0);
    this.mostGround = extremes(this.ground);
    this.mostMoved = Math.max(1e-9, ...this.motions.flatMap(({ floors }) => floors.map(extremes)));
    this.mostForce = Math.max(0, ...this.forces.map(extremes));
    this.contacts = this.findContacts();
    this.impacts = this.findImpacts();
  }

  /** Displacement of a floor (from 0) at a time between samples [m]. */
  moved(building, floor, time) {
    return this.between(this.motions[building].floors[floor], time);
  }

  between(series, time) {
    const place = Math.max(0, Math.min(time / this.dt, this.count - 1)), before = Math.floor(place);
    const after = Math.min(before + 1, this.count - 1);
    return series[before] + (series[after] - series[before]) * (place - before);
  }

  /** Drift of a storey (from 0) over its yield drift, without what the foundation adds. */
  demand(building, storey, time) {
    const { floors, sway, rocking } = this.motions[building];
    const below = storey ? this.between(floors[storey - 1], time) : sway ? this.between(sway, time) : 0;
    const tilt = rocking ? this.between(rocking, time) * this.buildings[building].heights[storey] : 0;
    const limit = this.buildings[building].yield[storey];
    return limit ? Math.abs(this.between(floors[storey], time) - below - tilt) / limit : 0;
  }

  /** Largest force of a link between two times, with its sign [N]: nothing is missed between two drawn frames. */
  force(link, from, to) {
    const series = this.forces[link];
    const first = Math.max(0, Math.min(Math.floor(from / this.dt), this.count - 1)), last = Math.min(Math.ceil(to / this.dt), this.count - 1);
    let most = 0;
    for (let place = first; place <= last; place++) if (Math.abs(series[place]) > Math.abs(most)) most = series[place];
    return most;
  }

  /** Contacts: spells in which a link that can open presses; from, to, at (its largest force) [s], force [N]. */
  findContacts() {
    const spells = [];
    this.forces.forEach((series, number) => {
      if (this.links[number].drawn === 'bar') return;
      let spell = null;
      for (let place = 0; place < this.count; place++) {
        const size = Math.abs(series[place]);
        if (!(size > 0)) spell = null;
        else if (!spell) spells.push((spell = { from: place * this.dt, to: place * this.dt, at: place * this.dt, force: size }));
        else {
          spell.to = place * this.dt;
          if (size > spell.force) [spell.force, spell.at] = [size, place * this.dt];
        }
      }
    });
    return spells.sort((one, other) => one.at - other.at);
  }

  /** Impacts for the buttons and for slow motion: hard contacts, of those within 10 ms the hardest. */
  findImpacts() {
    const found = [];
    for (const contact of this.contacts) {
      if (contact.force < HARD * this.mostForce) continue;
      const last = found.at(-1);
      if (!last || contact.at - last.at > 0.01) found.push(contact);
      else if (contact.force > last.force) found[found.length - 1] = contact;
    }
    return found;
  }
}

const SCALES = [1, 2, 3, 5, 7, 10, 15, 20, 30, 50, 70, 100, 150, 200, 300, 500, 700, 1000];

/** Where everything stands in a drawing of the given width: pixels a metre, widths, places. */
function layout(scene, width, scale) {
  const heights = scene.buildings.map(({ heights: each }) => each.reduce((all, one) => [...all, all.at(-1) + one], [0]));
  const tallest = Math.max(...heights.map((each) => each.at(-1)));
  const room = { top: 44, bottom: 74, side: 14 };
  const height = Math.round(Math.max(220, Math.min(440, width * 0.52, innerHeight - 560))); // strips and buttons fit below
  const up = (height - room.top - room.bottom) / tallest;
  const count = scene.buildings.length;
  const gaps = scene.buildings.slice(1).map((_, number) => {
    const own = scene.links.filter((link) => link.left === number);
    return own.length ? Math.max(...own.map((link) => link.gap)) : null;
  });
  const widest = Math.min(0.62 * tallest * up, ((width - 2 * room.side) / count) * (count > 4 ? 0.85 : 0.72));
  const fits = (one) => scene.mostMoved * one * up <= 0.45 * widest && gaps.reduce((sum, gap) => sum + (gap ?? 0), 0) * one * up <= 0.25 * width;
  const chosen = scale ?? SCALES.filter(fits).at(-1) ?? 1;
  const sideways = chosen * up;
  const between = gaps.map((gap) => (gap === null ? widest * 0.4 : gap * sideways));
  const swing = Math.min(scene.mostMoved * sideways, width * 0.2);
  const left = width - 2 * room.side - 2 * swing - between.reduce((sum, one) => sum + one, 0);
  const wide = Math.max(8, Math.min(widest, left / count));
  const whole = wide * count + between.reduce((sum, one) => sum + one, 0);
  const starts = [];
  let x = (width - whole) / 2;
  for (let number = 0; number < count; number++) {
    starts.push(x);
    x += wide + (between[number] ?? 0);
  }
  return { width, height, ground: height - room.bottom, up, sideways, scale: chosen, heights, gaps, wide, starts };
}

/** The colours of the page as the canvas needs them. */
function inks() {
  const style = getComputedStyle(document.documentElement);
  const named = ['ink', 'soft', 'line', 'card', 'flash', 'pull', 'slab', 'infill', 'earth', 'accent', 'bad'];
  const cases = Array.from({ length: 10 }, (_, number) => style.getPropertyValue(`--case-${number}`).trim());
  return { ...Object.fromEntries(named.map((name) => [name, style.getPropertyValue(`--${name}`).trim()])), cases };
}

/** Draw the buildings at a time; `glow`: force of every link over the largest one, fading after an impact. */
function drawStage(canvas, scene, at, time, glow, ink) {
  const pen = sharp(canvas, at.width, at.height);
  pen.clearRect(0, 0, at.width, at.height);
  pen.lineCap = 'round';
  drawGround(pen, scene, at, time, ink);
  scene.links.forEach((link, number) => drawLink(pen, scene, at, link, number, time, ink));
  scene.buildings.forEach((building, number) => drawBuilding(pen, scene, at, number, time, ink));
  scene.links.forEach((link, number) => drawFlash(pen, scene, at, link, glow[number], time, ink));
  drawForce(pen, scene, at, glow, time, ink);
}

/** A canvas as sharp as the screen, measured in CSS pixels. */
function sharp(canvas, width, height) {
  const dense = Math.min(devicePixelRatio || 1, 2);
  if (canvas.width !== Math.round(width * dense) || canvas.height !== Math.round(height * dense)) {
    canvas.width = Math.round(width * dense);
    canvas.height = Math.round(height * dense);
    canvas.style.height = `${height}px`;
  }
  const pen = canvas.getContext('2d');
  pen.setTransform(dense, 0, 0, dense, 0, 0);
  return pen;
}

function drawGround(pen, scene, at, time, ink) {
  pen.strokeStyle = ink.earth;
  pen.lineWidth = 1;
  pen.beginPath();
  for (let x = 0; x < at.width; x += 9) {
    pen.moveTo(x, at.ground + 10);
    pen.lineTo(x + 7, at.ground + 2);
  }
  pen.stroke();
  pen.lineWidth = 2;
  pen.beginPath();
  pen.moveTo(0, at.ground + 1);
  pen.lineTo(at.width, at.ground + 1);
  pen.stroke();
  const push = scene.between(scene.ground, time) / (scene.mostGround || 1), middle = at.width / 2, y = at.height - 18;
  const reach = push * Math.min(120, at.width * 0.25);
  pen.strokeStyle = pen.fillStyle = ink.accent;
  pen.lineWidth = 3;
  pen.beginPath();
  pen.moveTo(middle, y);
  pen.lineTo(middle + reach, y);
  pen.stroke();
  if (Math.abs(reach) > 4) {
    const tip = Math.sign(reach) * 7;
    pen.beginPath();
    pen.moveTo(middle + reach + tip, y);
    pen.lineTo(middle + reach, y - 5);
    pen.lineTo(middle + reach, y + 5);
    pen.fill();
  }
  pen.fillStyle = ink.soft;
  pen.font = '12px system-ui, sans-serif';
  pen.textAlign = 'left';
  pen.fillText('ground acceleration', 2, y + 4);
}

const floorX = (scene, at, building, floor, time) => at.starts[building] + scene.moved(building, floor, time) * at.sideways;
const slabThick = (scene, at, building) => {
  const { slab } = scene.buildings[building];
  return slab ? Math.max(2, slab * at.up) : Math.max(2, Math.min(7, ((at.heights[building][1] ?? 3) * at.up) * 0.12));
};

function drawBuilding(pen, scene, at, number, time, ink) {
  const heights = at.heights[number], thick = slabThick(scene, at, number), { sway, rocking } = scene.motions[number];
  const foot = at.starts[number] + (sway ? scene.between(sway, time) * at.sideways : 0);
  let below = foot;
  const posts = at.wide > 60 ? [0.08, 0.5, 0.92] : [0.1, 0.9];
  if (sway) {
    pen.save();
    pen.translate(foot + at.wide / 2, at.ground - 3);
    pen.rotate(Math.max(-0.3, Math.min(0.3, scene.between(rocking, time) * at.scale)));
    pen.fillStyle = ink.soft;
    pen.fillRect(-at.wide * 0.55, -3, at.wide * 1.1, 6);
    pen.restore();
  }
  for (let storey = 0; storey < heights.length - 1; storey++) {
    const low = at.ground - heights[storey] * at.up, high = at.ground - heights[storey + 1] * at.up;
    const here = floorX(scene, at, number, storey, time), yielding = scene.yields && scene.demand(number, storey, time) >= 1;
    pen.strokeStyle = yielding ? ink.bad : ink.soft;
    pen.lineWidth = yielding ? 3.4 : 2;
    pen.beginPath();
    for (const post of posts) {
      const from = below + post * at.wide, to = here + post * at.wide, third = (high - low) / 3;
      pen.moveTo(from, low);
      pen.bezierCurveTo(from, low + third, to, high - third, to, high); // clamped in both floors
    }
    pen.stroke();
    below = here;
  }
  pen.fillStyle = ink.slab;
  for (let floor = 0; floor < heights.length - 1; floor++) {
    const x = floorX(scene, at, number, floor, time), y = at.ground - heights[floor + 1] * at.up;
    pen.fillRect(x, y - thick / 2, at.wide, thick);
    for (const [side, over] of overhangs(scene, at, number, floor + 1)) {
      pen.fillRect(side === 'right' ? x + at.wide : x - over, y - thick / 2, over, thick);
    }
  }
  pen.fillStyle = ink.ink;
  pen.textAlign = 'center';
  pen.font = '600 12.5px system-ui, sans-serif';
  const { name, period } = scene.buildings[number];
  const middle = at.starts[number] + at.wide / 2;
  if (pen.measureText(name).width < at.wide * 1.15) {
    pen.fillText(name, middle, at.ground + 25);
    pen.font = '12px system-ui, sans-serif';
    pen.fillStyle = ink.soft;
    const text = `${period.toFixed(2)} s`;
    if (pen.measureText(text).width < at.wide) pen.fillText(text, middle, at.ground + 40);
  }
}

/** Where a floor's gap is narrower than the widest one of its pair, its slab reaches further. */
function overhangs(scene, at, building, floor) {
  const found = [];
  for (const link of scene.links) {
    const over = reach(at, link);
    if (over <= 0) continue;
    if (link.left === building && link.floor === floor && link.left_at === 1) found.push(['right', over]);
    if (link.left + 1 === building && link.right_floor === floor && link.right_at === 1) found.push(['left', over]);
  }
  return found;
}

/** By how much a slab reaches further; columns do not, so that the slab that strikes them does by all of it. */
const reach = (at, link) => ((at.gaps[link.left] - link.gap) / (link.left_at === link.right_at ? 2 : 1)) * at.sideways;

/** The two faces of a link at a time, and its height in the drawing. */
function faces(scene, at, link, time) {
  const over = reach(at, link);
  const slab = link.left_at < 1 ? [link.right, link.right_floor] : [link.left, link.floor];
  return {
    left: endX(scene, at, link.left, link.floor - 1, link.left_at, time) + at.wide + (link.left_at === 1 ? over : 0),
    right: endX(scene, at, link.right, link.right_floor - 1, link.right_at, time) - (link.right_at === 1 ? over : 0),
    y: at.ground - at.heights[slab[0]][slab[1]] * at.up,
  };
}

/** Where a link ends on its building: at a floor, or on the columns below it, clamped in both floors. */
function endX(scene, at, building, floor, part, time) {
  const above = floorX(scene, at, building, floor, time);
  if (part === 1) return above;
  const { sway } = scene.motions[building];
  const foot = at.starts[building] + (sway ? scene.between(sway, time) * at.sideways : 0);
  const below = floor ? floorX(scene, at, building, floor - 1, time) : foot;
  return below + (above - below) * part * part * (3 - 2 * part);
}

function drawLink(pen, scene, at, link, number, time, ink) {
  const { left, right, y } = faces(scene, at, link, time), thick = slabThick(scene, at, link.left);
  if (link.drawn === 'filling') {
    const end = Math.min(right, left + link.gap * at.sideways); // it presses, it does not pull
    pen.fillStyle = ink.infill;
    pen.fillRect(left, y - thick * 1.6, Math.max(end - left, 1), thick * 3.2);
  } else if (link.drawn === 'bar') {
    const force = scene.between(scene.forces[number], time);
    pen.strokeStyle = force < 0 ? ink.pull : ink.flash;
    pen.lineWidth = 2 + 4 * Math.abs(force / (scene.mostForce || 1));
    pen.beginPath();
    pen.moveTo(left - 5, y);
    pen.lineTo(right + 5, y);
    pen.stroke();
    pen.fillStyle = ink.ink;
    for (const x of [left - 5, right + 5]) {
      pen.beginPath();
      pen.arc(x, y, 3, 0, 7);
      pen.fill();
    }
  }
}

/** A star where two floors press, as large and bright as their force. */
function drawFlash(pen, scene, at, link, glow, time, ink) {
  if (link.drawn === 'bar' || !(glow > 0.01)) return;
  const { x, y, size } = star(scene, at, link, glow, time);
  pen.save();
  pen.globalAlpha = Math.min(1, 0.3 + glow);
  pen.fillStyle = ink.flash;
  pen.beginPath();
  for (let ray = 0; ray < 16; ray++) {
    const far = ray % 2 ? size * 0.42 : size, angle = (ray * Math.PI) / 8;
    pen.lineTo(x + far * Math.cos(angle), y + far * Math.sin(angle));
  }
  pen.fill();
  pen.restore();
}

function star(scene, at, link, glow, time) {
  const { left, right, y } = faces(scene, at, link, time);
  const storey = scene.buildings[link.left].heights[link.floor - 1] * at.up;
  return { x: (left + right) / 2, y, size: Math.min(5 + 22 * Math.sqrt(glow), Math.max(storey * 0.45, 6)) };
}

/** The force beside the star of the hardest link; nothing else would be legible in a low storey. */
function drawForce(pen, scene, at, glow, time, ink) {
  const pressing = scene.links.map((link, number) => (link.drawn === 'bar' ? 0 : glow[number]));
  const number = pressing.indexOf(Math.max(...pressing));
  const force = number < 0 ? 0 : scene.between(scene.forces[number], time);
  if (!(pressing[number] > 0.05) || force === 0) return;
  const { x, y, size } = star(scene, at, scene.links[number], glow[number], time);
  const text = `${asText(Math.abs(force) / 1e3, 3)} kN`;
  pen.font = '600 13px system-ui, sans-serif';
  pen.textAlign = 'center';
  pen.lineWidth = 5;
  pen.lineJoin = 'round';
  pen.strokeStyle = ink.card;
  pen.strokeText(text, x, y - size - 5);
  pen.fillStyle = ink.ink;
  pen.fillText(text, x, y - size - 5);
}

// The strips under the buildings: ground motion, roofs, link forces, with a cursor at the present.

const STRIP = 56;

/** What the strips show: name, unit, series with colour, factor into the unit. */
function stripsOf(scene, ink) {
  const roofs = scene.motions.map(({ floors }, number) => ({ series: floors.at(-1), color: ink.cases[number % 10], name: scene.buildings[number].name }));
  const strips = [
    { name: 'ground acceleration', ...scene.acceleration, lines: [{ series: scene.ground, color: ink.accent, name: '' }] },
    { name: 'roofs', unit: 'mm', factor: 1e3, lines: roofs },
  ];
  if (scene.forces.length) {
    strips.push({ name: 'link forces', unit: 'kN', factor: 1e-3, lines: scene.forces.map((series) => ({ series, color: ink.flash, name: '' })) });
  }
  for (const strip of strips) {
    const of = (sign) => Math.max(...strip.lines.map(({ series }) => series.reduce((most, value) => Math.max(most, sign * value || 0), 0)));
    strip.up = of(1);
    strip.down = of(-1);
    strip.most = Math.max(strip.up, strip.down);
  }
  return strips;
}

/** Draw the strips; pixels with many samples show their extremes, so that no impact is lost. */
function drawStrips(canvas, scene, strips, time, width, ink) {
  const pen = sharp(canvas, width, STRIP * strips.length + 18);
  pen.clearRect(0, 0, width, STRIP * strips.length + 18);
  const x = (at) => (at / scene.end) * width;
  strips.forEach((strip, number) => {
    const high = STRIP * number + 18, room = STRIP - 22, zoom = room / (strip.up + strip.down || 1);
    const middle = high + (strip.up + strip.down ? strip.up * zoom : room / 2);
    pen.strokeStyle = ink.line;
    pen.lineWidth = 1;
    pen.beginPath();
    pen.moveTo(0, middle);
    pen.lineTo(width, middle);
    pen.stroke();
    for (const { series, color } of strip.lines) trace(pen, scene, series, width, (value) => middle - value * zoom, color);
    pen.fillStyle = ink.ink;
    pen.font = '12px system-ui, sans-serif';
    pen.textAlign = 'left';
    pen.fillText(`${strip.name}, up to ${asText(strip.most * strip.factor, 3)} ${strip.unit}`, 2, STRIP * number + 12);
    if (strip.lines.length > 1 && strip.lines[0].name && width > 520) names(pen, strip.lines, width, STRIP * number + 12);
  });
  pen.fillStyle = ink.soft;
  pen.font = '12px system-ui, sans-serif';
  for (const tick of ticksBetween(0, scene.end, width / 90)) {
    pen.textAlign = tick === 0 ? 'left' : x(tick) > width - 24 ? 'right' : 'center';
    pen.fillText(`${Number(tick.toPrecision(6))} s`, x(tick), STRIP * strips.length + 15);
  }
  pen.strokeStyle = ink.ink;
  pen.lineWidth = 1.5;
  pen.beginPath();
  pen.moveTo(x(time), 0);
  pen.lineTo(x(time), STRIP * strips.length);
  pen.stroke();
}

function names(pen, lines, width, y) {
  let right = width - 2;
  pen.textAlign = 'right';
  for (const { name, color } of [...lines].reverse()) {
    if (right < width * 0.45) return;
    pen.fillStyle = color;
    pen.fillText(name, right, y);
    right -= pen.measureText(name).width + 12;
  }
}

function trace(pen, scene, series, width, y, color) {
  pen.strokeStyle = color;
  pen.lineWidth = 1.2;
  pen.beginPath();
  for (let pixel = 0; pixel < width; pixel++) {
    const first = Math.floor((pixel / width) * scene.count), last = Math.max(first + 1, Math.floor(((pixel + 1) / width) * scene.count));
    const here = series.subarray(first, Math.min(last + 1, scene.count));
    pen.lineTo(pixel, y(Math.min(...here)));
    pen.lineTo(pixel, y(Math.max(...here)));
  }
  pen.stroke();
}
