// A chart of lines with markers and whiskers: axes, hover, keyboard.

/** Round steps between two numbers, about `count` of them. */
function ticksBetween(low, high, count) {
  const raw = (high - low) / Math.max(count, 1);
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 2.5, 5, 10].map((factor) => factor * power).find((one) => one >= raw * 0.999);
  const ticks = [];
  for (let number = Math.ceil(low / step - 1e-9); number * step <= high + step * 1e-9; number++) ticks.push(number * step);
  return ticks;
}

function ticksLog(low, high) {
  const ticks = [];
  for (let power = Math.floor(Math.log10(low)); power <= Math.ceil(Math.log10(high)); power++) {
    for (const factor of [1, 2, 5]) {
      const tick = factor * 10 ** power;
      if (tick >= low * 0.999 && tick <= high * 1.001) ticks.push(tick);
    }
  }
  return ticks.length > 8 ? ticks.filter((tick) => Math.abs(Math.log10(tick) % 1) < 1e-9) : ticks;
}

const tickText = (value) => asText(Number(value.toPrecision(6)), 1, true).length > 7
  ? asText(value, 2) : String(Number(value.toPrecision(6))).replace('-', '−');

/** An axis: where its numbers lie between two pixels, and its ticks. `spec`: label, values, log, zero, ticks, names. */
function axis(spec, from, to) {
  const known = spec.values.filter((value) => value !== null && Number.isFinite(value));
  let low = Math.min(...known), high = Math.max(...known);
  if (spec.ticks) {
    const place = (value) => from + ((value - spec.low) / (spec.high - spec.low)) * (to - from);
    return { place, ticks: spec.ticks.map((value, number) => [value, spec.names ? spec.names[number] : String(value)]) };
  }
  const log = spec.log ?? (low > 0 && high / low > 8);
  if (log) {
    const room = (high / low) ** 0.05 || 1.1;
    [low, high] = low === high ? [low / 1.5, high * 1.5] : [low / room, high * room];
    const place = (value) => from + (Math.log(value / low) / Math.log(high / low)) * (to - from);
    return { place, ticks: ticksLog(low, high).map((value) => [value, tickText(value)]) };
  }
  if (spec.zero && low > 0) low = 0;
  const room = (high - low) * 0.05 || Math.abs(high) * 0.1 || 1;
  low = spec.zero && low === 0 ? 0 : low - room;
  high += room;
  const place = (value) => from + ((value - low) / (high - low)) * (to - from);
  return { place, ticks: ticksBetween(low, high, Math.abs(to - from) / 75).map((value) => [value, tickText(value)]) };
}

/**
 * Draw a chart into `box`; called again it draws anew.
 *
 * chart : {label, height, x, y, along, reference, series: [{name, look, joined, points: [{x, y, low, high, said}]}]}
 * along : 'y' where a series runs upwards (whiskers lie), 'x' where it runs to the right
 * said : lines of text for a point, the first one in bold
 */
function drawChart(box, chart) {
  const width = Math.max(box.clientWidth - parseFloat(getComputedStyle(box).paddingLeft) * 2, 240);
  const margin = { left: 0, right: 16, top: 12, bottom: 46 };
  const points = chart.series.flatMap((one, number) => one.points.map((point, place) => ({ ...point, series: number, place })));
  box.replaceChildren();
  if (!points.length) {
    box.append(h('p', { class: 'nothing' }, 'Nothing to draw: there is no number, or no case is selected.'));
    box.removeAttribute('tabindex');
    return;
  }
  const ends = points.flatMap((point) => [point.low, point.high]);
  const across = chart.along === 'y' ? 'x' : 'y';
  const specs = { x: { ...chart.x }, y: { ...chart.y } };
  specs[across].values = [...points.map((point) => point[across]), ...ends, ...(chart.reference === undefined ? [] : [chart.reference])];
  specs[chart.along].values = points.map((point) => point[chart.along]);
  const y = axis(specs.y, chart.height - margin.bottom, margin.top);
  margin.left = 36 + 7 * Math.max(...y.ticks.map(([, text]) => text.length)); // room for the title beside the ticks
  const x = axis(specs.x, margin.left, width - margin.right);
  const root = s('svg', { viewBox: `0 0 ${width} ${chart.height}`, 'aria-hidden': 'true' });
  drawAxes(root, x, y, chart, width, margin);
  if (chart.reference !== undefined) {
    const at = chart.along === 'y'
      ? { x1: x.place(chart.reference), x2: x.place(chart.reference), y1: margin.top, y2: chart.height - margin.bottom }
      : { x1: margin.left, x2: width - margin.right, y1: y.place(chart.reference), y2: y.place(chart.reference) };
    root.append(s('line', { class: 'reference', ...at }));
  }
  if (chart.cells) drawCells(root, chart, x, y);
  else for (const one of chart.series) drawSeries(root, one, x, y, chart.along);
  box.append(root);
  bindPoints(box, root, points, chart, x, y);
}

