// What the page carries: tables by column, and the looks of the cases.

const data = JSON.parse(document.getElementById('data').textContent);

/** One table: columns by key, rows by number. */
class Table {
  constructor(raw) {
    Object.assign(this, raw);
    this.byKey = new Map(raw.columns.map((column) => [column.key, column]));
  }

  has(key) {
    return this.byKey.has(key);
  }

  column(key) {
    return this.byKey.get(key);
  }

  /** The value of a cell: a text, a number, or null. */
  cell(key, row) {
    const column = this.byKey.get(key);
    return column.codes ? column.names[column.codes[row]] : column.values[row];
  }

  /** The rows in which every column named in `wanted` has the wanted value. */
  rowsWhere(wanted) {
    let rows = Array.from({ length: this.rows }, (_, row) => row);
    for (const [key, value] of Object.entries(wanted)) {
      const column = this.byKey.get(key);
      if (!column) continue;
      const target = column.codes ? column.names.indexOf(String(value)) : value;
      const values = column.codes ?? column.values;
      rows = rows.filter((row) => values[row] === target);
    }
    return rows;
  }
}

const tables = Object.fromEntries(Object.entries(data.tables).map(([name, raw]) => [name, new Table(raw)]));

const NAMED = { touching: 0, gap: 1, infill: 2, connected: 3 };
const DASHES = ['', '7 3', '', '7 2.5 1.5 2.5', '2 2.5', '', '7 3', '7 2.5 1.5 2.5', '4 2', ''];
const MARKERS = ['circle', 'square', 'up', 'diamond', 'down', 'plus', 'cross', 'left', 'right', 'star'];

/** Colour, dash and marker of every case: the paper's four have theirs, others take the rest in turn. */
function caseLooks(cases) {
  const looks = new Map();
  let other = 0;
  for (const name of cases) {
    const number = name in NAMED ? NAMED[name] : 4 + (other++ % 6);
    looks.set(name, { color: `var(--case-${number})`, dash: DASHES[number], marker: MARKERS[number] });
  }
  return looks;
}

/** A marker of the given shape around (x, y), as an SVG element. */
function marker(shape, x, y, size, color) {
  const at = (...pairs) => pairs.map(([dx, dy]) => `${(x + dx * size).toFixed(1)},${(y + dy * size).toFixed(1)}`).join(' ');
  const shapes = {
    square: [[-0.85, -0.85], [0.85, -0.85], [0.85, 0.85], [-0.85, 0.85]],
    up: [[0, -1.1], [1, 0.8], [-1, 0.8]],
    down: [[0, 1.1], [1, -0.8], [-1, -0.8]],
    left: [[-1.1, 0], [0.8, 1], [0.8, -1]],
    right: [[1.1, 0], [-0.8, 1], [-0.8, -1]],
    diamond: [[0, -1.2], [1.1, 0], [0, 1.2], [-1.1, 0]],
    star: [[0, -1.2], [0.35, -0.4], [1.2, -0.35], [0.5, 0.25], [0.75, 1.1], [0, 0.6], [-0.75, 1.1], [-0.5, 0.25], [-1.2, -0.35], [-0.35, -0.4]],
    plus: [[-0.35, -1.1], [0.35, -1.1], [0.35, -0.35], [1.1, -0.35], [1.1, 0.35], [0.35, 0.35], [0.35, 1.1], [-0.35, 1.1], [-0.35, 0.35], [-1.1, 0.35], [-1.1, -0.35], [-0.35, -0.35]],
    cross: [[-1, -0.6], [-0.6, -1], [0, -0.4], [0.6, -1], [1, -0.6], [0.4, 0], [1, 0.6], [0.6, 1], [0, 0.4], [-0.6, 1], [-1, 0.6], [-0.4, 0]],
  };
  if (!(shape in shapes)) return s('circle', { cx: x, cy: y, r: size * 0.95, style: `fill:${color}` });
  return s('polygon', { points: at(...shapes[shape]), style: `fill:${color}` });
}

/** The drawing of a case in a legend. */
function swatch(look) {
  return s(
    'svg',
    { viewBox: '0 0 38 14', 'aria-hidden': 'true' },
    s('line', { x1: 1, x2: 37, y1: 7, y2: 7, 'stroke-width': 2, 'stroke-dasharray': look.dash, style: `stroke:${look.color}` }),
    marker(look.marker, 19, 7, 4.2, look.color),
  );
}
