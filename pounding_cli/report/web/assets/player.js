// The player: which scene, which instant, how fast; buttons, keys, and what they say.

const SPEEDS = [['1', 'real time'], ['0.5', '1/2'], ['0.2', '1/5'], ['0.1', '1/10'], ['0.02', '1/50'], ['0.005', '1/200']];
/** Speed of slow motion. */
const SLOW = 0.01;
/** Slow motion lasts from this long before the largest force of an impact to as long after it [s]. */
const AROUND = 0.012;
/** In this time the light of an impact falls to a third [s]. */
const FADE = 0.15;
/** Pictures a second of a film. */
const RATE = 30;
/** Height of the line above the picture of a film [px]. */
const HEAD = 28;

function playerView() {
  const root = document.getElementById('player');
  const canvas = h('canvas', { role: 'img' });
  const strip = h('canvas', { role: 'img', 'aria-label': 'Ground acceleration, roof displacements and link forces over time' });
  const tip = h('div', { class: 'tip', hidden: true });
  const state = { scene: null, time: 0, last: 0, playing: false, speed: 0.2, slow: true, scale: null, span: 0, glow: [], frame: 0, drawn: 0 };
  const play = h('button', { type: 'button', class: 'primary', onclick: () => toggle() }, 'Play');
  const scrub = h('input', { type: 'range', min: 0, step: 1, value: 0, 'aria-label': 'Time', oninput: () => {
    pause();
    go(Number(scrub.value) * state.scene.dt);
  } });
  const before = h('button', { type: 'button', onclick: () => toImpact(-1) }, 'Previous impact');
  const after = h('button', { type: 'button', onclick: () => toImpact(1) }, 'Next impact');
  const hardest = h('button', { type: 'button', onclick: () => toHardest() }, 'Largest impact');
  const film = h('button', { type: 'button', hidden: !window.MediaRecorder, onclick: () => (state.film ? state.film.stop() : record()) }, 'Record a film');
  const slow = h('input', { type: 'checkbox', checked: true, onchange: () => {
    state.slow = slow.checked;
  } });
  const readout = h('dl', { class: 'readout' });
  const which = choice('Scene', data.players.scenes.map((one, number) => [String(number), one.label]), '0', (value) => open(Number(value)));
  const speed = choice('Speed', SPEEDS, '0.2', (value) => {
    state.speed = Number(value);
  });
  const scale = choice('Displacements drawn', [['', 'to fit'], ...SCALES.map((one) => [String(one), `× ${one}`])], '', (value) => {
    state.scale = value === '' ? null : Number(value);
    arrange();
  });
  const span = choice('Time shown below', [['0', 'all of it'], ['2', '2 s'], ['0.5', '0.5 s'], ['0.1', '0.1 s']], '0', (value) => {
    state.span = Number(value);
    draw();
  });
  root.append(
    h('div', { class: 'bar' }, which.element, scale.element, span.element),
    h('div', { class: 'stage' }, canvas, tip),
    h('div', { class: 'bar' }, play, before, after, hardest, speed.element, h('label', { class: 'check' }, slow, 'slow at impacts'), film),
    scrub, strip, readout,
    h('p', { class: 'note key' }),
    h('p', { class: 'note keys' }, ...[['Space', 'plays and pauses'], ['←', ''], ['→', 'one sample, with'], ['Shift', '0.1 s'], ['P', ''], ['N', 'previous and next impact']]
      .flatMap(([key, does]) => [h('kbd', {}, key), ` ${does} `])),
  );

  function open(number) {
    pause();
    state.scene = new Scene(data.players.scenes[number]);
    state.glow = state.scene.links.map(() => 0);
    scrub.max = state.scene.count - 1;
    const hard = state.scene.impacts.length > 0;
    for (const button of [before, after, hardest]) button.disabled = !hard;
    arrange();
    go(hard ? strongest().at : 0);
  }

  function arrange() {
    const { scene } = state;
    const width = Math.max(canvas.parentElement.clientWidth, 240);
    state.ink = inks();
    state.at = layout(scene, width, state.scale);
    state.strips = stripsOf(scene, state.ink);
    const times = state.at.scale === 1 ? 'to the scale of the heights' : `${state.at.scale} times larger than heights`;
    const thinned = scene.stride > 1 ? `The page holds every ${scene.stride}th sample, and the largest force in between.` : '';
    const yielding = scene.yields ? 'Columns are red and thick while the storey drift is at or beyond the yield drift. ' : 'This scene is elastic: no storey yields. ';
    const kinds = new Set(scene.links.map(({ drawn }) => drawn));
    const contact = kinds.has('gap') || kinds.has('filling') ? `Stars: contact forces. A contact with at least ${100 * HARD} % of the largest force counts as an impact for the buttons and the slow motion. ` : '';
    const bars = kinds.has('bar') ? 'Bars: connectors, orange in compression, blue in tension. ' : '';
    root.querySelector('.key').textContent = `Displacements and gaps are drawn ${times}. ${yielding}${contact}${bars}${thinned}`;
    canvas.setAttribute('aria-label', `${scene.buildings.map(({ name }) => name).join(', ')} moving: ${scene.label}; displacements drawn ${times}`);
    draw();
  }

  const strongest = () => state.scene.impacts.reduce((most, one) => (one.force > most.force ? one : most));

  function go(time, aloud = false) {
    state.time = Math.max(0, Math.min(time, state.scene.end));
    state.last = state.time;
    state.scene.links.forEach((_, number) => {
      state.glow[number] = Math.abs(state.scene.between(state.scene.forces[number], state.time)) / (state.scene.mostForce || 1);
    });
    draw();
    if (aloud) say(spoken());
  }

  function toImpact(way) {
    pause();
    const hard = state.scene.impacts, slack = state.scene.dt / 2;
    const next = way > 0 ? hard.find(({ at }) => at > state.time + slack) : hard.findLast(({ at }) => at < state.time - slack);
    if (next) go(next.at, true);
    else say('No more impacts');
  }

  function toHardest() {
    pause();
    go(strongest().at, true);
  }

  function toggle() {
    if (state.playing) pause();
    else {
      if (state.time >= state.scene.end) go(0);
      state.playing = true;
      play.textContent = 'Pause';
      state.frame = requestAnimationFrame(tick);
    }
  }

  function pause() {
    cancelAnimationFrame(state.frame);
    state.film?.stop();
    state.playing = false;
    state.clock = undefined;
    play.textContent = 'Play';
    if (state.at) tell();
  }

  function tick(now) {
    const passed = state.clock === undefined ? 0 : Math.min((now - state.clock) / 1e3, 0.1);
    state.clock = now;
    const { scene } = state;
    const slowed = state.slow && scene.impacts.some((impact) => Math.abs(impact.at - state.time) < AROUND);
    const next = Math.min(state.time + passed * (slowed ? Math.min(state.speed, SLOW) : state.speed), scene.end);
    scene.links.forEach((_, number) => {
      const pressed = Math.abs(scene.force(number, state.time, next)) / (scene.mostForce || 1);
      state.glow[number] = Math.max(pressed, still.matches ? 0 : state.glow[number] * Math.exp(-passed / FADE));
    });
    state.time = next;
    draw();
    if (state.time >= scene.end) pause();
    else state.frame = requestAnimationFrame(tick);
  }

  /** Play from here, and save what is shown as a film when it ends or pauses. */
  function record() {
    const { scene, at, ink } = state, dense = canvas.width / at.width, head = HEAD * dense;
    const sheet = h('canvas', { width: canvas.width, height: canvas.height + strip.height + head });
    const pen = sheet.getContext('2d'), parts = [], recorder = new MediaRecorder(sheet.captureStream(RATE));
    state.picture = () => {
      pen.fillStyle = ink.card;
      pen.fillRect(0, 0, sheet.width, sheet.height);
      pen.fillStyle = ink.ink;
      pen.font = `${14 * dense}px system-ui, sans-serif`;
      pen.fillText(`${scene.label}; displacements × ${at.scale}; ${state.time.toFixed(3)} s`, 0.3 * head, 0.7 * head);
      pen.drawImage(canvas, 0, head);
      pen.drawImage(strip, 0, head + canvas.height);
    };
    recorder.ondataavailable = ({ data: part }) => {
      if (part.size) parts.push(part);
      film.disabled = recorder.state !== 'inactive' && !parts.length; // nothing to save before the first pictures
    };
    recorder.onstop = () => {
      [state.film, state.picture, film.textContent] = [null, null, 'Record a film'];
      if (parts.length) saveAs(`${scene.label}.${recorder.mimeType.includes('mp4') ? 'mp4' : 'webm'}`, new Blob(parts, { type: recorder.mimeType }));
    };
    state.film = { stop: () => recorder.state === 'inactive' || recorder.stop() };
    [film.textContent, film.disabled] = ['Save the film', true];
    recorder.start(200);
    if (!state.playing) toggle();
  }

  function draw() {
    const { scene, at, time, ink } = state;
    drawStage(canvas, scene, at, time, state.glow, ink);
    const [from, to] = shownSpan();
    drawStrips(strip, scene, state.strips, from, to, time, at.width, ink);
    state.picture?.();
    scrub.value = Math.round(time / scene.dt);
    scrub.setAttribute('aria-valuetext', `${asText(time)} s`);
    const now = performance.now();
    if (!state.playing || now - state.drawn > 100) {
      state.drawn = now;
      tell();
    }
  }

  /** The times the strips show, the present in their middle where they can be. */
  function shownSpan() {
    const { scene, span: length, time } = state;
    if (!length || length >= scene.end) return [0, scene.end];
    const from = Math.max(0, Math.min(time - length / 2, scene.end - length));
    return [from, from + length];
  }

  function facts() {
    const { scene, time } = state;
    const roofs = scene.buildings.length <= 4
      ? scene.buildings.map(({ name, heights }, number) => [`${name} roof`, `${asSteady(1e3 * scene.moved(number, heights.length - 1, time), 1e3 * scene.mostMoved)} mm`])
      : [];
    const forces = scene.links.map((link, number) => [link, scene.between(scene.forces[number], time)]);
    const most = forces.reduce((one, other) => (Math.abs(other[1]) > Math.abs(one[1]) ? other : one), [null, 0]);
    const where = most[0] ? ` at floor ${most[0].floor}` : '';
    const soFar = scene.contacts.filter(({ from }) => from <= time).length;
    const { factor, unit } = scene.acceleration;
    const ground = `${asSteady(factor * scene.between(scene.ground, time), factor * scene.mostGround)} ${unit}`;
    return [['time', `${time.toFixed(3)} s`], ['ground', ground], ...roofs,
      ['link force', `${asSteady(most[1] / 1e3, scene.mostForce / 1e3)} kN${where}`], ['contacts so far', `${soFar} of ${scene.contacts.length}`]];
  }

  const tell = () => readout.replaceChildren(...facts().map(([name, value]) => h('div', {}, h('dt', {}, name), h('dd', {}, value))));
  const spoken = () => facts().map(([name, value]) => `${name} ${value}`).join(', ');

  root.addEventListener('keydown', (event) => {
    if (event.target.closest('select, input, button') && !['n', 'p', 'N', 'P'].includes(event.key)) return;
    if (event.target.closest('select') || event.ctrlKey || event.metaKey || event.altKey) return;
    const step = event.shiftKey ? 0.1 : state.scene.dt;
    const moves = { ArrowLeft: -step, ArrowRight: step };
    if (event.key === ' ') toggle();
    else if (event.key in moves) {
      pause();
      go(state.time + moves[event.key], true);
    } else if (event.key === 'Home' || event.key === 'End') {
      pause();
      go(event.key === 'Home' ? 0 : state.scene.end, true);
    } else if (event.key.toLowerCase() === 'n' || event.key.toLowerCase() === 'p') toImpact(event.key.toLowerCase() === 'n' ? 1 : -1);
    else return;
    event.preventDefault();
  });

  const timeAt = (event) => {
    const frame = strip.getBoundingClientRect(), [from, to] = shownSpan();
    return from + ((event.clientX - frame.left) / frame.width) * (to - from);
  };
  strip.addEventListener('pointerdown', (event) => {
    pause();
    go(timeAt(event));
    strip.setPointerCapture(event.pointerId);
  });
  strip.addEventListener('pointermove', (event) => {
    if (event.buttons) go(timeAt(event));
  });

  canvas.addEventListener('pointermove', (event) => {
    const frame = canvas.getBoundingClientRect(), { scene, at, time } = state;
    const x = event.clientX - frame.left, y = event.clientY - frame.top;
    let found = null;
    scene.buildings.forEach((_, number) => at.heights[number].slice(1).forEach((height, floor) => {
      const left = floorX(scene, at, number, floor, time), step = scene.buildings[number].heights[floor] * at.up;
      const away = y - (at.ground - height * at.up); // the storey under a floor belongs to it
      if (x > left - 4 && x < left + at.wide + 4 && away > -step * 0.25 && away < step * 0.75) found = [number, floor];
    }));
    tip.hidden = !found;
    if (!found) return;
    const [number, floor] = found;
    const demand = scene.demand(number, floor, time);
    tip.replaceChildren(h('strong', {}, `${scene.buildings[number].name}, floor ${floor + 1}`),
      h('span', {}, `displacement ${asSteady(1e3 * scene.moved(number, floor, time), 1e3 * scene.mostMoved)} mm`), h('span', {}, `storey drift ${asText(demand, 3)} times yield`));
    tip.style.left = `${Math.min(x + 14, at.width - tip.offsetWidth - 4)}px`;
    tip.style.top = `${Math.max(y - tip.offsetHeight - 8, 0)}px`;
  });
  canvas.addEventListener('pointerleave', () => {
    tip.hidden = true;
  });

  open(0);
  drawnToWidth(canvas.parentElement, arrange);
  document.addEventListener('themed', arrange);
}
