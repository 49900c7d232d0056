// Any quantity of the study over the height or over a swept key, a line a case: hover or arrow keys tell the numbers.

/** The labels of the choices of places. */
const WHERE = { building: 'Building', pair: 'Neighbours', 'frame line': 'Frame line' };
const TOP = 12, RIGHT = 16, BOTTOM = 46, HIGH = 400;

function explorer(box, { axes, quantities, cases, looks, analyses, motions, void: voids, heights, building, point }) {
  const controls = document.getElementById('explorer-controls'), legend = document.getElementById('explorer-legend');
  const points = axes.reduce((all, one) => all * one.values.length, 1), hidden = new Set();
  const longest = axes.reduce((most, one, number) => (one.values.length > (axes[most]?.values.length ?? 1) ? number : most), heights ? -1 : 0);
  const state = { quantity: 0, over: longest, analysis: 0, motion: 0, place: building, level: '', at: [...point] };
  const quantity = () => quantities[state.quantity], numbered = (list) => list.map((text, number) => [number, text]);

  function arrange() {
    const one = quantity(), swept = state.over >= 0;
    if (!one.places.includes(state.place) && (state.place !== '' || !swept)) state.place = one.places.includes(building) ? building : one.places[0];
    const set = (name, kind = Number) => (value) => {
      state[name] = value === '' ? '' : kind(value);
      arrange();
    };
    const all = swept ? [['', 'largest of all']] : [], shown = [];
    const offer = (wanted, ...rest) => wanted && shown.push(choice(...rest));
    offer(true, 'Quantity', numbered(quantities.map(({ label, text }) => (label.startsWith(text) ? label : `${label}: ${text}`))), state.quantity, set('quantity'));
    offer(axes.length, 'Over', [...(heights ? [[-1, 'the height']] : []), ...numbered(axes.map(({ label }) => label))], state.over, set('over'));
    offer(analyses.length > 1, 'Analysis', numbered(analyses), state.analysis, set('analysis'));
    offer(motions.length > 1, 'Motion', numbered(motions), state.motion, set('motion'));
    offer(one.places.length > 1, WHERE[one.where], [...all, ...one.places.map((name) => [name, name])], state.place, set('place', String));
    offer(swept && heights, one.level === 'storey' ? 'Storey' : 'Floor', [...all, ...one.levels.map((level) => [level, level || 'base'])], state.level, set('level'));
    axes.forEach((axis, number) => offer(number !== state.over && axis.values.length > 1, axis.label, numbered(axis.names), state.at[number], (value) => {
      state.at[number] = Number(value);
      draw();
    }));
    controls.replaceChildren(...shown);
    draw();
  }

  /** One line a case: its points with value, ends, place along the axis, and what is said of them. */
  function series() {
    const one = quantity(), upward = state.over < 0, { levels, places } = one;
    const told = (kase, place, level, at) => {
      const number = axes.reduce((all, axis, n) => all * axis.values.length + at[n], 0);
      const index = (count, motion) => ((((kase * count + motion) * analyses.length + state.analysis) * places.length + place) * levels.length + level) * points + number;
      const value = one.mean[index(motions.length, state.motion)] ?? null;
      if (value === null) return null;
      const [low, high] = state.motion ? [value, value] : [one.low[index(1, 0)], one.high[index(1, 0)]], empty = voids[(kase * analyses.length + state.analysis) * points + number] > 0;
      const where = [places[place], ...(heights ? [levels[level] ? `${one.level} ${levels[level]}` : 'base'] : []), ...axes.map(({ names, label }, n) => `${label}: ${names[at[n]]}`)];
      const said = [`${cases[kase]}, ${where.join(', ')}`, `${one.label} ${asText(value)}`];
      if (low !== high) said.push(`motions from ${asText(low)} to ${asText(high)}`);
      if (empty) said.push('not meaningful: a run is flagged');
      return { value, low, high, said, void: empty, along: upward ? levels[level] : axes[state.over].values[at[state.over]] };
    };
    const here = places.flatMap((_, place) => levels.map((_, level) => [place, level]))
      .filter(([place, level]) => (state.place === '' || places[place] === state.place) && (upward || state.level === '' || levels[level] === state.level));
    return cases.map((name, kase) => {
      const largest = (at) => here.map((each) => told(kase, ...each, at)).reduce((most, next) => (next && !(Math.abs(next.value) <= Math.abs(most?.value)) ? next : most), null);
      const found = hidden.has(kase) ? [] : upward ? here.map((each) => told(kase, ...each, state.at)) : axes[state.over].values.map((_, place) => largest(state.at.with(state.over, place)));
      return { name, look: looks[kase], points: found.filter(Boolean).sort((a, b) => a.along - b.along) };
    }).filter((line) => line.points.length);
  }

  function draw() {
    const lines = series(), one = quantity(), upward = state.over < 0, every = lines.flatMap((line) => line.points);
    box.replaceChildren();
    if (!every.length) return void box.append(h('p', { class: 'nothing' }, 'Nothing to draw here: the runs have no such number, or no case is selected.'));
    const wide = Math.max(box.clientWidth - 20, 240), ratio = /₀/.test(one.label), axis = axes[state.over];
    const named = upward ? one.levels.map((level) => [level, String(level || 'base')]) : axis.numeric ? undefined : axis.names.map((text, place) => [place + 1, text.slice(0, 12)]);
    const values = [...every.flatMap(({ value, low, high }) => [value, low, high]), ...(ratio ? [1] : [])], places = upward ? one.levels : every.map(({ along }) => along);
    const y = upward ? scale(places, HIGH - BOTTOM, TOP, named) : scale(values, HIGH - BOTTOM, TOP);
    const left = 36 + 7 * Math.max(...y.ticks.map(([, text]) => text.length));
    const x = upward ? scale(values, left, wide - RIGHT) : scale(places, left, wide - RIGHT, named);
    const shift = (line) => (line - (lines.length - 1) / 2) * Math.min(5, 24 / lines.length); // whiskers would hide each other
    lines.forEach((line, number) => line.points.forEach((each) => Object.assign(each, { at: (value) => (upward ? [x.place(value), y.place(each.along) + shift(number)] : [x.place(each.along), y.place(value)]) })));
    const root = s('svg', { viewBox: `0 0 ${wide} ${HIGH}`, 'aria-hidden': 'true' });
    const rule = (from, to, attributes) => root.append(s('line', { x1: from[0], y1: from[1], x2: to[0], y2: to[1], ...attributes }));
    const label = (text, px, py, attributes) => root.append(s('text', { x: px, y: py, 'text-anchor': 'middle', ...attributes }, text));
    let free = -Infinity;
    for (const [value, text] of x.ticks) {
      rule([x.place(value), TOP], [x.place(value), HIGH - BOTTOM], { class: 'gridline' });
      if (x.place(value) - 4 * text.length < free) continue; // texts never run into each other
      free = x.place(value) + 4 * text.length;
      label(text, x.place(value), HIGH - BOTTOM + 18);
    }
    const few = Math.ceil(y.ticks.length / 16), middle = (TOP + HIGH - BOTTOM) / 2;
    y.ticks.forEach(([value, text], number) => {
      rule([left, y.place(value)], [wide - RIGHT, y.place(value)], { class: 'gridline' });
      if (number % few === 0) label(text, left - 8, y.place(value) + 4, { 'text-anchor': 'end' });
    });
    const titles = upward ? [one.label, one.level] : [axis.label, one.label];
    label(titles[0], (left + wide - RIGHT) / 2, HIGH - 7, { class: 'title' });
    label(titles[1], 15, middle, { class: 'title', transform: `rotate(-90 15 ${middle})` });
    if (ratio) rule(upward ? [x.place(1), TOP] : [left, y.place(1)], upward ? [x.place(1), HIGH - BOTTOM] : [wide - RIGHT, y.place(1)], { class: 'reference' });
    for (const { name, look, points: mine } of lines) {
      const group = s('g', { 'data-series': name }), style = `stroke:${look.color}`;
      const joined = upward ? mine.every(({ along }, place) => !place || along === mine[place - 1].along + 1) : !named;
      for (const each of mine) if (each.low !== each.high) group.append(s('polyline', { points: [each.at(each.low), each.at(each.high)].join(' '), style, opacity: 0.5 }));
      if (joined) group.append(s('polyline', { points: mine.map((each) => each.at(each.value)).join(' '), fill: 'none', 'stroke-width': 2, 'stroke-dasharray': look.dash, style }));
      group.append(...mine.map((each) => filled(marker(look, ...each.at(each.value)), { class: each.void ? 'void' : '' }, [])));
      root.append(group);
    }
    box.append(root);
    tell(lines, root, upward);
  }

  /** The numbers of the point under the pointer, or of the one reached with the arrow keys. */
  function tell(lines, root, upward) {
    const tip = h('div', { class: 'tip', role: 'status', hidden: true }), every = lines.flatMap((line) => line.points);
    box.append(tip);
    filled(box, { tabindex: 0, role: 'group', 'aria-roledescription': 'chart', 'aria-label': `${quantity().label}, a line a case. Arrow keys go from point to point.` }, []);
    const show = (each) => {
      const [px, py] = each.at(each.value);
      tip.replaceChildren(h('strong', {}, each.said[0]), ...each.said.slice(1).map((text) => h('span', {}, text)));
      tip.hidden = false;
      tip.style.left = `${Math.max(4, Math.min(px + 14, root.getBoundingClientRect().width - tip.offsetWidth))}px`;
      tip.style.top = `${py + 18 + tip.offsetHeight > HIGH ? py - tip.offsetHeight - 4 : py + 22}px`;
    };
    let line = -1, place = 0;
    box.onpointermove = ({ clientX, clientY }) => {
      const frame = root.getBoundingClientRect(), away = (each) => Math.hypot(each.at(each.value)[0] - clientX + frame.left, each.at(each.value)[1] - clientY + frame.top);
      const nearest = every.reduce((one, other) => (away(other) < away(one) ? other : one));
      if (away(nearest) > 40) tip.hidden = true;
      else show(nearest);
    };
    box.onpointerleave = box.onblur = () => {
      tip.hidden = true;
    };
    box.onkeydown = (event) => {
      const turn = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
      if (event.key === 'Escape') tip.hidden = true;
      if (!turn) return;
      event.preventDefault();
      const [over, along] = upward ? turn : [-turn[1], turn[0]];
      if (line < 0) line = 0;
      else if (along) place += along;
      else line = (line + over + lines.length) % lines.length;
      place = Math.max(0, Math.min(place, lines[line].points.length - 1));
      show(lines[line].points[place]);
    };
  }

  cases.forEach((name, kase) => {
    const check = h('input', { type: 'checkbox', checked: true, onchange: () => {
      if (check.checked) hidden.delete(kase);
      else hidden.add(kase);
      draw();
    } });
    const dash = s('line', { x1: 1, x2: 37, y1: 7, y2: 7, 'stroke-width': 2, 'stroke-dasharray': looks[kase].dash, style: `stroke:${looks[kase].color}` });
    legend.append(h('label', {}, check, s('svg', { viewBox: '0 0 38 14', 'aria-hidden': 'true' }, dash, marker(looks[kase], 19, 7)), name));
  });
  arrange();
  drawnToWidth(box, draw);
}
