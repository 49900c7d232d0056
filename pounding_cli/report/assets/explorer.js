// Any quantity of the study over the height or over a swept key, a line a case: hover or arrow keys tell the numbers.

const TOP = 12, RIGHT = 16, BOTTOM = 46, HIGH = 400;

/** Round steps between two numbers, about `count` of them. */
function ticksBetween(low, high, count) {
  const power = 10 ** Math.floor(Math.log10((high - low) / Math.max(count, 1)));
  const step = [1, 2, 2.5, 5, 10].map((factor) => factor * power).find((one) => (high - low) / one <= count * 1.001) ?? 10 * power;
  const first = Math.ceil(low / step - 1e-9), last = Math.floor(high / step + 1e-9);
  return Array.from({ length: Math.max(last - first + 1, 0) }, (_, number) => Number(((first + number) * step).toPrecision(9)));
}

/** Where the values of an axis lie between two pixels, and its ticks as [value, text]; `named` : ticks that have names. */
function scale(values, from, to, named) {
  let low = Math.min(...values), high = Math.max(...values);
  const log = !named && low > 0 && high / low > 20;
  const room = log ? (high / low) ** 0.05 : named ? 0.5 : (high - low) * 0.05 || Math.abs(high) * 0.1 || 1;
  [low, high] = log ? [low / room, high * room] : [low - room, high + room];
  const share = log ? (value) => Math.log(value / low) / Math.log(high / low) : (value) => (value - low) / (high - low);
  const powers = Array.from({ length: 40 }, (_, number) => 10 ** (number - 20)).flatMap((power) => [1, 2, 5].map((factor) => factor * power));
  const ticks = named ?? (log ? powers.filter((tick) => tick > low && tick < high) : ticksBetween(low, high, Math.abs(to - from) / 75)).map((tick) => [tick, String(tick).replace('-', '−')]);
  return { place: (value) => from + share(value) * (to - from), ticks };
}

