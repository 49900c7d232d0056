// The tables: one at a time, sorted, filtered, taken away as CSV.

const PAGE_OF_ROWS = 50;
const MOST_CHOICES = 60;

function tableView() {
  const view = document.getElementById('table-view');
  const names = Object.keys(tables).filter((name) => tables[name].rows > 0);
  if (!names.length) {
    view.append(h('p', {}, 'This file has no rows.'));
    return;
  }
  const tabs = h('div', { class: 'tabs', role: 'group', 'aria-label': 'Table' });
  const bar = h('div', { class: 'bar' });
  const frame = h('div', { class: 'big-table', tabindex: 0, role: 'region' });
  const more = h('div', { class: 'more' });
  if (names.length > 1) view.append(tabs);
  view.append(bar, frame, more);
  let state;
  for (const name of names) tabs.append(h('button', { type: 'button', 'data-table': name, onclick: () => open(name) }, tables[name].title));

  function open(name) {
    state = { name, table: tables[name], sort: null, down: false, filters: new Map(), words: '', shown: PAGE_OF_ROWS };
    for (const tab of tabs.children) tab.setAttribute('aria-pressed', String(tab.dataset.table === name));
    frame.setAttribute('aria-label', `Table: ${state.table.title}`);
    const search = h('input', { type: 'search', placeholder: 'any text', oninput: () => {
      state.words = search.value.trim().toLowerCase();
      refill();
    } });
    bar.replaceChildren(field('Search', search));
    for (const column of state.table.columns.filter((one) => one.filter && one.names.length > 1 && one.names.length <= MOST_CHOICES)) {
      const options = [['', 'all'], ...column.names.map((text, code) => [String(code), text])];
      bar.append(choice(column.label, options, '', (value) => {
        if (value === '') state.filters.delete(column.key);
        else state.filters.set(column.key, Number(value));
        refill();
      }).element);
    }
    fill();
  }

  function refill() {
    state.shown = PAGE_OF_ROWS;
    fill();
  }

  function chosen() {
    const { table, filters, words, sort, down } = state;
    let rows = table.rowsWhere({});
    for (const [key, code] of filters) rows = rows.filter((row) => table.column(key).codes[row] === code);
    if (words) rows = rows.filter((row) => table.columns.some((column) => shownCell(column, row).toLowerCase().includes(words)));
    if (sort) {
      const column = table.column(sort), sign = down ? -1 : 1;
      const order = column.codes ? column.names.map((name) => name) : null;
      rows.sort((one, other) => {
        if (order) return sign * order[column.codes[one]].localeCompare(order[column.codes[other]], 'en', { numeric: true }) || one - other;
        const [a, b] = [column.values[one], column.values[other]];
        if (a === null || b === null) return (a === null) - (b === null) || one - other; // missing ones stay below
        return sign * (a - b) || one - other;
      });
    }
    return rows;
  }

  const trust = (column) => /(^|_)(error|error_estimate|sensitivity)$/.test(column.key);
  const shownCell = (column, row) => (column.codes ? column.names[column.codes[row]] : asText(column.values[row], trust(column) ? 3 : 4, column.whole));

  function fill() {
    const { table } = state;
    const focused = document.activeElement?.closest?.('.big-table thead th')?.dataset.key;
    const rows = chosen();
    const columns = table.columns.filter(({ key }) => !state.filters.has(key)); // what is chosen is known
    const head = columns.map((column) => {
      const sorted = state.sort === column.key ? (state.down ? 'descending' : 'ascending') : 'none';
      return h('th', { scope: 'col', class: column.codes ? '' : 'n', 'aria-sort': sorted, 'data-key': column.key },
        h('button', { type: 'button', title: column.text || column.label, onclick: () => sortBy(column.key) }, withUnit(column)));
    });
    const body = rows.slice(0, state.shown).map((row) => h('tr', {}, columns.map((column) =>
      h('td', { class: column.codes ? '' : trust(column) ? 'n aside' : 'n' }, shownCell(column, row)))));
    frame.replaceChildren(h('table', { class: 'grid' }, h('caption', { class: 'quiet' }, table.title), h('thead', {}, h('tr', {}, head)), h('tbody', {}, body)));
    if (focused) frame.querySelector(`th[data-key="${CSS.escape(focused)}"] button`)?.focus();
    const hidden = rows.length - Math.min(state.shown, rows.length);
    const cut = table.rows < table.total ? ` This page carries ${table.rows} of the ${table.total} rows of the file.` : '';
    const count = h('span', { class: 'count' }, `${rows.length - hidden} of ${rows.length} ${rows.length === 1 ? 'row' : 'rows'} shown.${cut}`);
    const buttons = hidden ? [
      h('button', { type: 'button', onclick: () => show(state.shown + PAGE_OF_ROWS * 4) }, `Show ${Math.min(hidden, PAGE_OF_ROWS * 4)} more`),
    ] : [];
    more.replaceChildren(count, ...buttons, h('button', { type: 'button', onclick: () => save(rows) }, 'Save as CSV'));
  }

  function show(count) {
    state.shown = count;
    fill();
  }

  function sortBy(key) {
    state.down = state.sort === key && !state.down;
    state.sort = key;
    refill();
    say(`Sorted by ${state.table.column(key).label}, ${state.down ? 'descending' : 'ascending'}`);
  }

  function save(rows) {
    const { table } = state;
    const quoted = (text) => (/[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
    // As texts.py does: a text that a spreadsheet would take for a formula is marked as text; numbers are left alone.
    const asCell = (text) => (/^[=+@\t\r-]/.test(text) ? `'${text}` : text);
    const cell = (column, row) => (column.codes ? asCell(column.names[column.codes[row]]) : column.values[row] ?? '');
    const heads = table.columns.map((column) => asCell(withUnit(column)));
    const lines = [heads, ...rows.map((row) => table.columns.map((column) => cell(column, row)))];
    const text = lines.map((line) => line.map((one) => quoted(String(one))).join(',')).join('\r\n');
    saveAs(`${state.name}.csv`, new Blob([`${text}\r\n`], { type: 'text/csv' }));
  }

  open(names[0]);
}
