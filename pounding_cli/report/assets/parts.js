// Elements, numbers as text, scales of axes, and markers.

const RAISED = { '-': '⁻', 0: '⁰', 1: '¹', 2: '²', 3: '³', 4: '⁴', 5: '⁵', 6: '⁶', 7: '⁷', 8: '⁸', 9: '⁹' };

/** A number with `digits` digits; a dash where there is none. */
function asText(value, digits = 4) {
  if (value === null || value === undefined || !Number.isFinite(value)) return '–';
  if (value === 0) return '0';
  const [mantissa, power] = value.toExponential(digits - 1).split('e');
  const size = Number(power);
  if (size >= -3 && size < 6) return value.toFixed(Math.max(digits - 1 - size, 0)).replace('-', '−');
  return `${mantissa}×10${[...String(size)].map((sign) => RAISED[sign]).join('')}`.replace('-', '−');
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
/** A labelled choice; `options` are [value, text] pairs. */
function choice(label, options, chosen, changed) {
  const select = h('select', { id: `field-${++fields}`, onchange: () => changed(select.value) });
  for (const [value, text] of options) select.append(h('option', { value, selected: String(value) === String(chosen) }, text));
  return h('div', { class: 'field' }, h('label', { for: select.id }, label), select);
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
  const round = log ? Array.from({ length: 120 }, (_, number) => [1, 2, 5][number % 3] * 10 ** (Math.floor(number / 3) - 20)).filter((tick) => tick > low && tick < high) : ticksBetween(low, high, Math.abs(to - from) / 75);
  return { place: (value) => from + share(value) * (to - from), ticks: named ?? round.map((tick) => [tick, String(Number(tick.toPrecision(6))).replace('-', '−')]) };
}

/** The marker of a look around (x, y). */
const marker = (look, x, y, size = 9) => s('path', { d: look.marker, transform: `translate(${x} ${y}) scale(${size} ${-size})`, style: `fill:${look.color};stroke:${look.color}` });