function explorer(box, { axes, quantities, names, void: voids, heights, thinned, building, point }) {
  const controls = document.getElementById('explorer-controls'), legend = document.getElementById('explorer-legend');
  if (!quantities.length) return void box.append(h('p', { class: 'nothing' }, 'Nothing to draw: no run of this study ended.'));
  const size = axes.reduce((all, one) => all * one.values.length, 1), looks = caseLooks(names.case), hidden = new Set();
  const longest = axes.reduce((most, one, number) => (one.values.length > (axes[most]?.values.length ?? 1) ? number : most), -1);
  const state = { quantity: 0, over: longest, analysis: 0, motion: 0, where: building, level: '', at: [...point] };
  const quantity = () => quantities[state.quantity];
  const levels = () => [...new Set(quantity().rows.map((row) => row[4]))].sort((one, other) => one - other);
  const numbered = (list) => list.map((text, number) => [number, text]);

  function arrange() {
    const one = quantity(), places = names[one.where];
    if (state.where !== '' && !places.includes(state.where)) state.where = one.where === 'pair' ? places[0] : building;
    const set = (name, kind = Number) => (value) => {
      state[name] = value === '' ? '' : kind(value);
      arrange();
      draw();
    };
    const shown = [choice('Quantity', numbered(quantities.map(({ label, text }) => (label.startsWith(text) ? label : `${label}: ${text}`))), state.quantity, set('quantity'))];
    const over = [...(heights ? [[-1, 'the height']] : []), ...numbered(axes.map(({ label }) => label))];
    if (!heights && state.over < 0) state.over = 0;
    if (over.length > 1) shown.push(choice('Over', over, state.over, set('over')));
    if (names.analysis.length > 1) shown.push(choice('Analysis', numbered(names.analysis), state.analysis, set('analysis')));
    if (names.motion.length > 1) shown.push(choice('Motion', numbered(names.motion), state.motion, set('motion')));
    const all = state.over < 0 ? [] : [['', 'largest of all']];
    if (state.over < 0 && state.where === '') state.where = building;
    if (places.length > 1) shown.push(choice(one.where === 'pair' ? 'Neighbours' : 'Building', [...all, ...places.map((name) => [name, name])], state.where, set('where', String)));
    if (state.over >= 0 && heights) shown.push(choice(one.level === 'storey' ? 'Storey' : 'Floor', [...all, ...levels().map((level) => [level, level])], state.level, set('level')));
    axes.forEach((axis, number) => {
      if (number !== state.over && axis.values.length > 1) shown.push(choice(axis.label, numbered(axis.names), state.at[number], (value) => {
        state.at[number] = Number(value);
        draw();
      }));
    });
    controls.replaceChildren(...shown);
  }

  /** What is drawn of some rows at a point: the largest of them, with spread and place in words. */
  function found(rows, at) {
    const one = quantity(), number = at.reduce((sum, place, axis) => sum * axes[axis].values.length + place, 0);
    const most = rows.reduce((best, row) => (Math.abs(one.mean[row * size + number] ?? -1) > Math.abs(one.mean[best * size + number] ?? -1) ? row : best), rows[0]);
    const value = one.mean[most * size + number];
    if (value === null || value === undefined) return null;
    const [kase, analysis, , where, level] = one.rows[most];
    const low = one.low[most * size + number] ?? value, high = one.high[most * size + number] ?? value;
    const empty = voids.find((each) => each.case === names.case[kase] && each.analysis === names.analysis[analysis] && each.count[number]);
    const place = [names[one.where][where], ...(level ? [`${one.level} ${level}`] : []), ...axes.map(({ names: texts, label }, axis) => `${label}: ${texts[at[axis]]}`)];
    const spread = low === high ? [] : [`motions from ${asText(low)} to ${asText(high)}`];
    return { value, low, high, level, void: Boolean(empty), said: [`${names.case[kase]}, ${place.join(', ')}`, `${one.label} ${asText(value)}`, ...spread, ...(empty ? [`not meaningful: ${empty.why}`] : [])] };
  }

  function series() {
    const one = quantity(), upward = state.over < 0;
    return names.case.map((name, kase) => {
      const rows = one.rows.flatMap((row, number) => (row[0] === kase && row[1] === state.analysis && row[2] === state.motion
        && (state.where === '' || names[one.where][row[3]] === state.where) && (upward || state.level === '' || row[4] === state.level) ? [number] : []));
      const points = hidden.has(kase) ? [] : upward ? rows.map((row) => found([row], state.at))
        : axes[state.over].values.map((_, place) => rows.length && found(rows, state.at.map((at, axis) => (axis === state.over ? place : at))));
      const along = (point, place) => (upward ? point.level : axes[state.over].numeric ? axes[state.over].values[place] : place + 1);
      return { name, look: looks[kase], points: points.map((point, place) => point && { ...point, along: along(point, place) }).filter(Boolean).sort((a, b) => a.along - b.along) };
    }).filter(({ points }) => points.length);
  }

  function draw() {
    const upward = state.over < 0, lines = series(), one = quantity(), every = lines.flatMap(({ points }) => points);
    lines.forEach(({ points }, number) => points.forEach((point) => Object.assign(point, { line: number })));
    box.replaceChildren();
    if (!every.length) return void box.append(h('p', { class: 'nothing' }, 'Nothing to draw: there is no number, or no case is selected.'));
    const wide = Math.max(box.clientWidth - 20, 240), ratio = /₀/.test(one.label);
    const axis = axes[state.over], named = upward || axis.numeric ? undefined : axis.names.map((text, place) => [place + 1, text.slice(0, 12)]);
    const floors = upward ? [...new Set(every.map(({ along }) => along))].map((level) => [level, String(level)]) : named;
    const values = [...every.flatMap(({ value, low, high }) => [value, low, high]), ...(ratio ? [1] : [])], places = every.map(({ along }) => along);
    const y = upward ? scale(places, HIGH - BOTTOM, TOP, floors) : scale(values, HIGH - BOTTOM, TOP);
    const left = 36 + 7 * Math.max(...y.ticks.map(([, text]) => text.length));
    const x = upward ? scale(values, left, wide - RIGHT) : scale(places, left, wide - RIGHT, named);
    const shift = ({ line: number = 0 }) => (number - (lines.length - 1) / 2) * Math.min(5, 24 / lines.length); // whiskers would hide each other
    const at = (point, value = point.value) => (upward ? [x.place(value), y.place(point.along) + shift(point)] : [x.place(point.along), y.place(value)]);
    const root = s('svg', { viewBox: `0 0 ${wide} ${HIGH}`, 'aria-hidden': 'true' });
    const line = (from, to, attributes) => root.append(s('line', { x1: from[0], y1: from[1], x2: to[0], y2: to[1], ...attributes }));
    const label = (text, px, py, attributes) => root.append(s('text', { x: px, y: py, 'text-anchor': 'middle', ...attributes }, text));
    let free = -Infinity;
    for (const [value, text] of x.ticks) {
      line([x.place(value), TOP], [x.place(value), HIGH - BOTTOM], { class: 'gridline' });
      if (x.place(value) - 4 * text.length < free) continue; // texts never run into each other
      free = x.place(value) + 4 * text.length;
      label(text, x.place(value), HIGH - BOTTOM + 18);
    }
    const few = Math.ceil(y.ticks.length / 16);
    y.ticks.forEach(([value, text], number) => {
      line([left, y.place(value)], [wide - RIGHT, y.place(value)], { class: 'gridline' });
      if (number % few === 0) label(text, left - 8, y.place(value) + 4, { 'text-anchor': 'end' });
    });
    const middle = (TOP + HIGH - BOTTOM) / 2, titles = upward ? [one.label, one.level] : [axis.label, one.label];
    label(titles[0], (left + wide - RIGHT) / 2, HIGH - 7, { class: 'title' });
    label(titles[1], 15, middle, { class: 'title', transform: `rotate(-90 15 ${middle})` });
    if (ratio) line(upward ? [x.place(1), TOP] : [left, y.place(1)], upward ? [x.place(1), HIGH - BOTTOM] : [wide - RIGHT, y.place(1)], { class: 'reference' });
    for (const { name, look, points } of lines) {
      const group = s('g', { 'data-series': name }), joined = !upward ? !named : points.every(({ along }, place) => !place || along === points[place - 1].along + 1);
      const style = `stroke:${look.color}`;
      for (const point of points) if (point.low !== point.high) line(at(point, point.low), at(point, point.high), { style, opacity: 0.5 });
      if (joined) group.append(s('polyline', { points: points.map((point) => at(point).map((number) => number.toFixed(1)).join(',')).join(' '), fill: 'none', 'stroke-width': 2, 'stroke-dasharray': look.dash, style }));
      group.append(...points.map((point) => filled(marker(look, ...at(point)), { class: point.void ? 'void' : '' }, [])));
      root.append(group);
    }
    box.append(root);
    tell(lines, at, root, upward);
  }

  /** The numbers of the point under the pointer, or of the one reached with the arrow keys. */
  function tell(lines, at, root, upward) {
    const tip = h('div', { class: 'tip', role: 'status', hidden: true }), every = lines.flatMap(({ points }) => points);
    box.append(tip);
    for (const [name, value] of Object.entries({ tabindex: 0, role: 'group', 'aria-roledescription': 'chart', 'aria-label': `${quantity().label}, a line a case. Arrow keys go from point to point.` })) box.setAttribute(name, value);
    const show = (point) => {
      const frame = root.getBoundingClientRect(), [px, py] = at(point);
      tip.replaceChildren(h('strong', {}, point.said[0]), ...point.said.slice(1).map((text) => h('span', {}, text)));
      tip.hidden = false;
      tip.style.left = `${Math.max(4, Math.min(px + 14, frame.width - tip.offsetWidth))}px`;
      tip.style.top = `${py + 18 + tip.offsetHeight > HIGH ? py - tip.offsetHeight - 4 : py + 22}px`;
    };
    let line = -1, place = 0;
    box.onpointermove = ({ clientX, clientY }) => {
      const frame = root.getBoundingClientRect(), away = (point) => Math.hypot(at(point)[0] - clientX + frame.left, at(point)[1] - clientY + frame.top);
      const nearest = every.reduce((one, other) => (away(other) < away(one) ? other : one));
      tip.hidden = away(nearest) > 40;
      if (!tip.hidden) show(nearest);
    };
    box.onpointerleave = box.onblur = () => {
      tip.hidden = true;
    };
    box.onkeydown = (event) => {
      const steps = upward ? { ArrowDown: -1, ArrowUp: 1 } : { ArrowLeft: -1, ArrowRight: 1 }, lineSteps = upward ? { ArrowLeft: -1, ArrowRight: 1 } : { ArrowUp: -1, ArrowDown: 1 };
      if (event.key === 'Escape') tip.hidden = true;
      if (!(event.key in steps) && !(event.key in lineSteps)) return;
      event.preventDefault();
      if (line < 0) line = 0;
      else if (event.key in steps) place += steps[event.key];
      else line = (line + lineSteps[event.key] + lines.length) % lines.length;
      place = Math.max(0, Math.min(place, lines[line].points.length - 1));
      show(lines[line].points[place]);
    };
  }

  names.case.forEach((name, kase) => {
    const check = h('input', { type: 'checkbox', checked: true, onchange: () => {
      if (check.checked) hidden.delete(kase);
      else hidden.add(kase);
      draw();
    } });
    const dash = s('line', { x1: 1, x2: 37, y1: 7, y2: 7, 'stroke-width': 2, 'stroke-dasharray': looks[kase].dash, style: `stroke:${looks[kase].color}` });
    legend.append(h('label', {}, check, s('svg', { viewBox: '0 0 38 14', 'aria-hidden': 'true' }, dash, marker(looks[kase], 19, 7)), name));
  });
  const cut = [...(heights ? [] : ['only the largest over the height']), ...(thinned > 1 ? [`every ${thinned}th point of its longest axes`] : [])];
  if (cut.length) box.after(h('p', { class: 'note' }, `This sweep is large: the page has ${cut.join(' and ')}; tables/ has all.`));
  controls.addEventListener('submit', (event) => event.preventDefault());
  arrange();
  drawnToWidth(box, draw);
}
