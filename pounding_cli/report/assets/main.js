// Puts the page together: widgets, sorted tables.

const data = JSON.parse(document.getElementById('data').textContent);

/** A head of a long table sorts its rows by that column, again the other way round. */
function sorting() {
  const number = (text) => {
    const [, sign, digits, power] = text.match(/^([−-]?)([\d.]+)(?:×10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+))?/) ?? [];
    const raised = power ? Number([...power].map((one) => '⁻⁰¹²³⁴⁵⁶⁷⁸⁹'.indexOf(one) - 1).map((one) => (one < 0 ? '-' : one)).join('')) : 0;
    return digits === undefined ? null : (sign ? -1 : 1) * Number(digits) * 10 ** raised;
  };
  for (const head of document.querySelectorAll('details .grid thead th')) {
    const body = head.closest('table').tBodies[0], place = head.cellIndex;
    const button = h('button', { type: 'button', onclick: () => {
      const sign = head.getAttribute('aria-sort') === 'ascending' ? -1 : 1;
      for (const other of head.parentElement.cells) other.removeAttribute('aria-sort');
      head.setAttribute('aria-sort', sign > 0 ? 'ascending' : 'descending');
      const keyed = [...body.rows].map((row) => [row, row.cells[place].textContent]).map(([row, text]) => [row, text, number(text)]);
      keyed.sort(([, one, a], [, other, b]) => (a === null || b === null ? (a === null) - (b === null) || sign * one.localeCompare(other) : sign * (a - b)));
      body.append(...keyed.map(([row]) => row));
    } }, ...head.childNodes);
    head.replaceChildren(button);
  }
}

document.documentElement.classList.add('scripted');
sorting();
if (data.explorer) explorer(document.getElementById('explorer'), data.explorer);
if (data.player?.scenes.length) player(document.getElementById('player'), data.player);
document.documentElement.classList.add('ready');
