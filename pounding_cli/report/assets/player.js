// The player of the moving buildings: which time history, which instant, how fast.

const SPEEDS = [['1', 'real time'], ['0.5', '1/2'], ['0.2', '1/5'], ['0.1', '1/10'], ['0.02', '1/50'], ['0.005', '1/200']];
/** Speed at impacts, which lasts from this long before the largest force to as long after it [s]. */
const SLOW = 0.01, AROUND = 0.012;
/** In this time the light of an impact falls to a third [s]. */
const FADE = 0.15;
const still = matchMedia('(prefers-reduced-motion: reduce)');

function player(root, { scenes }) {
  const canvas = h('canvas', { role: 'img' });
  const above = h('canvas', { role: 'img' }), beside = h('div', { class: 'above', hidden: true }, above), floors = h('div', {});
  const strip = h('canvas', { role: 'img', 'aria-label': 'Ground acceleration, roof displacements and link forces over time' });
  const state = { scene: null, time: 0, playing: false, speed: 0.2, scale: null, glow: [], frame: 0, told: 0, floor: null, struck: 1 };
  const button = (text, pressed, more = {}) => h('button', { type: 'button', onclick: pressed, ...more }, text);
  const play = button('Play', () => toggle(), { class: 'primary' });
  const impacts = [button('Previous impact', () => toImpact(-1)), button('Next impact', () => toImpact(1)), button('Largest impact', () => toStrongest())];
  const slow = h('input', { type: 'checkbox', checked: true });
  const scrub = h('input', { type: 'range', min: 0, step: 1, value: 0, 'aria-label': 'Time', oninput: () => stopAt(Number(scrub.value) * state.scene.dt) });
  const readout = h('dl', { class: 'readout' }), key = h('p', { class: 'note' });
  root.append(
    h('div', { class: 'bar' },
      choice('Time history', scenes.map((one, number) => [number, one.label]), 0, (value) => open(Number(value))),
      choice('Displacements drawn', [['', 'to fit'], ...SCALES.map((one) => [one, `× ${one}`])], '', (value) => {
        state.scale = value === '' ? null : Number(value);
        arrange();
      }), floors),
    h('div', { class: 'stage' }, h('div', { class: 'side' }, canvas), beside),
    h('div', { class: 'bar' }, play, ...impacts,
      choice('Speed', SPEEDS, '0.2', (value) => {
        state.speed = Number(value);
      }), h('label', { class: 'check' }, slow, 'slow at impacts')),
    scrub, strip, readout, key,
    h('p', { class: 'note' }, 'Keys: Space plays and pauses, ← → one sample (with Shift 0.1 s), P N previous and next impact.'),
  );

  function open(number) {
    pause();
    state.scene = new Scene(scenes[number]);
    state.glow = state.scene.links.map(() => 0);
    scrub.max = state.scene.count - 1;
    for (const each of impacts) each.disabled = !state.scene.impacts.length;
    offerFloors();
    arrange();
    if (state.scene.impacts.length) toStrongest();
    else go(0);
  }

  /** Which floor is seen from above; of its own accord the one that the last chosen impact struck. */
  function offerFloors() {
    const { scene } = state, count = Math.max(...scene.buildings.map(({ heights }) => heights.length));
    state.struck = count;
    state.floor = null;
    beside.hidden = !scene.twists;
    const numbers = Array.from({ length: count }, (_, number) => [number + 1, `floor ${number + 1}`]);
    floors.replaceChildren(...(scene.twists ? [choice('Seen from above', [['', 'where the impact is'], ...numbers.reverse()], '', (value) => {
      state.floor = value === '' ? null : Number(value);
      arrange();
    })] : []));
  }

  function arrange() {
    const { scene } = state;
    state.ink = inks();
    state.at = layout(scene, Math.max(canvas.parentElement.clientWidth, 240), state.scale);
    if (scene.twists) state.aboveAt = layoutAbove(scene, Math.max(beside.clientWidth, 240), state.scale, state.at.gaps);
    const kinds = new Set(scene.links.map(({ drawn }) => drawn));
    const said = [
      `Displacements and gaps are drawn ${state.at.scale === 1 ? 'to the scale of the heights' : `${state.at.scale} times larger than heights`}.`,
      ...(scene.twists ? [`Seen from above, floor ${floorAbove()}: displacements, turns and gaps are drawn ${state.aboveAt.scale === 1 ? 'to the scale of the plans' : `${state.aboveAt.scale} times larger than the plans`}; lines are frame lines, thick as their share of the stiffness, crosses centres of mass, dots places of contact, dotted outlines the floors at rest.`] : []),
      scene.yields ? scene.twists ? 'Columns, and frame lines of the storey below the floor, are red while a drift is at or beyond the yield drift.' : 'Columns are red and thick while the storey drift is at or beyond the yield drift.' : 'This time history is elastic: no storey yields.',
      ...(kinds.has('gap') || kinds.has('filling') ? [`Stars: contact forces; those of at least ${100 * HARD} % of the largest count as impacts.`] : []),
      ...(kinds.has('bar') ? ['Bars: connectors, orange in compression, blue in tension.'] : []),
    ];
    key.textContent = said.join(' ');
    canvas.setAttribute('aria-label', `${scene.buildings.map(({ name }) => name).join(', ')} moving: ${scene.label}`);
    if (scene.twists) above.setAttribute('aria-label', `Floor ${floorAbove()} of ${scene.buildings.map(({ name }) => name).join(', ')} from above, moving and turning: ${scene.label}`);
    draw();
  }

  const floorAbove = () => state.floor ?? state.struck;
  const strongest = () => state.scene.impacts.reduce((most, one) => (one.force > most.force ? one : most));

  function go(time) {
    const { scene } = state;
    state.time = Math.max(0, Math.min(time, scene.end));
    state.glow = scene.forces.map((series) => Math.abs(scene.between(series, state.time)) / (scene.mostForce || 1));
    draw();
  }

  function stopAt(time) {
    pause();
    go(time);
  }

  function toImpact(way) {
    const slack = state.scene.dt / 2, hard = state.scene.impacts;
    const next = way > 0 ? hard.find(({ at }) => at > state.time + slack) : hard.findLast(({ at }) => at < state.time - slack);
    if (next) showImpact(next);
  }

  const toStrongest = () => showImpact(strongest());

  function showImpact({ at, link }) {
    const { floor, right_floor: other } = state.scene.links[link], struck = Math.max(floor, other, 1);
    stopAt(at);
    if (struck === state.struck) return;
    state.struck = struck;
    if (state.scene.twists) arrange();
  }

  function toggle() {
    if (state.playing) return pause();
    if (state.time >= state.scene.end) go(0);
    [state.playing, play.textContent, state.clock] = [true, 'Pause', undefined];
    state.frame = requestAnimationFrame(tick);
    return undefined;
  }

  function pause() {
    cancelAnimationFrame(state.frame);
    [state.playing, play.textContent] = [false, 'Play'];
    if (state.at) tell();
  }

  function tick(now) {
    const passed = state.clock === undefined ? 0 : Math.min((now - state.clock) / 1e3, 0.1);
    state.clock = now;
    const { scene } = state;
    const slowed = slow.checked && scene.impacts.some((impact) => Math.abs(impact.at - state.time) < AROUND);
    const next = Math.min(state.time + passed * (slowed ? Math.min(state.speed, SLOW) : state.speed), scene.end);
    scene.links.forEach((_, number) => {
      const pressed = scene.force(number, state.time, next) / (scene.mostForce || 1);
      state.glow[number] = Math.max(pressed, still.matches ? 0 : state.glow[number] * Math.exp(-passed / FADE));
    });
    state.time = next;
    draw();
    if (state.time >= scene.end) pause();
    else state.frame = requestAnimationFrame(tick);
  }

  function draw() {
    const { scene, at, time, ink } = state;
    drawStage(canvas, scene, at, time, state.glow, ink);
    if (scene.twists) drawAbove(above, scene, state.aboveAt, floorAbove(), time, state.glow, ink);
    drawStrips(strip, scene, time, Math.max(strip.clientWidth, 240), ink);
    scrub.value = Math.round(time / scene.dt);
    scrub.setAttribute('aria-valuetext', `${asText(time)} s`);
    if (state.playing && performance.now() - state.told < 100) return;
    state.told = performance.now();
    tell();
  }

  function tell() {
    const { scene, time } = state, { factor, unit } = scene.acceleration;
    const roofs = scene.buildings.length > 4 ? [] : scene.buildings.map(({ name, heights }, number) =>
      [`${name} roof`, `${(1e3 * scene.moved(number, heights.length, time)).toFixed(2)} mm`]);
    if (scene.mostTurned && roofs.length) scene.buildings.forEach(({ name, heights }, number) => scene.turns[number]
      && roofs.push([`${name} roof turns`, `${(1e3 * scene.turned(number, heights.length, time)).toFixed(3)} mrad`]));
    const forces = scene.forces.map((series) => scene.between(series, time));
    const most = forces.reduce((one, force, number) => (Math.abs(force) > Math.abs(forces[one] ?? 0) ? number : one), -1);
    const force = most < 0 ? '0 kN' : `${(forces[most] / 1e3).toFixed(2)} kN at ${scene.links[most].floor ? `floor ${scene.links[most].floor}` : 'base'}`;
    const facts = [['time', `${time.toFixed(3)} s`], ['ground', `${(factor * scene.between(scene.ground, time)).toFixed(3)} ${unit}`], ...roofs,
      ['link force', force], ['contacts so far', `${scene.contacts.filter(({ from }) => from <= time).length} of ${scene.contacts.length}`]];
    readout.replaceChildren(...facts.map(([name, value]) => h('div', {}, h('dt', {}, name), h('dd', {}, value))));
  }

  root.addEventListener('keydown', (event) => {
    const name = event.key.length === 1 ? event.key.toLowerCase() : event.key, step = event.shiftKey ? 0.1 : state.scene.dt;
    if (event.target.closest('select') || event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.target.closest('input, button') && !['n', 'p'].includes(name)) return;
    const does = {
      ' ': toggle, n: () => toImpact(1), p: () => toImpact(-1), Home: () => stopAt(0), End: () => stopAt(state.scene.end),
      ArrowLeft: () => stopAt(state.time - step), ArrowRight: () => stopAt(state.time + step),
    };
    if (!(name in does)) return;
    does[name]();
    event.preventDefault();
  });
  const toPointer = (event) => {
    const frame = strip.getBoundingClientRect();
    stopAt(((event.clientX - frame.left) / frame.width) * state.scene.end);
  };
  strip.addEventListener('pointerdown', toPointer);
  strip.addEventListener('pointermove', (event) => event.buttons && toPointer(event));
  open(0);
  drawnToWidth(root.querySelector('.stage'), arrange);
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', arrange);
}