function drawAxes(root, x, y, chart, width, margin) {
  const bottom = chart.height - margin.bottom;
  let last = -Infinity;
  for (const [value, text] of x.ticks) {
    const at = x.place(value);
    root.append(s('line', { class: 'gridline', x1: at, x2: at, y1: margin.top, y2: bottom }));
    const half = text.length * 3.6;
    if (at - half < last) continue; // texts never run into each other
    last = at + half + 6;
    root.append(s('text', { x: at, y: bottom + 18, 'text-anchor': 'middle' }, text));
  }
  last = Infinity;
  for (const [value, text] of y.ticks) {
    const at = y.place(value);
    root.append(s('line', { class: 'gridline', x1: margin.left, x2: width - margin.right, y1: at, y2: at }));
    if (at + 15 > last) continue;
    last = at;
    root.append(s('text', { x: margin.left - 8, y: at + 4, 'text-anchor': 'end' }, text));
  }
  root.append(s('line', { class: 'axisline', x1: margin.left, x2: width - margin.right, y1: bottom, y2: bottom }));
  root.append(s('line', { class: 'axisline', x1: margin.left, x2: margin.left, y1: margin.top, y2: bottom }));
  root.append(s('text', { class: 'title', x: (margin.left + width - margin.right) / 2, y: chart.height - 7, 'text-anchor': 'middle' }, chart.x.label));
  const middle = (margin.top + bottom) / 2;
  root.append(s('text', { class: 'title', x: 15, y: middle, transform: `rotate(-90 15 ${middle})`, 'text-anchor': 'middle' }, chart.y.label));
}

/** The cells of a map: a colour, the number where it fits, a cross where it is not meaningful. */
function drawCells(root, chart, x, y) {
  const [columns, lines] = chart.cells;
  const wide = Math.abs(x.place(2) - x.place(1)) || 1, high = Math.abs(y.place(2) - y.place(1)) || 1;
  for (const point of chart.series.flatMap(({ points }) => points)) {
    const left = x.place(point.x) - wide / 2, top = y.place(point.y) - high / 2;
    root.append(s('rect', { x: left, y: top, width: wide + 0.5, height: high + 0.5, style: `fill:${point.fill}` }));
    const ink = `fill:${point.dark ? '#ffffff' : '#1b1f24'};stroke:${point.dark ? '#ffffff' : '#1b1f24'}`;
    if (point.void) root.append(s('path', { class: 'void', d: `M${left} ${top}l${wide} ${high}m0 ${-high}l${-wide} ${high}`, style: ink }));
    else if (wide > 7.5 * point.text.length && high > 16 && columns * lines <= 400) {
      root.append(s('text', { class: 'cell', x: left + wide / 2, y: top + high / 2 + 4, 'text-anchor': 'middle', style: `${ink};stroke:none` }, point.text));
    }
  }
}

function drawSeries(root, one, x, y, along) {
  const group = s('g', { 'data-series': one.name });
  const shift = one.shift ?? 0; // whiskers of neighbouring series would hide each other
  const at = (point) => (along === 'y' ? [x.place(point.x), y.place(point.y) + shift] : [x.place(point.x) + shift, y.place(point.y)]);
  for (const point of one.points) {
    if (point.low === null || point.low === undefined || point.low === point.high) continue;
    const [px, py] = at(point);
    const ends = along === 'y' ? { x1: x.place(point.low), x2: x.place(point.high), y1: py, y2: py } : { x1: px, x2: px, y1: y.place(point.low), y2: y.place(point.high) };
    group.append(s('line', { ...ends, 'stroke-width': 1.1, opacity: 0.6, style: `stroke:${one.look.color}` }));
  }
  if (one.joined && one.points.length > 1) {
    const path = one.points.map((point) => at(point).map((number) => number.toFixed(1)).join(',')).join(' ');
    group.append(s('polyline', { points: path, fill: 'none', 'stroke-width': 2, 'stroke-dasharray': one.look.dash, style: `stroke:${one.look.color}` }));
  }
  for (const point of one.points) {
    const drawn = marker(one.look.marker, ...at(point), 4.3, one.look.color);
    if (point.void) {
      drawn.classList.add('void'); // hollow
      drawn.style.stroke = one.look.color;
    }
    group.append(drawn);
  }
  root.append(group);
}

