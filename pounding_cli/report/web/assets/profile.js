// Storey by storey: one quantity of one building, a line a case.

const MEAN = '*mean*';

function profileView() {
  const { charted: QUANTITIES, alone: ALONE } = data;
  const controls = document.getElementById('explore-controls');
  const legend = document.getElementById('explore-legend');
  const box = document.getElementById('explore-chart');
  const looks = caseLooks(data.cases);
  const state = { quantity: '', where: data.building, analysis: '', record: MEAN, point: data.shown, hidden: new Set() };
  const levelOf = (quantity) => Object.keys(QUANTITIES).find((level) => QUANTITIES[level].includes(quantity));
  const known = Object.entries(QUANTITIES).flatMap(([level, keys]) => keys.filter((key) => {
    const column = tables[level]?.column(key);
    return column && column.values.some((value) => value !== null && (level !== 'link' || value !== 0));
  }));
  if (!known.length) {
    box.append(h('p', { class: 'nothing' }, 'Nothing to draw: no run of this study ended.'));
    return;
  }
  state.quantity = known[0];
  const analyses = tables.scene.column('analysis').names;
  state.analysis = analyses[0];
  const records = tables.scene.column('record').names;
  if (records.length === 1) state.record = records[0];
  const pairs = tables.link.rows ? [...new Set(tables.link.rowsWhere({}).map((row) => `${tables.link.cell('left', row)} | ${tables.link.cell('right', row)}`))] : [];

  const set = (name) => (value) => {
    state[name] = value;
    update();
  };
  const text = (key) => {
    const column = tables[levelOf(key)].column(key);
    return column.text && column.text !== column.label ? `${withUnit(column)}: ${column.text}` : withUnit(column);
  };
  const quantity = choice('Quantity', known.map((key) => [key, text(key)]), state.quantity, (value) => {
    state.quantity = value;
    fillPlaces();
    update();
  });
  const place = choice('Building', [], '', set('where'));
  const analysis = choice('Analysis', analyses.map((name) => [name, name]), state.analysis, set('analysis'));
  const all = records.length > 1 ? [[MEAN, `mean of ${records.length}, smallest to largest`]] : [];
  const record = choice('Motion', [...all, ...records.map((name) => [name, name])], state.record, set('record'));
  controls.append(quantity.element, place.element, analysis.element, record.element);
  if (data.points.length > 1) controls.append(choice('Point of the sweep', data.points.map(({ label }) => [label, label]), state.point, set('point')).element);
  controls.addEventListener('submit', (event) => event.preventDefault());

  function fillPlaces() {
    const link = levelOf(state.quantity) === 'link';
    const names = link ? pairs : data.buildings;
    if (!names.includes(state.where)) state.where = link ? pairs[0] : data.building;
    place.element.firstChild.textContent = link ? 'Neighbours' : 'Building';
    const told = (name) => (link ? name : `${name} (T = ${data.periods[name].toFixed(2)} s)`);
    place.select.replaceChildren(...names.map((name) => h('option', { value: name, selected: name === state.where }, told(name))));
  }

  const marks = new Map();
  for (const [name, look] of looks) {
    const check = h('input', { type: 'checkbox', checked: true, onchange: () => {
      if (check.checked) state.hidden.delete(name);
      else state.hidden.add(name);
      update();
    } });
    marks.set(name, h('span', { class: 'badge bad' }));
    legend.append(h('label', {}, check, swatch(look), `${name} `, marks.get(name)));
  }

  /** Why the numbers of a case as drawn mean nothing; undefined where they do. */
  function voidOf(name) {
    const point = data.points.find(({ label }) => label === state.point)?.point ?? {};
    const wanted = { ...point, case: name, analysis: state.analysis, meaningless: 'yes' };
    if (state.record !== MEAN) wanted.record = state.record;
    const row = tables.flagged.rowsWhere(wanted)[0];
    return row === undefined ? undefined : tables.flagged.cell('flag', row);
  }

  /** The rows of one case at every level: value, smallest, largest, error, sensitivity. */
  function profile(name) {
    const level = levelOf(state.quantity), table = tables[level];
    const point = data.points.find(({ label }) => label === state.point)?.point ?? {};
    const wanted = { ...point, case: name, analysis: state.analysis };
    if (state.record !== MEAN) wanted.record = state.record;
    if (level === 'link') [wanted.left, wanted.right] = state.where.split(' | ');
    else wanted.building = state.where;
    const at = level === 'link' ? 'floor' : level;
    const byLevel = new Map();
    for (const row of table.rowsWhere(wanted)) {
      const value = table.cell(state.quantity, row);
      if (value === null) continue;
      const key = table.cell(at, row);
      if (!byLevel.has(key)) byLevel.set(key, []);
      byLevel.get(key).push(row);
    }
    return [...byLevel].sort(([one], [other]) => one - other).map(([key, rows]) => {
      const of = (column) => (table.has(column) ? rows.map((row) => table.cell(column, row)).filter((value) => value !== null) : []);
      const values = of(state.quantity);
      const mean = values.reduce((sum, value) => sum + value, 0) / values.length;
      const spread = values.length > 1 ? [Math.min(...values), Math.max(...values)] : [null, null];
      const alone = of(ALONE[state.quantity] ?? '');
      return {
        level: key, value: mean, low: spread[0], high: spread[1], count: values.length,
        alone: alone.length ? alone.reduce((sum, value) => sum + value, 0) / alone.length : null,
        error: largest([...of(`${state.quantity}_error`), ...(table.has(`${state.quantity}_error`) ? [] : of('error_estimate'))]),
        sensitivity: largest([...of(`${state.quantity}_sensitivity`), ...(table.has(`${state.quantity}_sensitivity`) ? [] : of('sensitivity'))]),
      };
    });
  }
  const largest = (values) => (values.length ? Math.max(...values) : null);

  function update() {
    const level = levelOf(state.quantity), column = tables[level].column(state.quantity);
    const at = level === 'link' ? 'floor' : level;
    const drawn = data.cases.filter((name) => !state.hidden.has(name)).map((name) => [name, profile(name)]).filter(([, rows]) => rows.length);
    const top = Math.max(1, ...drawn.flatMap(([, rows]) => rows.map((row) => row.level)));
    const ticks = Array.from({ length: top }, (_, number) => number + 1).filter((number) => top <= 12 || number % 5 === 0);
    const reasons = new Map(data.cases.map((name) => [name, voidOf(name)]));
    for (const [name, mark] of marks) mark.textContent = reasons.get(name) ? 'not meaningful' : '';
    const series = drawn.map(([name, rows], number) => ({
      name,
      look: looks.get(name),
      joined: rows.every((row, place) => place === 0 || row.level === rows[place - 1].level + 1),
      shift: (number - (drawn.length - 1) / 2) * Math.min(7, 32 / Math.max(drawn.length, 1), (18 * 12) / top / Math.max(drawn.length, 1)),
      points: rows.map((row) => ({
        x: row.value, y: row.level, low: row.low, high: row.high, void: Boolean(reasons.get(name)),
        said: [
          `${name}, ${at} ${row.level}`,
          `${column.label} ${numberWithUnit(row.value, column)}${row.count > 1 ? `, mean of ${row.count}` : ''}`,
          ...(row.low !== null ? [`from ${asText(row.low)} to ${numberWithUnit(row.high, column)}`] : []),
          ...(row.alone !== null ? [`alone ${numberWithUnit(row.alone, column)}`] : []),
          ...(reasons.get(name) ? [`not meaningful: ${reasons.get(name)}`] : []),
          `error ${row.error === null ? 'not measured' : asText(row.error, 2)}, sensitivity ${row.sensitivity === null ? 'not measured' : asText(row.sensitivity, 3)}`,
        ],
      })),
    }));
    const motion = state.record === MEAN ? `mean of ${records.length} motions` : state.record;
    drawChart(box, {
      label: `${column.label} of ${state.where}, ${state.analysis}, ${motion}, ${at} by ${at}`,
      height: Math.max(340, Math.min(620, 110 + 44 * Math.min(top, 12))),
      along: 'y',
      x: { label: withUnit(column) },
      y: { label: at, ticks, low: 0.6, high: top + 0.4 },
      reference: state.quantity.endsWith('_ratio') ? 1 : undefined,
      series,
    });
    numbers(drawn, column, at);
  }

  function numbers(drawn, column, at) {
    const rows = drawn.flatMap(([name, found]) => found.map((row) => [name, row]));
    document.getElementById('explore-numbers').replaceChildren(h('div', { class: 'scroll', tabindex: 0, role: 'region', 'aria-label': 'The numbers drawn' },
      h('table', { class: 'grid' },
        h('thead', {}, h('tr', {}, ...['case', at].map((text) => h('th', { scope: 'col' }, text)),
          ...[withUnit(column), 'smallest', 'largest', 'error', 'sensitivity'].map((text) => h('th', { scope: 'col', class: 'n' }, text)))),
        h('tbody', {}, ...rows.map(([name, row]) => h('tr', {}, h('th', { scope: 'row' }, name), h('td', {}, String(row.level)),
          ...[asText(row.value, 4, column.whole), asText(row.low), asText(row.high), asText(row.error, 2), asText(row.sensitivity, 3)].map((text) => h('td', { class: 'n' }, text))))))));
  }

  fillPlaces();
  drawnToWidth(box, update);
}
