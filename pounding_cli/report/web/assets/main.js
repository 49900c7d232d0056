// Puts the page together: views, colours, the section shown, copying, printing.

function themes() {
  const button = document.getElementById('theme');
  const wanted = matchMedia('(prefers-color-scheme: dark)');
  const set = (theme) => {
    document.documentElement.dataset.theme = theme;
    button.textContent = theme === 'dark' ? 'Light colours' : 'Dark colours';
    document.dispatchEvent(new Event('themed'));
  };
  button.addEventListener('click', () => set(document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark'));
  wanted.addEventListener('change', () => set(wanted.matches ? 'dark' : 'light'));
  set(document.documentElement.dataset.theme);
  let before = 'light';
  addEventListener('beforeprint', () => {
    before = document.documentElement.dataset.theme;
    set('light'); // canvases are drawn, not styled
    for (const details of document.querySelectorAll('details')) details.open = true;
  });
  addEventListener('afterprint', () => set(before));
}

/** Mark the section that is read in the list of sections. */
function sections() {
  const links = new Map([...document.querySelectorAll('.contents a')].map((link) => [link.hash.slice(1), link]));
  const list = [...links.keys()].map((id) => document.getElementById(id)).filter(Boolean);
  const mark = () => {
    const read = list.filter((section) => section.getBoundingClientRect().top < innerHeight * 0.35).at(-1) ?? list[0];
    if (links.get(read.id).hasAttribute('aria-current')) return;
    for (const link of links.values()) link.removeAttribute('aria-current');
    links.get(read.id).setAttribute('aria-current', 'true');
    const link = links.get(read.id), bar = link.closest('nav');
    if (bar.scrollWidth > bar.clientWidth) bar.scrollLeft = link.offsetLeft - bar.clientWidth / 3;
  };
  let waiting = false;
  addEventListener('scroll', () => {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      mark();
    });
  }, { passive: true });
  mark();
}

function copying() {
  for (const button of document.querySelectorAll('[data-copy]')) {
    button.addEventListener('click', async () => {
      const text = document.getElementById(button.dataset.copy).textContent;
      try {
        await navigator.clipboard.writeText(text);
        button.textContent = 'Copied';
        say('Copied');
      } catch {
        getSelection().selectAllChildren(document.getElementById(button.dataset.copy)); // the reader copies it
        button.textContent = 'Selected: copy it';
      }
    });
  }
}

themes();
sections();
copying();
if (document.getElementById('explore')) profileView();
if (data.sweep && document.getElementById('sweep')) sweepView();
if (document.getElementById('player')) playerView();
if (document.getElementById('table-view')) tableView();
document.documentElement.classList.add('ready');
