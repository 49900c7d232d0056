// Puts the page together: widgets, colours, the section shown, sorted tables, copying, printing.

const data = JSON.parse(document.getElementById('data').textContent);

function themes() {
  const button = document.getElementById('theme'), wanted = matchMedia('(prefers-color-scheme: dark)');
  const set = (theme) => {
    document.documentElement.dataset.theme = theme;
    button.textContent = theme === 'dark' ? 'Light colours' : 'Dark colours';
    document.dispatchEvent(new Event('themed'));
  };
  button.addEventListener('click', () => set(document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark'));
  wanted.addEventListener('change', () => set(wanted.matches ? 'dark' : 'light'));
  set(document.documentElement.dataset.theme);
}

/** Mark the section that is read in the list of sections. */
function sections() {
  const links = new Map([...document.querySelectorAll('.contents a')].map((link) => [link.hash.slice(1), link]));
  const seen = new IntersectionObserver((entries) => {
    const read = entries.find(({ isIntersecting }) => isIntersecting);
    if (!read) return;
    for (const link of links.values()) link.removeAttribute('aria-current');
    links.get(read.target.id)?.setAttribute('aria-current', 'true');
  }, { rootMargin: '-30% 0px -65% 0px' });
  for (const id of links.keys()) seen.observe(document.getElementById(id));
}

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

function copying() {
  for (const button of document.querySelectorAll('[data-copy]')) {
    button.addEventListener('click', async () => {
      const source = document.getElementById(button.dataset.copy);
      try {
        await navigator.clipboard.writeText(source.textContent);
        button.textContent = 'Copied';
      } catch {
        getSelection().selectAllChildren(source); // the reader copies it
        button.textContent = 'Selected: copy it';
      }
    });
  }
}

themes();
sections();
sorting();
copying();
if (data.explorer) explorer(document.getElementById('explorer'), data.explorer);
if (data.player?.scenes.length) player(document.getElementById('player'), data.player);
document.documentElement.classList.add('ready');