/** Show the numbers of the point under the pointer, or of the one reached with the arrow keys. */
function bindPoints(box, root, points, chart, x, y) {
  const tip = h('div', { class: 'tip', hidden: true });
  const halo = s('circle', { class: 'halo', r: 8, visibility: 'hidden' });
  root.append(halo);
  box.append(tip);
  box.setAttribute('tabindex', '0');
  box.setAttribute('role', 'group');
  box.setAttribute('aria-roledescription', 'chart');
  box.setAttribute('aria-label', `${chart.label}. Arrow keys go from point to point.`);
  const place = (point) => {
    const shift = chart.series[point.series].shift ?? 0;
    return [x.place(point.x) + (chart.along === 'x' ? shift : 0), y.place(point.y) + (chart.along === 'y' ? shift : 0)];
  };
  const show = (point, aloud) => {
    const [px, py] = place(point);
    const inside = root.getBoundingClientRect(), outside = box.getBoundingClientRect();
    const zoom = inside.width / root.viewBox.baseVal.width;
    halo.setAttribute('cx', px);
    halo.setAttribute('cy', py);
    halo.setAttribute('visibility', 'visible');
    tip.replaceChildren(h('strong', {}, point.said[0]), ...point.said.slice(1).map((line) => h('span', {}, line)));
    tip.hidden = false;
    const left = inside.left - outside.left + px * zoom, top = inside.top - outside.top + py * zoom;
    tip.style.left = `${Math.max(4, Math.min(left + 14, outside.width - tip.offsetWidth - 4))}px`;
    tip.style.top = `${top + 18 + tip.offsetHeight > outside.height ? top - tip.offsetHeight - 14 : top + 18}px`;
    if (aloud) say(point.said.join(', '));
  };
  const hide = () => {
    tip.hidden = true;
    halo.setAttribute('visibility', 'hidden');
  };
  let current = null;
  box.onpointermove = (event) => {
    const frame = root.getBoundingClientRect();
    const zoom = frame.width / root.viewBox.baseVal.width;
    const px = (event.clientX - frame.left) / zoom, py = (event.clientY - frame.top) / zoom;
    let nearest = null, least = chart.cells ? Infinity : 40 ** 2;
    for (const point of points) {
      const [qx, qy] = place(point);
      const distance = (px - qx) ** 2 + (py - qy) ** 2;
      if (distance < least) [nearest, least] = [point, distance];
    }
    if (nearest) show(nearest, false);
    else hide();
  };
  box.onpointerleave = hide;
  box.onblur = hide;
  box.onkeydown = (event) => {
    const back = chart.along === 'y' ? 'ArrowDown' : 'ArrowLeft', on = chart.along === 'y' ? 'ArrowUp' : 'ArrowRight';
    const [before, after] = chart.along === 'y' ? ['ArrowLeft', 'ArrowRight'] : chart.cells ? ['ArrowDown', 'ArrowUp'] : ['ArrowUp', 'ArrowDown'];
    if (event.key === 'Escape') return hide();
    if (![back, on, before, after].includes(event.key)) return undefined;
    event.preventDefault();
    const there = chart.series.map((one, number) => number).filter((number) => chart.series[number].points.length);
    if (current === null) current = { series: there[0], place: 0 };
    else if (event.key === back || event.key === on) current.place += event.key === on ? 1 : -1;
    else current.series = there[(there.indexOf(current.series) + (event.key === after ? 1 : -1) + there.length) % there.length];
    current.place = Math.max(0, Math.min(current.place, chart.series[current.series].points.length - 1));
    show({ ...chart.series[current.series].points[current.place], series: current.series }, true);
    return undefined;
  };
}

/** Draw now, and again whenever the width of the box changes. */
function drawnToWidth(box, draw) {
  let width = 0;
  new ResizeObserver(() => {
    if (Math.abs(box.clientWidth - width) < 2) return;
    width = box.clientWidth;
    draw();
  }).observe(box);
}
