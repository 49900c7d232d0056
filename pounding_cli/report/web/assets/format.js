// Numbers as text, elements, and the voice of the page (its live region).

const RAISED = { '-': '⁻', 0: '⁰', 1: '¹', 2: '²', 3: '³', 4: '⁴', 5: '⁵', 6: '⁶', 7: '⁷', 8: '⁸', 9: '⁹' };

/** A number with at least `digits` digits; a dash where there is none; counts in full. */
function asText(value, digits = 4, whole = false) {
  if (value === null || value === undefined || !Number.isFinite(value)) return '–';
  if (value === 0) return '0';
  if (whole && Number.isInteger(value)) return String(value).replace('-', '−');
  const [mantissa, power] = value.toExponential(digits - 1).split('e');
  const size = Number(power);
  if (size >= -3 && size < 6) return value.toFixed(Math.max(digits - 1 - size, 0)).replace('-', '−');
  return `${mantissa}×10${[...String(size)].map((sign) => RAISED[sign]).join('')}`.replace('-', '−');
}

/** A number that changes with time, with as many decimals as give the largest one four digits: it does not flicker. */
function asSteady(value, most) {
  const decimals = most > 0 ? Math.min(Math.max(3 - Math.floor(Math.log10(most)), 0), 12) : 0;
  return value.toFixed(decimals).replace(/^-(0\.?0*)$/, '$1').replace('-', '−');
}

/** "V/V₀" or "V [kN]": a column's name with its unit. */
function withUnit(column) {
  return column.unit && column.unit !== '–' ? `${column.label} [${column.unit}]` : column.label;
}

/** A number followed by its unit, where it has one. */
function numberWithUnit(value, column, digits = 4) {
  const text = asText(value, digits, column.whole);
  return column.unit && column.unit !== '–' && text !== '–' ? `${text} ${column.unit}` : text;
}

function filled(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith('on')) element.addEventListener(name.slice(2), value);
    else if (name === 'style') element.style.cssText = value; // allowed where the page's policy refuses the attribute
    else if (value === true) element.setAttribute(name, '');
    else if (value !== false && value !== null && value !== undefined) element.setAttribute(name, value);
  }
  element.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return element;
}

/** An HTML element: `h('p', {class: 'note'}, 'text')`; text is never read as markup. */
const h = (tag, attributes = {}, ...children) => filled(document.createElement(tag), attributes, children);

/** The same in SVG. */
const s = (tag, attributes = {}, ...children) =>
  filled(document.createElementNS('http://www.w3.org/2000/svg', tag), attributes, children);

let fields = 0;
/** A control with its label above it. */
function field(label, control) {
  control.id = `field-${++fields}`;
  return h('div', { class: 'field' }, h('label', { for: control.id }, label), control);
}

/** A labelled choice; `options` are [value, text] pairs. */
function choice(label, options, chosen, changed) {
  const select = h('select', { onchange: () => changed(select.value) });
  for (const [value, text] of options) select.append(h('option', { value, selected: value === chosen }, text));
  return { element: field(label, select), select };
}

/** Let the reader save a file. */
function saveAs(name, blob) {
  const link = h('a', { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

let saying = 0;
/** Tell readers who do not see the page; of many sentences in a row only the last is said. */
function say(text) {
  clearTimeout(saying);
  saying = setTimeout(() => {
    document.getElementById('said').textContent = text;
  }, 150);
}

const still = matchMedia('(prefers-reduced-motion: reduce)');
