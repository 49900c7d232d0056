// Over the sweep: curves against one swept key, or a map over two, of any quantity, case, building and storey.

/** Colours of a map from the smallest to the largest number: viridis, equal steps to the eye and in grey. */
const SCALE = ['#440154', '#414487', '#2a788e', '#22a884', '#7ad151', '#fde725'];

function colourAt(share) {
  const at = Math.max(0, Math.min(1, share)) * (SCALE.length - 1), low = Math.min(Math.floor(at), SCALE.length - 2);
  const parts = [1, 3, 5].map((from) => {
    const [one, other] = [SCALE[low], SCALE[low + 1]].map((colour) => parseInt(colour.slice(from, from + 2), 16));
    return Math.round(one + (other - one) * (at - low));
  });
  return `rgb(${parts.join(' ')})`;
}

function sweepView() {
  const controls = document.getElementById('sweep-controls');
  const box = document.getElementById('sweep-chart');
  const { axes, quantities, names, heights } = data.sweep;
  if (!quantities.length) return void box.append(h('p', { class: 'nothing' }, 'Nothing to draw: no run of this study ended.'));
  const looks = caseLooks(data.cases);
  const maps = axes.filter((one) => one.numeric && one.values.length > 1).length > 1;
  const across = maps ? axes.findLastIndex((one) => one.numeric && one.values.length > 1) : axes.findIndex((one) => one.values.length > 1);
  const up = maps ? axes.findIndex((one) => one.numeric && one.values.length > 1) : -1;
  const state = { quantity: quantities[0].key, case: maps ? '0' : '', analysis: 0, where: '', level: '', across: Math.max(across, 0), up, at: axes.map(() => 0) };
  const worst = [['', 'largest of all']];
  const chosen = () => quantities.find(({ key }) => key === state.quantity);
  const numbered = (list) => list.map((name, number) => [String(number), name]);

  /** The controls anew: which there are depends on the quantity and on what is drawn against what. */
  function arrange() {
    const quantity = chosen(), places = names[quantity.where];
    if (state.where !== '' && Number(state.where) >= places.length) state.where = '';
    const levels = [...new Set(quantity.rows.map((row) => row[3]))].sort((one, other) => one - other);
    if (!levels.includes(Number(state.level))) state.level = '';
    const set = (name, whole = String) => (value) => {
      state[name] = whole(value);
      arrange();
      update();
    };
    const told = ({ label, unit, text }) => `${withUnit({ label, unit })}${text && text !== label ? `: ${text}` : ''}`;
    const fields = [choice('Quantity', quantities.map((one) => [one.key, told(one)]), state.quantity, set('quantity'))];
    if (names.analysis.length > 1) fields.push(choice('Analysis', numbered(names.analysis), String(state.analysis), set('analysis', Number)));
    if (names.case.length > 1) fields.push(choice('Case', [['', state.up >= 0 ? 'largest of all' : 'all'], ...numbered(names.case)], state.case, set('case')));
    if (places.length > 1) fields.push(choice(quantity.where === 'pair' ? 'Neighbours' : 'Building', [...worst, ...numbered(places)], state.where, set('where')));
    if (heights && levels.length > 1) fields.push(choice(quantity.level === 'storey' ? 'Storey' : 'Floor', [...worst, ...levels.map((one) => [String(one), String(one)])], state.level, set('level')));
    const labels = axes.map((one, number) => [String(number), one.label]);
    if (axes.length > 1) {
      fields.push(choice('Across', labels, String(state.across), (value) => {
        if (Number(value) === state.up) state.up = state.across;
        set('across', Number)(value);
      }));
      const others = labels.filter(([number]) => Number(number) !== state.across);
      fields.push(choice('Up', [['-1', `${withUnit(quantity)} (curves)`], ...others], String(state.up), (value) => {
        state.case = value === '-1' ? '' : state.case || '0'; // curves of all cases, a map of one
        set('up', Number)(value);
      }));
    }
    axes.forEach((one, number) => {
      if (number === state.across || number === state.up) return;
      fields.push(choice(one.label, numbered(one.names), String(state.at[number]), (value) => {
        state.at[number] = Number(value);
        update();
      }));
    });
    controls.replaceChildren(...fields.map(({ element }) => element));
  }
  controls.addEventListener('submit', (event) => event.preventDefault());

  /** The largest number of some rows at a point, with its spread, its place in words and what makes it meaningless. */
  function numberAt(rows, at) {
    const quantity = chosen(), size = axes.reduce((all, one) => all * one.values.length, 1);
    const point = at.reduce((sum, place, number) => sum * axes[number].values.length + place, 0);
    let most = null;
    for (const row of rows) {
      const value = quantity.mean[row * size + point];
      if (value !== null && (most === null || Math.abs(value) > Math.abs(quantity.mean[most * size + point]))) most = row;
    }
    if (most === null) return null;
    const [kase, analysis, where, level] = quantity.rows[most];
    const empty = data.sweep.void.find((one) => one.case === names.case[kase] && one.analysis === names.analysis[analysis]);
    const count = empty?.count[point] ?? 0;
    const value = (list) => list[most * size + point];
    const place = [names[quantity.where][where], ...(level ? [`${quantity.level === 'storey' ? 'storey' : 'floor'} ${level}`] : [])].join(', ');
    const said = [`${names.case[kase]}, ${axes.map((one, number) => one.words[at[number]]).join(', ')}`, `${quantity.label} ${numberWithUnit(value(quantity.mean), quantity)}`,
      ...(value(quantity.low) === value(quantity.high) ? [] : [`motions from ${asText(value(quantity.low))} to ${numberWithUnit(value(quantity.high), quantity)}`]),
      place, ...(count ? [`not meaningful (${count} ${count === 1 ? 'motion' : 'motions'}): ${empty.why}`] : [])];
    return { value: value(quantity.mean), low: value(quantity.low), high: value(quantity.high), said, void: count > 0 };
  }

  const rowsOf = (kase) => chosen().rows.map((_, number) => number).filter((number) => {
    const [one, analysis, where, level] = chosen().rows[number];
    return (kase === '' || one === Number(kase)) && analysis === state.analysis
      && (state.where === '' || where === Number(state.where)) && (state.level === '' || level === Number(state.level));
  });
  const place = (one, other) => state.at.map((value, number) => (number === state.across ? one : number === state.up ? other : value));
  const words = (one, room) => ({ ticks: one.names.map((_, number) => number + 1), names: one.names.map((name) => (name.length > room ? `${name.slice(0, room - 1)}…` : name)), low: 0.5, high: one.names.length + 0.5 });

  function update() {
    const quantity = chosen(), x = axes[state.across], title = withUnit(quantity);
    const where = [state.where === '' ? 'largest of all buildings' : names[quantity.where][Number(state.where)], ...(state.level ? [`${quantity.level === 'storey' ? 'storey' : 'floor'} ${state.level}`] : ['largest over the height'])].join(', ');
    const kase = state.case !== '' ? `${names.case[Number(state.case)]}: ` : state.up >= 0 && names.case.length > 1 ? 'largest of all cases: ' : '';
    const label = `${kase}${title}, ${names.analysis[state.analysis]}, mean of ${data.motions === 1 ? 'one motion' : `${data.motions} motions`}, ${where}`;
    document.getElementById('sweep-title').textContent = label;
    if (state.up >= 0) drawMap(x, axes[state.up], label);
    else drawCurves(x, title, label, quantity);
    document.getElementById('sweep-cases').hidden = state.up >= 0;
    document.getElementById('sweep-void').hidden = !box.querySelector('.void');
  }

  function drawCurves(x, title, label, quantity) {
    const cases = state.case === '' ? data.cases : [names.case[Number(state.case)]];
    const series = cases.map((name, number) => {
      const rows = rowsOf(names.case.indexOf(name));
      const points = x.values.map((value, at) => ({ at, found: numberAt(rows, place(at, 0)), x: x.numeric ? value : at + 1 }));
      return {
        name, look: looks.get(name), joined: x.numeric, shift: (number - (cases.length - 1) / 2) * Math.min(3, 12 / cases.length),
        points: points.filter(({ found }) => found).map(({ found, x: at }) => ({ ...found, x: at, y: found.value })).sort((a, b) => a.x - b.x),
      };
    }).filter(({ points }) => points.length);
    const low = Math.min(...x.values), high = Math.max(...x.values);
    drawChart(box, {
      label, height: 400, along: 'x', series,
      x: { label: x.label, ...(x.numeric ? { log: low > 0 && high / low > 20 } : words(x, 12)) },
      y: { label: title },
      reference: quantity.key.endsWith('_ratio') ? 1 : undefined,
    });
  }

  function drawMap(x, y, label) {
    const rows = rowsOf(state.case);
    const cells = y.values.map((_, other) => x.values.map((__, one) => numberAt(rows, place(one, other))));
    const known = cells.flat().filter(Boolean).map(({ value }) => value);
    const low = Math.min(...known), high = Math.max(...known), log = low > 0 && high / low > 30;
    const share = (value) => (low === high ? 0.5 : log ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low));
    const order = (one) => one.values.map((value, number) => [one.numeric ? value : number, number]).sort((a, b) => a[0] - b[0]).map(([, number]) => number);
    const [columns, lines] = [order(x), order(y)];
    const series = lines.map((other, line) => ({
      name: y.names[other],
      points: columns.map((one, column) => ({ found: cells[other][one], column })).filter(({ found }) => found)
        .map(({ found, column }) => ({ ...found, x: column + 1, y: line + 1, fill: colourAt(share(found.value)), dark: share(found.value) < 0.6, text: asText(found.value, 3) })),
    })).filter(({ points }) => points.length);
    const sorted = (one, by, room) => words({ names: by.map((number) => one.names[number]) }, room);
    drawChart(box, {
      label, height: Math.max(300, Math.min(620, 90 + 34 * lines.length)), along: 'x', series, cells: [columns.length, lines.length],
      x: { label: x.label, ...sorted(x, columns, 12) }, y: { label: y.label, ...sorted(y, lines, 9) },
    });
    if (known.length) {
      const bar = h('span', { class: 'bar-of-colours', style: `background: linear-gradient(to right, ${SCALE.join(', ')})` });
      box.append(h('p', { class: 'scale note' }, `${asText(low)} `, bar, ` ${asText(high)} ${withUnit(chosen())}${log ? ', logarithmic' : ''}`));
    }
  }

  const key = h('div', { class: 'legend', id: 'sweep-cases', role: 'group', 'aria-label': 'Cases' }, ...[...looks].map(([name, look]) => h('label', {}, swatch(look), name)));
  const notes = [h('p', { class: 'note', id: 'sweep-void' }, 'Hollow points and crossed cells: not meaningful; point at them for the reason.')];
  if (!heights) notes.push(h('p', { class: 'note' }, 'This sweep is large: the page has the largest over the height only. tables/ has every storey.'));
  if (data.sweep.thinned > 1) notes.push(h('p', { class: 'note' }, `This sweep is large: the page has every ${data.sweep.thinned}th point of the longest axes at most. tables/ has them all.`));
  box.before(h('p', { class: 'chart-title', id: 'sweep-title' }), key);
  box.after(...notes);
  arrange();
  drawnToWidth(box, update);
}
